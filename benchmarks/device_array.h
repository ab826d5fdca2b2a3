#pragma once

// Arrays on a device, and times of calls by the host's clock.

#include <cuda_runtime.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <utility>
#include <vector>

#include "device_limits.h"
#include "race.h"

namespace crumple::benchmark {

class DeviceArray {
   public:
    DeviceArray(const void* host, std::size_t bytes) {
        check(cudaMalloc(&data_, std::max<std::size_t>(bytes, 1)));
        check(cudaMemcpy(data_, host, bytes, cudaMemcpyHostToDevice));
        check(cudaDeviceSynchronize());  // cudaMemcpy may return before the copy ends, and non-blocking streams do not
                                         // wait
    }
    DeviceArray(const DeviceArray&) = delete;
    DeviceArray& operator=(const DeviceArray&) = delete;
    ~DeviceArray() { cudaFree(data_); }
    const void* data() const { return data_; }

   private:
    void* data_ = nullptr;
};

template <class Work>
double milliseconds_of(Work work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

template <class Work>
Summary repeated(int times, Work work) {
    std::vector<double> values;
    for (int i = 0; i < times; ++i) values.push_back(milliseconds_of(work));
    return summarise(std::move(values));
}

}  // namespace crumple::benchmark
