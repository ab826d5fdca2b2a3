#pragma once

// Moving points as polynomials in t over the integers, for exact decisions. Host only.

#include <array>

#include "exact/impact/impact.h"
#include "exact/impact/polynomial.h"
#include "exact/integer.h"

namespace crumple {

/// Moving point: three polynomials in t of degree 1. Vectors between such points, and their products, have the same
/// type with higher degrees.
using Path = Vec3<Polynomial>;

/// Returns the exponent of the largest power of two of which every coordinate is a multiple.
template <std::size_t N>
int common_exponent(const std::array<MovingPoint, N>& points) {
    std::array<Vec3d, 2 * N> ends;
    for (std::size_t i = 0; i < N; ++i) {
        ends[2 * i] = points[i].start;
        ends[2 * i + 1] = points[i].end;
    }
    return common_exponent(std::span<const Vec3d>(ends));
}

/// Returns the points' paths in units of 2^exponent, in which all coordinates must be integers.
template <std::size_t N>
std::array<Path, N> paths(const std::array<MovingPoint, N>& points, int exponent) {
    std::array<Path, N> result;
    for (std::size_t i = 0; i < N; ++i) {
        const Vec3<Integer> start = in_units(points[i].start, exponent), end = in_units(points[i].end, exponent);
        for (int axis = 0; axis < 3; ++axis) result[i][axis] = Polynomial({start[axis], end[axis] - start[axis]});
    }
    return result;
}

template <std::size_t N>
std::array<Path, N> paths(const std::array<MovingPoint, N>& points) {
    return paths(points, common_exponent(points));
}

}  // namespace crumple
