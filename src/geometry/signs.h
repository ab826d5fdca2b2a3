#pragma once

// Two classes that compute signs of orientation predicates for a decision. Both have the same functions: orient() for
// the sign of orient3d(), turn() for that of orient2d(). Compiled for host and device.

#include "geometry/predicates.h"

namespace crumple {

/// Signs by float64 filters alone, for any finite coordinates. If a filter does not decide a sign, the function returns
/// 0, and has_undecided() is true from then on.
class FilteredSigns {
   public:
    static constexpr bool exact = false;
    CRUMPLE_HD bool has_undecided() const { return has_undecided_; }

    CRUMPLE_HD int orient(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
        return known(orient3d_filtered(p, q, r, s));
    }
    CRUMPLE_HD int turn(const Vec3d& p, const Vec3d& q, const Vec3d& r, int axis) {
        return known(orient2d_filtered(p, q, r, axis));
    }

   private:
    CRUMPLE_HD int known(int sign) {
        has_undecided_ |= sign == undecided;
        return sign == undecided ? 0 : sign;
    }
    bool has_undecided_ = false;
};

/// Signs by filters, and by exact arithmetic if a filter does not decide. Coordinates must be in the range of
/// expansions.
class ExactSigns {
   public:
    static constexpr bool exact = true;
    /// True if filters did not decide some sign.
    CRUMPLE_HD bool expanded() const { return expanded_; }

    CRUMPLE_HD int orient(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
        const int sign = orient3d_filtered(p, q, r, s);
        return sign != undecided ? sign : orient_exactly(p, q, r, s);
    }
    /// Returns the sign of orient() without trying the filter, which is known to fail.
    CRUMPLE_HD int orient_exactly(const Vec3d& p, const Vec3d& q, const Vec3d& r, const Vec3d& s) {
        expanded_ = true;
        return orient3d_exact(p, q, r, s);
    }
    CRUMPLE_HD int turn(const Vec3d& p, const Vec3d& q, const Vec3d& r, int axis) {
        const int sign = orient2d_filtered(p, q, r, axis);
        if (sign != undecided) return sign;
        expanded_ = true;
        return orient2d_exact(p, q, r, axis);
    }

   private:
    bool expanded_ = false;
};

}  // namespace crumple
