#pragma once

// Error codes with CUDA's names and values: those that the machine or its users need.

#define CUDA_ON_CPU_ERRORS(X)                                                                  \
    X(cudaSuccess, 0, "no error")                                                              \
    X(cudaErrorInvalidValue, 1, "invalid argument")                                            \
    X(cudaErrorMemoryAllocation, 2, "out of memory")                                           \
    X(cudaErrorInitializationError, 3, "initialisation failed")                                \
    X(cudaErrorInvalidConfiguration, 9, "invalid grid, block or shared memory")                \
    X(cudaErrorInvalidPitchValue, 12, "invalid pitch")                                         \
    X(cudaErrorInvalidSymbol, 13, "invalid device symbol")                                     \
    X(cudaErrorInvalidDevicePointer, 17, "invalid device pointer")                             \
    X(cudaErrorInvalidMemcpyDirection, 21, "invalid direction of copy")                        \
    X(cudaErrorInsufficientDriver, 35, "no driver, or one older than the runtime")             \
    X(cudaErrorInvalidDeviceFunction, 98, "invalid device function")                           \
    X(cudaErrorNoDevice, 100, "no CUDA-capable device")                                        \
    X(cudaErrorInvalidDevice, 101, "invalid device number")                                    \
    X(cudaErrorNoKernelImageForDevice, 209, "no code for this device")                         \
    X(cudaErrorInvalidResourceHandle, 400, "invalid handle")                                   \
    X(cudaErrorIllegalState, 401, "wrong state for this call")                                 \
    X(cudaErrorNotReady, 600, "not ready")                                                     \
    X(cudaErrorIllegalAddress, 700, "illegal memory access")                                   \
    X(cudaErrorLaunchOutOfResources, 701, "too many resources requested for a launch")         \
    X(cudaErrorHostMemoryAlreadyRegistered, 712, "memory is pinned already")                   \
    X(cudaErrorHostMemoryNotRegistered, 713, "memory is not pinned")                           \
    X(cudaErrorLaunchFailure, 719, "launch failed")                                            \
    X(cudaErrorNotPermitted, 800, "not permitted")                                             \
    X(cudaErrorNotSupported, 801, "not supported")                                             \
    X(cudaErrorStreamCaptureUnsupported, 900, "not permitted while a stream is capturing")     \
    X(cudaErrorStreamCaptureInvalidated, 901, "capture failed because of an earlier error")    \
    X(cudaErrorStreamCaptureMerge, 902, "two captures would be merged")                        \
    X(cudaErrorStreamCaptureUnmatched, 903, "capture did not begin in this stream")            \
    X(cudaErrorStreamCaptureUnjoined, 904, "capture ends while a forked stream is not joined") \
    X(cudaErrorStreamCaptureIsolation, 905, "capture would depend on work outside of it")      \
    X(cudaErrorStreamCaptureImplicit, 906, "capture would depend on the legacy stream")        \
    X(cudaErrorCapturedEvent, 907, "event was last recorded in a capture")                     \
    X(cudaErrorStreamCaptureWrongThread, 908, "capture began in another thread")               \
    X(cudaErrorGraphExecUpdateFailure, 910, "graph cannot be updated in this way")             \
    X(cudaErrorUnknown, 999, "unknown error")

#define CUDA_ON_CPU_ENUMERATOR(name, value, text) name = value,
enum cudaError { CUDA_ON_CPU_ERRORS(CUDA_ON_CPU_ENUMERATOR) };
#undef CUDA_ON_CPU_ENUMERATOR
using cudaError_t = cudaError;

const char* cudaGetErrorName(cudaError_t error);
const char* cudaGetErrorString(cudaError_t error);
