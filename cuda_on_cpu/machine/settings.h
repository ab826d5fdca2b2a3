#pragma once

// What a test may choose about the machine: the order of threads, how lazy streams are, what the device looks like.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "cuda_on_cpu/machine/kernel.h"
#include "cuda_on_cpu/machine/random.h"
#include "cuda_on_cpu/shim/cuda_on_cpu/errors.h"

namespace cuda_on_cpu {

/// In which order blocks start, threads that can go on do, and graph nodes that are ready run.
enum class Order {
    forward,  ///< lowest first: warp 0 runs as far as it can before warp 1 starts
    reverse,  ///< highest first
    random,   ///< any, by `seed`
};

/// When the work given to a stream is done.
enum class Progress {
    lazy,    ///< not before somebody waits for it: finds whoever forgets to wait
    eager,   ///< at once: finds whoever counts on work still waiting
    random,  ///< now and then, by `seed`
};

struct Settings {
    Order order = Order::forward;
    Progress progress = Progress::lazy;
    std::uint32_t seed = 1;
    /// OS threads that run blocks; 0: one a core, but at least 2, because races between blocks need two, and at most
    /// 16, because each brings 1024 stacks. Under ThreadSanitizer, which has room for some 8000 threads, 2.
    unsigned workers = 0;
    /// Devices present. With 0 every call that needs one answers cudaErrorNoDevice.
    int devices = 1;
    /// Without a driver calls answer cudaErrorInsufficientDriver, and cudaGetDeviceCount leaves the count unwritten.
    bool driver = true;
    /// Bytes of memory of a device; allocations beyond answer cudaErrorMemoryAllocation.
    std::size_t device_bytes = std::size_t{4} << 30;
    int multiprocessors = 4;
    /// How many allocations succeed before one fails, then all succeed again; negative: none fails.
    int allocations_before_failure = -1;
    /// The same for launches of kernels: a driver takes memory for their stacks.
    int launches_before_failure = -1;
    /// What every call answers that needs the device: an error that a kernel has left behind stays for good.
    cudaError_t broken = cudaSuccess;
    /// Runs a launch in another way than by the kernel's C++, and returns true; or returns false.
    std::function<bool(const Kernel&)> run_instead;
    /// Seconds for which all threads of a block may spin in __nanosleep before that is a deadlock.
    double spin_seconds = 20;
};

/// The settings in force. The first call reads CUDA_ON_CPU_ORDER, _PROGRESS, _SEED, _WORKERS and _DEVICES from the
/// environment; a value that means nothing ends the process. Change them only while no work is pending.
Settings& settings();

/// Workers after the default is resolved, at least 1.
unsigned worker_count();

/// Random choices and rubbish on the host's side. Begins anew when the seed changes.
Random& host_random();

}  // namespace cuda_on_cpu
