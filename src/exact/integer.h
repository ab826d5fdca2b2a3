#pragma once

// Integers of any width, and conversion of float64 numbers to them. Every finite float64 is an integer times a power of
// two, so if one power is used for all coordinates of a decision, integer arithmetic suffices for it. Host only.

#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <boost/multiprecision/cpp_int.hpp>

#include "geometry/vec.h"

namespace crumple {

namespace mp = boost::multiprecision;

/// An integer of any width; up to 512 bits do not allocate.
using Integer =
    mp::number<mp::cpp_int_backend<512, 0, mp::signed_magnitude, mp::unchecked, std::allocator<mp::limb_type>>,
               mp::et_off>;

/// The number mantissa · 2^exponent with an odd mantissa; for 0 both are 0.
struct Binary {
    std::int64_t mantissa = 0;
    int exponent = 0;

    explicit Binary(double x) {
        if (x == 0) return;
        constexpr std::uint64_t fraction_bits = 52, one = std::uint64_t{1} << fraction_bits;
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const auto biased = static_cast<int>(bits >> fraction_bits & 0x7ff);
        const std::uint64_t magnitude = (bits & (one - 1)) | (biased != 0 ? one : 0);  // 0: a subnormal number
        const int zeros = std::countr_zero(magnitude);
        mantissa = static_cast<std::int64_t>(magnitude >> zeros);
        if (x < 0) mantissa = -mantissa;
        exponent = std::max(biased, 1) - 1075 + zeros;
    }
};

/// Returns the exponent of the largest power of two of which every coordinate is a multiple; 0 if all are zero.
inline int common_exponent(std::span<const Vec3d> points) {
    int exponent = INT_MAX;
    for (const Vec3d& p : points) {
        for (int axis = 0; axis < 3; ++axis) {
            if (p[axis] != 0) exponent = std::min(exponent, Binary(p[axis]).exponent);
        }
    }
    return exponent == INT_MAX ? 0 : exponent;
}

/// Returns x in units of 2^exponent, of which x must be a multiple.
inline Integer in_units(double x, int exponent) {
    const Binary binary(x);
    return binary.mantissa == 0 ? Integer(0) : Integer(binary.mantissa) << (binary.exponent - exponent);
}

inline Vec3<Integer> in_units(const Vec3d& p, int exponent) {
    return {in_units(p.x, exponent), in_units(p.y, exponent), in_units(p.z, exponent)};
}

template <std::size_t N>
std::array<Vec3<Integer>, N> in_units(const std::array<Vec3d, N>& points, int exponent) {
    std::array<Vec3<Integer>, N> result;
    for (std::size_t i = 0; i < N; ++i) result[i] = in_units(points[i], exponent);
    return result;
}

}  // namespace crumple
