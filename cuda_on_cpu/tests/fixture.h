#pragma once

// What tests that turn the machine's settings start from, and leave behind: the defaults.

#include <cuda_runtime.h>
#include <gtest/gtest.h>

#include "cuda_on_cpu/machine/settings.h"

namespace cuda_on_cpu {

class FreshSettings : public testing::Test {
   protected:
    void SetUp() override {
        testing::FLAGS_gtest_death_test_style = "threadsafe";
        settings() = {};
    }
    void TearDown() override {
        cudaGetLastError();
        settings() = {};
    }
};

}  // namespace cuda_on_cpu
