#include "cuda/runtime.h"

#include <string>

#include "crumple/error.h"

namespace crumple::cuda {

void check(cudaError_t error, const char* call) {
    if (error == cudaSuccess) return;
    cudaGetLastError();  // so that the next call does not meet it again
    const std::string text = std::string(call).substr(0, std::string(call).find('('));
    throw Error(ErrorCode::device, text + ": " + cudaGetErrorString(error) + " (" + cudaGetErrorName(error) + ")");
}

}  // namespace crumple::cuda
