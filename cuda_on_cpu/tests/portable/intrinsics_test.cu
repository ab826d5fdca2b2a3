// Intrinsics, which give the same bits on the CPU as on a device. Expectations are worked out by hand.

#include <cmath>
#include <cstdint>
#include <limits>

#include "cuda_on_cpu/tests/portable/portable.h"

namespace {

using portable::Array;
using portable::launch;

class Intrinsics : public portable::DeviceTest {};

__global__ void of_integers(unsigned x, unsigned long long y, long long* out) {
    const int s = static_cast<int>(x);
    int k = 0;
    out[k++] = __popc(x);
    out[k++] = __popcll(y);
    out[k++] = __clz(s);
    out[k++] = __clz(0);
    out[k++] = __clzll(1);
    out[k++] = __ffs(s);
    out[k++] = __ffs(0);
    out[k++] = __ffsll(static_cast<long long>(y));
    out[k++] = __brev(x);
    out[k++] = static_cast<long long>(__brevll(y));
    out[k++] = __byte_perm(0x33221100u, 0x77665544u, 0x7250u);
    out[k++] = __byte_perm(0x33228100u, 0x77665544u, 0x0990u);
    out[k++] = __funnelshift_l(0x80000001u, 0x12345678u, 4);
    out[k++] = __funnelshift_r(0x80000001u, 0x12345678u, 4);
    out[k++] = __umulhi(0xffffffffu, 0xffffffffu);
    out[k++] = __mulhi(-2, 3);
    out[k++] = static_cast<long long>(__umul64hi(~0ull, ~0ull));
    out[k++] = min(3, -4) + static_cast<int>(max(3u, 4u));
    out[k++] = static_cast<long long>(min(2.5f, NAN) + max(NAN, 0.5f));
}

TEST_F(Intrinsics, integer_intrinsics_give_known_values) {
    const std::vector<long long> expected = {5,
                                             2,
                                             7,
                                             32,
                                             63,
                                             4,
                                             0,
                                             34,
                                             0x1a800080ll,
                                             static_cast<long long>(0x0000000040000001ull),
                                             0x77225500ll,
                                             0x00818100ll,
                                             0x23456788ll,
                                             0x88000000ll,
                                             0xfffffffell,
                                             -1,
                                             static_cast<long long>(0xfffffffffffffffeull),
                                             0,
                                             3};
    const Array<long long> out(expected.size());
    // 0x01000158: bits 3, 4, 6, 8, 24
    launch(of_integers, 1, 1, 0, 0x01000158u, 0x8000000200000000ull, out.data());
    EXPECT_EQ(out.values(), expected);
}

__global__ void rounded(float a, float b, double c, double d, double* out) {
    int k = 0;
    out[k++] = __fadd_rd(a, b);
    out[k++] = __fadd_ru(a, b);
    out[k++] = __fadd_rn(a, b);
    out[k++] = __fsub_ru(a, b);
    out[k++] = __fsub_rz(a, b);
    out[k++] = __fdiv_rd(a, 3.0f);
    out[k++] = __fdiv_ru(a, 3.0f);
    out[k++] = __fmul_rz(-a - b * 4096.0f, a + b * 4096.0f);
    out[k++] = __dadd_ru(c, d);
    out[k++] = __dadd_rd(c, d);
    out[k++] = __double2float_rd(0.1);
    out[k++] = __double2float_ru(0.1);
    out[k++] = __fsqrt_rd(2.0f);
    out[k++] = __fsqrt_ru(2.0f);
    out[k++] = __fmaf_rn(a + b * 4096.0f, a + b * 4096.0f, -1.0f);
    out[k++] = __fma_rn(c + 0x1p-30, c + 0x1p-30, -1.0);
}

TEST_F(Intrinsics, rounding_intrinsics_give_known_values) {
    const float below = std::nextafter(1.0f, 0.0f), above = std::nextafter(1.0f, 2.0f);
    const float root = 1.41421354f;  // the float just below the square root of 2
    const std::vector<double> expected = {1.0f,
                                          above,
                                          1.0f,
                                          1.0f,
                                          below,
                                          std::nextafter(1.0f / 3, 0.0f),
                                          1.0f / 3,
                                          -(1 + 0x1p-17),
                                          1 + 0x1p-52,
                                          1.0,
                                          std::nextafter(0.1f, 0.0f),
                                          0.1f,
                                          root,
                                          std::nextafter(root, 2.0f),
                                          0x1p-17 + 0x1p-36,
                                          0x1p-29 + 0x1p-60};
    const Array<double> out(expected.size());
    launch(rounded, 1, 1, 0, 1.0f, 0x1p-30f, 1.0, 0x1p-60, out.data());
    const std::vector<double> found = out.values();
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k], expected[k]) << k;
}

__global__ void converted(const float* in, int n, int* out) {
    for (int i = 0; i < n; ++i) {
        out[i * 5 + 0] = __float2int_rn(in[i]);
        out[i * 5 + 1] = __float2int_rd(in[i]);
        out[i * 5 + 2] = __float2int_ru(in[i]);
        out[i * 5 + 3] = __float2int_rz(in[i]);
        out[i * 5 + 4] = static_cast<int>(__float2uint_rd(in[i]));
    }
}

TEST_F(Intrinsics, conversions_to_integers_saturate) {
    const std::vector<float> in = {2.5f, -2.5f, 1e20f, -1e20f, -0.0f};
    const int top = std::numeric_limits<int>::max(), bottom = std::numeric_limits<int>::min();
    const std::vector<int> expected = {2,   2,  3,      2,      2,      -2,     -3, -2, -2, 0, top, top, top,
                                       top, -1, bottom, bottom, bottom, bottom, 0,  0,  0,  0, 0,   0};
    const Array<float> from(in);
    const Array<int> out(expected.size());
    launch(converted, 1, 1, 0, from.data(), 5, out.data());
    EXPECT_EQ(out.values(), expected);
}

__global__ void reread(const float4* in, unsigned* bits, double* d, int2* pair) {
    const float4 v = __ldg(in);
    bits[0] = __float_as_uint(v.x);
    bits[1] = static_cast<unsigned>(__float_as_int(v.y));
    d[0] = __hiloint2double(static_cast<int>(0xbff80000u), 0);
    d[1] = __longlong_as_double(__double_as_longlong(v.z));
    d[2] = __uint_as_float(0x7f800000u);
    d[3] = __int_as_float(__double2hiint(2.0));
    *pair = make_int2(__double2loint(0x1.00000abcdp0), warpSize);
}

TEST_F(Intrinsics, bits_are_reinterpreted_unchanged) {
    const Array<float4> in(std::vector<float4>{make_float4(1.0f, -0.0f, 3.0f, 4.0f)});
    const Array<unsigned> bits(2);
    const Array<double> d(4);
    const Array<int2> pair(1);
    launch(reread, 1, 1, 0, in.data(), bits.data(), d.data(), pair.data());
    EXPECT_EQ(bits.values(), (std::vector<unsigned>{0x3f800000u, 0x80000000u}));
    EXPECT_EQ(d.values(), (std::vector<double>{-1.5, 3.0, std::numeric_limits<double>::infinity(), 2.0}));
    EXPECT_EQ(pair.values()[0].x, static_cast<int>(0xabcd0000u));
    EXPECT_EQ(pair.values()[0].y, 32);
    static_assert(sizeof(float3) == 12 && alignof(float2) == 8 && alignof(float4) == 16 && alignof(double2) == 16);
}

}  // namespace
