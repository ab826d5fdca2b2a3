#pragma once

// Settings of the machine, which is the emulated device and its runtime API, for tests: the order of threads, how lazy
// streams are, the properties of the device.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "cuda_on_cpu/machine/kernel.h"
#include "cuda_on_cpu/machine/random.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/errors.h"

namespace cuda_on_cpu {

/// Order in which blocks start, ready threads continue, and ready graph nodes run.
enum class Order {
    forward,  ///< lowest first: warp 0 runs as far as it can before warp 1 starts
    reverse,  ///< highest first
    random,   ///< any, chosen by `seed`
};

/// Time at which the work enqueued in a stream is done.
enum class Progress {
    lazy,    ///< not before somebody waits for it: finds missing waits
    eager,   ///< at once: finds code that relies on work being still pending
    random,  ///< at random times, chosen by `seed`
};

struct Settings {
    Order order = Order::forward;
    Progress progress = Progress::lazy;
    std::uint32_t seed = 1;
    /// OS threads that run blocks. 0 means one per core, but at least 2, because races between blocks need two, and at
    /// most 16, because each has up to 1024 stacks. Under ThreadSanitizer, which allows some 8000 threads, it means 2.
    unsigned workers = 0;
    /// Number of devices. With 0 every call that needs one returns cudaErrorNoDevice.
    int devices = 1;
    /// True if there is a driver. Without one, calls return cudaErrorInsufficientDriver, and cudaGetDeviceCount leaves
    /// the count unwritten.
    bool driver = true;
    /// Bytes of device memory, all devices together. Allocations beyond it return cudaErrorMemoryAllocation.
    std::size_t device_bytes = std::size_t{4} << 30;
    int multiprocessors = 4;
    /// Registers of each thread of every kernel, which limit how many blocks a multiprocessor holds.
    int registers = 32;
    /// Number of allocations that succeed before one fails; later ones succeed again. Negative: none fails.
    int allocations_before_failure = -1;
    /// Number of kernel launches that succeed before one fails; later ones succeed again. Negative: none fails. On a
    /// device a launch may fail because the driver allocates memory for the kernel's stacks.
    int launches_before_failure = -1;
    /// Error that every call that needs the device returns, such as the error that a failed kernel leaves behind for
    /// good.
    cudaError_t broken = cudaSuccess;
    /// True if the work of kernels is counted while a profiler would record (counts.h), and printed on stderr.
    bool counts = false;
    /// Called for each launch, unless empty. It either runs the launch in place of the kernel's C++ and returns true,
    /// or does nothing and returns false.
    std::function<bool(const Kernel&)> run_instead;
    /// Seconds for which all threads of a block may spin in __nanosleep before they count as deadlocked.
    double spin_seconds = 20;
};

/// Returns the settings in force. The first call reads CUDA_ON_CPU_ORDER, _PROGRESS, _SEED, _WORKERS, _DEVICES,
/// _MULTIPROCESSORS, _REGISTERS and _COUNTS from the environment; an invalid value ends the process. Change settings
/// only while no work is pending.
Settings& settings();

/// Returns the number of workers after the default is resolved, at least 1.
unsigned worker_count();

/// Returns the source of the host's random choices and rubbish. It restarts when the seed changes.
Random& host_random();

}  // namespace cuda_on_cpu
