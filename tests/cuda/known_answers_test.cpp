// The comparison of a device with the host. Plain CUDA: the CPU plays the device, or a device is there.

#include "engine/cuda/known_answers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <iostream>

namespace crumple::test {
namespace {

TEST(KnownAnswers, of_this_device_are_those_of_the_host) {
    const cuda::Device device(0);
    const cuda::Stream stream = cuda::make_stream(device);
    for (const char* when : {"the first time", "again"}) {
        const auto begin = std::chrono::steady_clock::now();
        EXPECT_EQ(cuda::find_difference_from_host(device, stream.get()), "");
        const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - begin;
        std::cout << "known answers, " << when << ": " << time.count() << " ms\n";
    }
}

}  // namespace
}  // namespace crumple::test
