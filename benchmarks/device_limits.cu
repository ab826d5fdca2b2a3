#include "device_limits.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

namespace crumple::benchmark {

void check(cudaError_t error) {
    if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}

namespace {

// Attributes are given by number, because the headers of the device that the CPU emulates (cuda_on_cpu/), with which
// this file is also compiled for tests, do not name them.
constexpr auto memory_clock_kilohertz = static_cast<cudaDeviceAttr>(36);
constexpr auto bus_width_bits = static_cast<cudaDeviceAttr>(37);
constexpr auto clock_kilohertz = static_cast<cudaDeviceAttr>(13);

/// Returns an attribute of a device; 0 if the device does not report it.
double attribute(cudaDeviceAttr which, int device) {
    int value = 0;
    if (cudaDeviceGetAttribute(&value, which, device) == cudaSuccess) return value;
    cudaGetLastError();  // otherwise the next check would report this error
    return 0;
}

__global__ void do_nothing() {}

__global__ void spin(long long clocks) {
    const long long begin = clock64();
    while (clock64() - begin < clocks) {
    }
}

void launch(cudaStream_t stream, auto kernel, auto... arguments) {
    cudaLaunchConfig_t config{};
    config.gridDim = dim3(1);
    config.blockDim = dim3(32);
    config.stream = stream;
    check(cudaLaunchKernelEx(&config, kernel, arguments...));
}

class Meter {
   public:
    Meter() {
        check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking));
        for (cudaEvent_t* event : {&begin_, &end_}) check(cudaEventCreate(event));
    }
    Meter(const Meter&) = delete;
    Meter& operator=(const Meter&) = delete;
    ~Meter() {
        for (cudaEvent_t event : {begin_, end_}) cudaEventDestroy(event);
        cudaStreamDestroy(stream_);
    }

    /// Returns the median milliseconds between events around the work that `work` enqueues.
    template <class Work>
    double median(int times, bool busy, Work work) {
        std::vector<double> values;
        for (int i = 0; i <= times; ++i) {  // the first is a warm-up
            if (busy) keep_busy(stream_);
            check(cudaEventRecord(begin_, stream_));
            work(stream_);
            check(cudaEventRecord(end_, stream_));
            check(cudaEventSynchronize(end_));
            float milliseconds = 0;
            check(cudaEventElapsedTime(&milliseconds, begin_, end_));
            if (i > 0) values.push_back(static_cast<double>(milliseconds));
        }
        std::nth_element(values.begin(), values.begin() + times / 2, values.end());
        return values[static_cast<std::size_t>(times) / 2];
    }

    double of_launches(int kernels) {
        return median(100, false, [&](cudaStream_t stream) { launch_all(kernels, stream); });
    }

    double of_graph(int kernels) {
        check(cudaStreamBeginCapture(stream_, cudaStreamCaptureModeThreadLocal));
        launch_all(kernels, stream_);
        cudaGraph_t graph = nullptr;
        check(cudaStreamEndCapture(stream_, &graph));
        cudaGraphExec_t executable = nullptr;
        check(cudaGraphInstantiate(&executable, graph, 0));
        const double time = median(100, true, [&](cudaStream_t stream) { check(cudaGraphLaunch(executable, stream)); });
        check(cudaGraphExecDestroy(executable));
        check(cudaGraphDestroy(graph));
        return time;
    }

    double of_copy(std::size_t bytes) {
        void *from = nullptr, *to = nullptr;
        check(cudaMalloc(&from, bytes));
        check(cudaMalloc(&to, bytes));
        check(cudaMemsetAsync(from, 0, bytes, stream_));
        const double time = median(10, true, [&](cudaStream_t stream) {
            check(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream));
        });
        check(cudaFree(from));
        check(cudaFree(to));
        return time;
    }

   private:
    static void launch_all(int kernels, cudaStream_t stream) {
        for (int i = 0; i < kernels; ++i) launch(stream, do_nothing);
    }

    cudaStream_t stream_ = nullptr;
    cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

}  // namespace

void keep_busy(cudaStream_t stream) {
    static const long long clocks = [] {
        int device = 0;
        check(cudaGetDevice(&device));
        const double kilohertz = attribute(clock_kilohertz, device);
        return static_cast<long long>(0.05 * (kilohertz > 0 ? kilohertz : 1e6));
    }();
    launch(stream, spin, clocks);
}

DeviceLimits measure_limits(int device) {
    constexpr int further = 100;
    DeviceLimits limits;
    // Bytes per second: 1,000 for kHz, times two transfers per clock, times the width of the bus.
    limits.peak_bandwidth = 2e3 * attribute(memory_clock_kilohertz, device) * attribute(bus_width_bits, device) / 8;
    Meter meter;
    const auto bytes = static_cast<std::size_t>(4 * std::max(attribute(cudaDevAttrL2CacheSize, device), 4e6));
    limits.copy_bandwidth = 2e3 * static_cast<double>(bytes) / meter.of_copy(bytes);
    limits.graph = meter.of_graph(1);
    limits.node = std::max(0.0, (meter.of_graph(1 + further) - limits.graph) / further);
    limits.launch = std::max(0.0, (meter.of_launches(1 + further) - meter.of_launches(1)) / further);
    return limits;
}

nlohmann::json to_json(const DeviceLimits& limits) {
    return {{"peak_bytes_a_second", limits.peak_bandwidth},
            {"copied_bytes_a_second", limits.copy_bandwidth},
            {"graph_milliseconds", limits.graph},
            {"node_milliseconds", limits.node},
            {"launch_milliseconds", limits.launch}};
}

}  // namespace crumple::benchmark
