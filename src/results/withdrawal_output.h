#pragma once

// Withdrawals of a row, and the bounds on the least translation that they give.

#include <cmath>
#include <limits>
#include <vector>

#include "exact/withdrawal/translation_bound.h"
#include "results/overlap_output.h"

namespace crumple {

/// Sets the withdrawals of a row along the directions of the query, and its bounds on the least translation.
/// withdraw(direction): the greatest t ≥ 0 at which the first surface and the second one, moved by t · direction, meet.
/// projected_area(side): ProjectedArea::bound() of a surface.
template <class Withdraw, class AreaOf>
void add_withdrawals(const OverlapQuery& query, Withdraw withdraw, AreaOf projected_area, OverlapRow& row) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    TranslationBounds& bounds = row.translation;
    const auto consider = [&](const Vec3d& direction, double t) {
        // Rounded up: t is at least the exact one, and the product has a relative error of at most 2^-51. The direction
        // is scaled, because its length may be subnormal or exceed all float64 numbers.
        const int exponent = std::ilogb(largest(abs(direction)));
        const double scaled = std::hypot(std::ldexp(direction.x, -exponent), std::ldexp(direction.y, -exponent),
                                         std::ldexp(direction.z, -exponent));
        const double length = t == 0 ? 0 : std::nextafter(std::ldexp((1 + 0x1p-50) * scaled * t, exponent), infinity);
        if (!std::isfinite(length) || length >= bounds.high) return;
        bounds.high = length;
        for (int axis = 0; axis < 3; ++axis) bounds.translation[axis] = t * direction[axis] + 0.0;
    };
    if (query.translation) {
        const Vec3d& normal = row.numbers.normal;
        if (all_finite(normal))
            for (const Vec3d& direction : {normal, Vec3d{} - normal}) consider(direction, withdraw(direction));
        if (row.relation != OverlapRelation::undefined)
            bounds.low = least_translation(projected_area(0), projected_area(1), row.numbers.volume.value);
    }
    for (const auto& [x, y, z] : query.directions) {
        const Vec3d direction{x, y, z};
        row.withdrawals.push_back(withdraw(direction));
        if (query.translation) consider(direction, row.withdrawals.back());
    }
}

}  // namespace crumple
