// The comparison of a device with the host. Plain CUDA: the CPU plays the device, or a device is there.

#include <cuda_runtime.h>

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>

#include "crumple/crumple.h"

namespace crumple::test {
namespace {

// Run alone, so that the first backend is the process's first one. The difference is what kernels' loading and the
// known answers take.
TEST(KnownAnswers, let_this_device_be_used) {
    ASSERT_EQ(cudaFree(nullptr), cudaSuccess);  // makes the context
    for (const char* which : {"first", "second"}) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ(Detector({.backend = Backend::cuda}).backend(), Backend::cuda);
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
        std::cout << "the " << which << " backend of this process was made in " << time.count() << " ms\n";
    }
}

}  // namespace
}  // namespace crumple::test
