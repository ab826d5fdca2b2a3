// Test of the comparison of a device with the host (known-answer tests). Calls only the CUDA runtime, so that it runs
// on a device or on one that the CPU emulates.

#include <cuda_runtime.h>

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>

#include "crumple/crumple.h"

namespace crumple::test {
namespace {

// Run this test alone, so that the first backend is the first one of the process. The difference of the two times that
// it prints is the time of loading kernels and of the comparison.
TEST(KnownAnswers, device_passes_the_comparison_with_the_host) {
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
