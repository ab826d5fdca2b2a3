// The machine that plays the device for the backend's tests: small, so that each call starts few threads.

#include "cuda_on_cpu/machine/settings.h"

namespace {

const bool one_multiprocessor = [] {
    cuda_on_cpu::settings().multiprocessors = 1;
    return true;
}();

}  // namespace
