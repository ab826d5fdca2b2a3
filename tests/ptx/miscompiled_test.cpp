// Tests that the interpreter shows the wrong results of a program that nvcc 13.0 miscompiles (docs/nvcc_13_0.md).

#include <gtest/gtest.h>

#include <string>

#include "docs/nvcc_13_0/expansion_copy.cu"  // its functions, compiled for the host
#include "ptx/kernels.h"

namespace crumple::ptx {
namespace {

TEST(Ptx, documented_miscompilation_shows_iff_the_installed_nvcc_is_13_0) {
    Program program(read_ptx(CRUMPLE_EXPANSION_COPY));
    const Function& kernel = program.function("opposite_signs");
    Thread thread;
    int wrong = 0;
    constexpr int items = 81;
    for (int item = 0; item < items; ++item) {
        const double numbers[]{item % 3 - 1., item / 3 % 3 - 1., item / 9 % 3 - 1., item / 27 - 1.};
        const double* const in = numbers;
        const int n = 1;
        int sign = 7;
        int* const out = &sign;
        const void* const arguments[] = {&in, &n, &out};
        thread.run(kernel, arguments);
        wrong += sign != opposite_sign_of_list(numbers);
    }
    const std::string version = CRUMPLE_NVCC_VERSION;
    if (version == "13.0")
        EXPECT_EQ(wrong, items - 1) << "all but the empty list are wrong";
    else
        EXPECT_EQ(wrong, 0) << "by nvcc " << version;
}

}  // namespace
}  // namespace crumple::ptx
