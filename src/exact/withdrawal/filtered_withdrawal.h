#pragma once

// Interval that contains how far one triangle has to move along a direction until it is past another one, in double
// words. Host only.

#include <limits>

#include "exact/overlap/face_crossing.h"

namespace crumple {

/// Bounds on withdrawal_rationally() (exact_withdrawal.h).
struct WithdrawalBounds {
    /// At most the greatest t; −infinity if it is not certain that there is a t.
    double lower = -std::numeric_limits<double>::infinity();
    /// At least the greatest t; −infinity if there is certainly no t.
    double upper = -std::numeric_limits<double>::infinity();
};

/// Returns bounds for two triangles. `axis`: an axis along which the direction's component is not 0, best the largest
/// one. All coordinates must be in the range of double-double arithmetic (in_double_word_range()). The bounds differ by
/// a few units in the last place, unless features are almost parallel to each other or to the direction. Cost: about
/// 1 us.
WithdrawalBounds enclose_withdrawal(const FaceCorners& a, const FaceCorners& b, const Vec3d& direction, int axis);

}  // namespace crumple
