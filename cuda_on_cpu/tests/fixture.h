#pragma once

// Fixture for tests that change the machine's settings: they begin with the defaults, and restore them.

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
