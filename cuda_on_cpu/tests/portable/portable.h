#pragma once

// Helpers of the portable tests, which use nothing but CUDA: they run on the CPU and on a device.

#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace portable {

/// Returns the block's dynamic shared memory. Only here the two compilers see different text.
template <class T>
__device__ T& dynamic_shared() {
#ifdef __CUDACC__
    extern __shared__ __align__(16) unsigned char raw[];
    return reinterpret_cast<T&>(*raw);
#else
    return cuda_on_cpu::dynamic_shared<T>();
#endif
}

inline void check(cudaError_t error) {
    if (error != cudaSuccess)
        throw std::runtime_error(std::string(cudaGetErrorName(error)) + ": " + cudaGetErrorString(error));
}

/// Launches a kernel and returns the error; a function, because <<<>>> is not C++.
template <class... Parameters, class... Arguments>
cudaError_t try_launch(cudaStream_t stream, void (*kernel)(Parameters...), dim3 grid, dim3 block, std::size_t shared,
                       Arguments&&... arguments) {
    cudaLaunchConfig_t config{};
    config.gridDim = grid;
    config.blockDim = block;
    config.dynamicSmemBytes = shared;
    config.stream = stream;
    return cudaLaunchKernelEx(&config, kernel, std::forward<Arguments>(arguments)...);
}
template <class... Parameters, class... Arguments>
void launch(void (*kernel)(Parameters...), dim3 grid, dim3 block, std::size_t shared, Arguments&&... arguments) {
    check(try_launch(nullptr, kernel, grid, block, shared, std::forward<Arguments>(arguments)...));
}

/// Array on the device.
template <class T>
class Array {
   public:
    explicit Array(std::size_t n) : size_(n) { check(cudaMalloc(&data_, n * sizeof(T))); }
    explicit Array(const std::vector<T>& values) : Array(values.size()) {
        check(cudaMemcpy(data_, values.data(), size_ * sizeof(T), cudaMemcpyHostToDevice));
        check(cudaDeviceSynchronize());  // the copy may return before its end, and not all streams wait for it
    }
    Array(const Array&) = delete;
    Array& operator=(const Array&) = delete;
    ~Array() { cudaFree(data_); }

    T* data() const { return data_; }
    std::vector<T> values() const {
        std::vector<T> result(size_);
        check(cudaMemcpy(result.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost));
        return result;
    }

   private:
    T* data_ = nullptr;
    std::size_t size_;
};

/// Fixture of tests that need a device: skips them where there is none, and expects no pending error at the end.
class DeviceTest : public testing::Test {
   protected:
    void SetUp() override {
        int count = 0;
        if (cudaGetDeviceCount(&count) != cudaSuccess || count == 0) GTEST_SKIP() << "no device";
    }
    void TearDown() override {
        if (IsSkipped()) return;
        EXPECT_EQ(cudaGetLastError(), cudaSuccess);
    }
};

}  // namespace portable
