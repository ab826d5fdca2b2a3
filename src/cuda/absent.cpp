// Stands in for the cuda backend in builds without it.

#include "crumple/error.h"
#include "pipeline/backend.h"

namespace crumple {

std::unique_ptr<BackendBase> make_cuda_backend(const Options&, MemoryMeter&, Cancellation&) {
    throw Error(ErrorCode::backend_unavailable, "the cuda backend was not built; configure with -DCRUMPLE_CUDA=ON",
                Element::option);
}

}  // namespace crumple
