// Stand-in for the cuda backend in builds without it.

#include "backends/backend.h"
#include "crumple/device.h"
#include "crumple/error.h"

namespace crumple {
namespace {

constexpr const char* reason = "the cuda backend was not built; configure with -DCRUMPLE_CUDA=ON";

}  // namespace

bool has_cuda_backend() { return false; }

std::unique_ptr<BackendBase> make_cuda_backend(const Options&, MemoryMeter&, Cancellation&) {
    throw Error(ErrorCode::backend_unavailable, reason, Element::option);
}

DeviceList list_devices() { return {{}, reason}; }

}  // namespace crumple
