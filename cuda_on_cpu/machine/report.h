#pragma once

// Reports of errors in the code under test: a line on stderr, then the end of the process. A kernel that broke the
// rules of CUDA leaves no state from which to continue.

namespace cuda_on_cpu {

/// Prints "cuda_on_cpu: " and the message, formatted like printf, then aborts.
[[noreturn]] __attribute__((format(printf, 1, 2))) void fail(const char* format, ...);

/// Fails like fail(), with the block and thread that run on this OS thread, if any, in front of the message.
[[noreturn]] __attribute__((format(printf, 1, 2))) void fail_in_kernel(const char* format, ...);

/// Installs a handler of SIGSEGV that prints which allocation, stack or shared memory was overrun, by which thread,
/// before the process ends. Does nothing under AddressSanitizer and ThreadSanitizer, which report more. Called once for
/// each OS thread that runs kernels.
void explain_faults();

}  // namespace cuda_on_cpu
