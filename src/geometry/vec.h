#pragma once

// Vectors of three numbers, and their arithmetic. Compiled for host and device.

#include <cmath>
#include <cstdint>
#include <type_traits>

#ifdef __CUDACC__
#define CRUMPLE_HD __host__ __device__
#else
#define CRUMPLE_HD
#endif
/// Marks long code that is rarely run, which a device compiler would otherwise copy to each call.
#define CRUMPLE_HD_COLD CRUMPLE_HD __attribute__((noinline))

namespace crumple {

template <class T>
struct Vec3 {
    T x{}, y{}, z{};

    /// True if numbers and vectors are passed by value: numbers of up to 16 bytes. Integers of hundreds of bits take
    /// too long to copy.
    static constexpr bool by_value = sizeof(T) <= 16;
    using Number = std::conditional_t<by_value, T, const T&>;
    using Argument = std::conditional_t<by_value, Vec3, const Vec3&>;

    CRUMPLE_HD constexpr Number operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    CRUMPLE_HD constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

    friend CRUMPLE_HD constexpr Vec3 operator+(Argument a, Argument b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend CRUMPLE_HD constexpr Vec3 operator-(Argument a, Argument b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend CRUMPLE_HD constexpr Vec3 operator*(Number s, Argument a) { return {s * a.x, s * a.y, s * a.z}; }
    friend CRUMPLE_HD constexpr T dot(Argument a, Argument b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
    friend CRUMPLE_HD constexpr Vec3 cross(Argument a, Argument b) {
        return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    }
    friend CRUMPLE_HD constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

inline bool all_finite(const Vec3d& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

template <class T>
CRUMPLE_HD Vec3<T> abs(Vec3<T> a) {
    return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}
template <class T>
CRUMPLE_HD constexpr T min(T a, T b) {
    return b < a ? b : a;
}
template <class T>
CRUMPLE_HD constexpr T max(T a, T b) {
    return a < b ? b : a;
}
template <class T>
CRUMPLE_HD constexpr Vec3<T> min(Vec3<T> a, Vec3<T> b) {
    return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class T>
CRUMPLE_HD constexpr Vec3<T> max(Vec3<T> a, Vec3<T> b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
/// Swaps two values: std::swap for host and device.
template <class T>
CRUMPLE_HD constexpr void swap_values(T& a, T& b) {
    const T c = a;
    a = b;
    b = c;
}
template <class T>
CRUMPLE_HD constexpr T largest(Vec3<T> a) {
    return max(a.x, max(a.y, a.z));
}

}  // namespace crumple
