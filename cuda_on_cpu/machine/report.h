#pragma once

// How the machine says that the code under test is wrong: a line on stderr, then the end of the process. A kernel that
// broke the rules of CUDA has no state worth going on from.

namespace cuda_on_cpu {

/// Prints "cuda_on_cpu: " and the message, printf-like, then aborts.
[[noreturn]] __attribute__((format(printf, 1, 2))) void fail(const char* format, ...);

/// The same, with the block and thread that run on this OS thread in front if there are any.
[[noreturn]] __attribute__((format(printf, 1, 2))) void fail_in_kernel(const char* format, ...);

/// Makes a SIGSEGV say which allocation, stack or shared memory was overrun, by which thread, before the process
/// ends. Does nothing under a sanitizer, which says it better. Called once for each OS thread that runs kernels.
void explain_faults();

}  // namespace cuda_on_cpu
