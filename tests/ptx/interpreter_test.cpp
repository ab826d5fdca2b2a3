// Tests of the PTX interpreter on small programs.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "ptx/kernel_name.h"
#include "ptx/program.h"

namespace crumple::ptx {
namespace {

/// Runs a kernel's body, which stores its result at the address in %rd0.
template <class Result, class... Values>
Result run(const std::string& body, Values... values) {
    std::string parameters = ".param .u64 out";
    int i = 0;
    [[maybe_unused]] const auto declare = [&](std::size_t bytes) {
        parameters += ", .param .b" + std::to_string(8 * bytes) + " in" + std::to_string(i++);
    };
    (declare(sizeof values), ...);
    Program program(
        ".version 9.0\n.target sm_90\n.address_size 64\n.visible .entry kernel(" + parameters +
        ")\n{\n.reg .pred %p<9>;\n.reg .b16 %rs<9>;\n.reg .b32 %r<9>;\n.reg .b64 %rd<9>;\n.reg .f32 %f<9>;\n"
        ".reg .f64 %fd<9>;\nld.param.u64 %rd0, [out];\n" +
        body + "\nret;\n}\n");
    Result result{};
    Result* const place = &result;
    const void* const arguments[] = {&place, &values...};
    Thread().run(program.function("kernel"), arguments);
    return result;
}

template <class Work>
std::string failure_of(Work work) {
    try {
        work();
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "no failure";
}

TEST(Ptx, sums_fma_and_conversion_to_float_round_as_the_instruction_says) {
    const auto sum = [](const std::string& rounding) {
        return run<double>("ld.param.f64 %fd1, [in0];\nld.param.f64 %fd2, [in1];\nadd." + rounding +
                               ".f64 %fd3, %fd1, %fd2;\nst.global.f64 [%rd0], %fd3;",
                           -1.0, 0x1p-60);
    };
    EXPECT_EQ(sum("rn"), -1);
    EXPECT_EQ(sum("rm"), -1);
    EXPECT_EQ(sum("rp"), std::nextafter(-1., 0.));
    EXPECT_EQ(sum("rz"), std::nextafter(-1., 0.));
    const double product = run<double>(
        "ld.param.f64 %fd1, [in0];\nmul.rn.f64 %fd2, %fd1, %fd1;\nneg.f64 %fd2, %fd2;\n"
        "fma.rn.f64 %fd3, %fd1, %fd1, %fd2;\nst.global.f64 [%rd0], %fd3;",
        1 + 0x1p-30);
    EXPECT_EQ(product, 0x1p-60);
    EXPECT_EQ(
        run<float>("ld.param.f64 %fd1, [in0];\ncvt.rp.f32.f64 %f1, %fd1;\nst.global.f32 [%rd0], %f1;", 1 + 0x1p-40),
        std::nextafter(1.f, 2.f));
}

TEST(Ptx, ordered_comparisons_with_nan_fail_and_min_ignores_nan) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::string load = "ld.param.f64 %fd1, [in0];\nld.param.f64 %fd2, [in1];\n";
    const auto compare = [&](const std::string& how, double a, double b) {
        return run<std::uint32_t>(
            load + "setp." + how + ".f64 %p1, %fd1, %fd2;\nselp.u32 %r1, 1, 0, %p1;\n" + "st.global.u32 [%rd0], %r1;",
            a, b);
    };
    for (const char* ordered : {"eq", "ne", "lt", "le", "gt", "ge", "num"}) {
        EXPECT_EQ(compare(ordered, nan, 1), 0u);
        EXPECT_EQ(compare(ordered, 1, nan), 0u);
    }
    for (const char* unordered : {"equ", "neu", "ltu", "leu", "gtu", "geu", "nan"}) {
        EXPECT_EQ(compare(unordered, nan, 1), 1u);
        EXPECT_EQ(compare(unordered, 1, nan), 1u);
    }
    EXPECT_EQ(compare("lt", 1, 2), 1u);
    EXPECT_EQ(compare("gtu", 1, 2), 0u);
    const auto least = [&](double a, double b) {
        return run<double>(load + "min.f64 %fd3, %fd1, %fd2;\nst.global.f64 [%rd0], %fd3;", a, b);
    };
    EXPECT_EQ(least(nan, 3), 3);
    EXPECT_EQ(least(3, nan), 3);
    EXPECT_TRUE(std::signbit(least(0., -0.)));
}

TEST(Ptx, extending_load_wide_product_shift_permute_and_bit_insert_are_exact) {
    EXPECT_EQ(run<std::uint32_t>("ld.param.s8 %r1, [in0];\nst.global.u32 [%rd0], %r1;", std::int8_t{-3}), 0xfffffffdu);
    EXPECT_EQ(run<std::uint64_t>("ld.param.u32 %r1, [in0];\nmul.wide.s32 %rd1, %r1, -2;\nst.global.u64 [%rd0], %rd1;",
                                 std::uint32_t{5}),
              static_cast<std::uint64_t>(-10));
    EXPECT_EQ(run<std::uint32_t>("ld.param.u32 %r1, [in0];\nshr.s32 %r2, %r1, 40;\nst.global.u32 [%rd0], %r2;",
                                 std::uint32_t{0x80000000}),
              0xffffffffu);
    EXPECT_EQ(run<std::uint32_t>("ld.param.u32 %r1, [in0];\nld.param.u32 %r2, [in1];\nprmt.b32 %r3, %r1, %r2, 0x7e40;\n"
                                 "st.global.u32 [%rd0], %r3;",
                                 std::uint32_t{0x33221180}, std::uint32_t{0x77e65544}),
              0x77ff4480u);
    EXPECT_EQ(run<std::uint64_t>("ld.param.u64 %rd1, [in0];\nmov.b64 {%r1, %r2}, %rd1;\nmov.b64 %rd2, {%r2, %r1};\n"
                                 "bfi.b64 %rd3, %rd1, %rd2, 8, 8;\nst.global.u64 [%rd0], %rd3;",
                                 std::uint64_t{0x1122334455667788}),
              0x5566778811228844u);
}

TEST(Ptx, bit_fields_are_extracted) {
    const auto field = [](const std::string& type, std::uint32_t value, int begin, int length) {
        return run<std::uint32_t>("ld.param.u32 %r1, [in0];\nbfe." + type + " %r2, %r1, " + std::to_string(begin) +
                                      ", " + std::to_string(length) + ";\nst.global.u32 [%rd0], %r2;",
                                  value);
    };
    EXPECT_EQ(field("u32", 0x80c01234, 24, 8), 0x80u);
    EXPECT_EQ(field("u32", 0x80c01234, 4, 8), 0x23u);
    EXPECT_EQ(field("s32", 0x80c01234, 20, 4), 0xfffffffcu);
    EXPECT_EQ(field("u32", 0x80c01234, 32, 8), 0u);
}

TEST(Ptx, predicate_minus_one_is_true) {
    EXPECT_EQ(run<std::uint32_t>("mov.pred %p1, -1;\nsetp.eq.u32 %p2, 7, 7;\nxor.pred %p3, %p1, %p2;\n"
                                 "selp.u32 %r1, 1, 0, %p3;\nst.global.u32 [%rd0], %r1;"),
              0u);
}

TEST(Ptx, kernel_with_calls_and_branches_gives_right_results) {
    Program program(R"(.version 9.0
.target sm_90
.address_size 64
.func (.param .b32 func_retval0) twice(.param .b64 twice_param_0, .param .align 4 .b8 twice_param_1[8]);
.global .align 8 .b8 table[16] = {0, 0, 0, 0, 0, 0, 240, 63};
.visible .entry kernel(.param .u64 out)
{
    .reg .pred %p<3>;
    .reg .b32 %r<5>;
    .reg .b64 %rd<4>;
    .reg .f64 %fd<3>;
    ld.param.u64 %rd1, [out];
    mov.u32 %r1, 0;
$loop:
    { // callseq 0, 0
    .param .b64 param0;
    st.param.b64 [param0+0], %rd1;
    .param .align 4 .b8 param1[8];
    st.param.b32 [param1+4], %r1;
    .param .b32 retval0;
    call.uni (retval0),
    twice,
    (
    param0,
    param1
    );
    ld.param.b32 %r2, [retval0+0];
    }
    add.s32 %r1, %r2, 1;
    setp.lt.s32 %p1, %r1, 10;
    @%p1 bra $loop;
    @!%p1 st.global.u32 [%rd1], %r1;
    mov.u64 %rd2, table;
    ld.global.f64 %fd1, [%rd2];
    st.global.f64 [%rd1+8], %fd1;
    ret;
}
.func (.param .b32 func_retval0) twice(
    .param .b64 twice_param_0,
    .param .align 4 .b8 twice_param_1[8]
)
{
    .local .align 4 .b8 __local_depot1[4];
    .reg .b32 %r<3>;
    .reg .b64 %SPL;
    mov.u64 %SPL, __local_depot1;
    ld.param.u32 %r1, [twice_param_1+4];
    st.local.u32 [%SPL], %r1;
    ld.local.u32 %r2, [%SPL];
    add.s32 %r2, %r2, %r1;
    st.param.b32 [func_retval0+0], %r2;
    ret;
}
)");
    struct {
        std::uint64_t number = 0;
        double one = 0;
    } out;
    const auto* const place = &out;
    const void* const arguments[] = {&place};
    Thread().run(program.function("kernel"), arguments);
    EXPECT_EQ(out.number, 15u);  // 1, 3, 7, 15
    EXPECT_EQ(out.one, 1);
}

TEST(Ptx, unknown_instructions_unaligned_and_null_accesses_are_rejected) {
    EXPECT_EQ(failure_of([] { run<float>("ex2.approx.f32 %f1, %f2;"); }),
              "unknown PTX instruction: ex2.approx.f32 %f1, %f2 (ex2.approx.f32)");
    EXPECT_EQ(failure_of([] { run<double>("ld.global.f32 %f1, [%rd0+2];"); }),
              "PTX reads or writes at an address that is not aligned");
    EXPECT_EQ(failure_of([] { run<double>("mov.u64 %rd1, 0;\nld.global.f32 %f1, [%rd1];"); }),
              "PTX reads or writes through a null pointer");
    EXPECT_EQ(failure_of([] { run<double>("bra $nowhere;"); }), "no label $nowhere");
}

TEST(Ptx, kernel_name_by_nvcc_is_mapped_to_the_name_by_the_host_compiler) {
    EXPECT_EQ(without_file("_ZN7crumple4cuda41_GLOBAL__N__aa120d3c_9_narrow_cu_08f00e5112exact_kernelENS_5SceneE"),
              "_ZN7crumple4cuda12_GLOBAL__N_112exact_kernelENS_5SceneE");
    EXPECT_EQ(without_file("_ZN7crumple4cuda12_GLOBAL__N_112exact_kernelENS_5SceneE"),
              "_ZN7crumple4cuda12_GLOBAL__N_112exact_kernelENS_5SceneE");
    EXPECT_EQ(symbol_at(reinterpret_cast<const void*>(&find_instruction)).substr(0, 14), "_ZN7crumple3pt");
}

}  // namespace
}  // namespace crumple::ptx
