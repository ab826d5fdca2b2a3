#pragma once

// Floating-point intrinsics. Those that name a rounding mode give the same bits as a device. The fast ones are computed
// as the host does it: a device differs in the last bits, so nothing may depend on these.

#include <cfenv>
#include <cmath>
#include <limits>

namespace cuda_on_cpu {

/// Returns f(a, b, c) in rounding mode `mode`. Volatile keeps the arithmetic between the two changes of mode.
template <class T, class F>
__attribute__((noinline)) auto rounded(int mode, F f, T a, T b = 0, T c = 0) {
    volatile T x = a, y = b, z = c;
    const int before = std::fegetround();
    std::fesetround(mode);
    volatile auto result = f(x, y, z);
    std::fesetround(before);
    return result;
}

template <class T>
T add(T a, T b, T) {
    return a + b;
}
template <class T>
T subtract(T a, T b, T) {
    return a - b;
}
template <class T>
T multiply(T a, T b, T) {
    return a * b;
}
template <class T>
T divide(T a, T b, T) {
    return a / b;
}
template <class T>
T reciprocal(T a, T, T) {
    return T{1} / a;
}
template <class T>
T square_root(T a, T, T) {
    return std::sqrt(a);
}
template <class T>
T multiply_add(T a, T b, T c) {
    return std::fma(a, b, c);
}

}  // namespace cuda_on_cpu

#define CUDA_ON_CPU_ROUNDED(suffix, mode)                                                                              \
    inline float __fadd_##suffix(float a, float b) {                                                                   \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::add<float>, a, b);                                              \
    }                                                                                                                  \
    inline float __fsub_##suffix(float a, float b) {                                                                   \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::subtract<float>, a, b);                                         \
    }                                                                                                                  \
    inline float __fmul_##suffix(float a, float b) {                                                                   \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::multiply<float>, a, b);                                         \
    }                                                                                                                  \
    inline float __fdiv_##suffix(float a, float b) {                                                                   \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::divide<float>, a, b);                                           \
    }                                                                                                                  \
    inline float __frcp_##suffix(float a) { return cuda_on_cpu::rounded(mode, cuda_on_cpu::reciprocal<float>, a); }    \
    inline float __fsqrt_##suffix(float a) { return cuda_on_cpu::rounded(mode, cuda_on_cpu::square_root<float>, a); }  \
    inline float __fmaf_##suffix(float a, float b, float c) {                                                          \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::multiply_add<float>, a, b, c);                                  \
    }                                                                                                                  \
    inline double __dadd_##suffix(double a, double b) {                                                                \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::add<double>, a, b);                                             \
    }                                                                                                                  \
    inline double __dsub_##suffix(double a, double b) {                                                                \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::subtract<double>, a, b);                                        \
    }                                                                                                                  \
    inline double __dmul_##suffix(double a, double b) {                                                                \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::multiply<double>, a, b);                                        \
    }                                                                                                                  \
    inline double __ddiv_##suffix(double a, double b) {                                                                \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::divide<double>, a, b);                                          \
    }                                                                                                                  \
    inline double __drcp_##suffix(double a) { return cuda_on_cpu::rounded(mode, cuda_on_cpu::reciprocal<double>, a); } \
    inline double __dsqrt_##suffix(double a) {                                                                         \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::square_root<double>, a);                                        \
    }                                                                                                                  \
    inline double __fma_##suffix(double a, double b, double c) {                                                       \
        return cuda_on_cpu::rounded(mode, cuda_on_cpu::multiply_add<double>, a, b, c);                                 \
    }                                                                                                                  \
    inline float __double2float_##suffix(double a) {                                                                   \
        return cuda_on_cpu::rounded(                                                                                   \
            mode, [](double x, double, double) { return static_cast<float>(x); }, a);                                  \
    }                                                                                                                  \
    inline float __int2float_##suffix(int a) { return __double2float_##suffix(a); }                                    \
    inline float __uint2float_##suffix(unsigned a) { return __double2float_##suffix(a); }
CUDA_ON_CPU_ROUNDED(ru, FE_UPWARD)
CUDA_ON_CPU_ROUNDED(rd, FE_DOWNWARD)
CUDA_ON_CPU_ROUNDED(rz, FE_TOWARDZERO)
#undef CUDA_ON_CPU_ROUNDED

// Kernels run in round-to-nearest mode already, so these need no change of mode. They are called most.
inline float __fadd_rn(float a, float b) { return a + b; }
inline float __fsub_rn(float a, float b) { return a - b; }
inline float __fmul_rn(float a, float b) { return a * b; }
inline float __fdiv_rn(float a, float b) { return a / b; }
inline float __frcp_rn(float a) { return 1.0f / a; }
inline float __fsqrt_rn(float a) { return std::sqrt(a); }
inline float __fmaf_rn(float a, float b, float c) { return std::fma(a, b, c); }
inline double __dadd_rn(double a, double b) { return a + b; }
inline double __dsub_rn(double a, double b) { return a - b; }
inline double __dmul_rn(double a, double b) { return a * b; }
inline double __ddiv_rn(double a, double b) { return a / b; }
inline double __drcp_rn(double a) { return 1.0 / a; }
inline double __dsqrt_rn(double a) { return std::sqrt(a); }
inline double __fma_rn(double a, double b, double c) { return std::fma(a, b, c); }
inline float __double2float_rn(double a) { return static_cast<float>(a); }
inline float __int2float_rn(int a) { return static_cast<float>(a); }
inline float __uint2float_rn(unsigned a) { return static_cast<float>(a); }
inline double __int2double_rn(int a) { return a; }

namespace cuda_on_cpu {

/// Converts to an integer as a device does: values out of range saturate, and NaN becomes 0.
template <class Integer, class T>
Integer saturate(T x) {
    using Limits = std::numeric_limits<Integer>;
    if (std::isnan(x)) return 0;
    if (x >= std::ldexp(T{1}, Limits::digits)) return Limits::max();
    if (x < static_cast<T>(Limits::min())) return Limits::min();
    return static_cast<Integer>(x);
}

}  // namespace cuda_on_cpu

#define CUDA_ON_CPU_TO_INTEGER(suffix, round)                                                              \
    inline int __float2int_##suffix(float x) { return cuda_on_cpu::saturate<int>(round(x)); }              \
    inline unsigned __float2uint_##suffix(float x) { return cuda_on_cpu::saturate<unsigned>(round(x)); }   \
    inline int __double2int_##suffix(double x) { return cuda_on_cpu::saturate<int>(round(x)); }            \
    inline unsigned __double2uint_##suffix(double x) { return cuda_on_cpu::saturate<unsigned>(round(x)); } \
    inline long long __double2ll_##suffix(double x) { return cuda_on_cpu::saturate<long long>(round(x)); }
CUDA_ON_CPU_TO_INTEGER(rn, std::nearbyint)
CUDA_ON_CPU_TO_INTEGER(rd, std::floor)
CUDA_ON_CPU_TO_INTEGER(ru, std::ceil)
CUDA_ON_CPU_TO_INTEGER(rz, std::trunc)
#undef CUDA_ON_CPU_TO_INTEGER

inline float __fdividef(float a, float b) { return a / b; }
inline float __frsqrt_rn(float a) { return static_cast<float>(1.0 / std::sqrt(static_cast<double>(a))); }
inline float rsqrtf(float a) { return 1.0f / std::sqrt(a); }
inline double rsqrt(double a) { return 1.0 / std::sqrt(a); }
inline float __saturatef(float a) { return a > 0.0f ? (a < 1.0f ? a : 1.0f) : 0.0f; }

// CUDA has min and max in the global namespace, for host and device.
#define CUDA_ON_CPU_MIN_MAX(type)                             \
    inline type min(type a, type b) { return b < a ? b : a; } \
    inline type max(type a, type b) { return a < b ? b : a; }
CUDA_ON_CPU_MIN_MAX(int)
CUDA_ON_CPU_MIN_MAX(unsigned)
CUDA_ON_CPU_MIN_MAX(long)
CUDA_ON_CPU_MIN_MAX(unsigned long)
CUDA_ON_CPU_MIN_MAX(long long)
CUDA_ON_CPU_MIN_MAX(unsigned long long)
#undef CUDA_ON_CPU_MIN_MAX
// The minimum and the maximum of a number and NaN are the number.
inline float min(float a, float b) { return std::fmin(a, b); }
inline float max(float a, float b) { return std::fmax(a, b); }
inline double min(double a, double b) { return std::fmin(a, b); }
inline double max(double a, double b) { return std::fmax(a, b); }
