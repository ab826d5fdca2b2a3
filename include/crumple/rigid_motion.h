#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/export.h"
#include "crumple/world.h"

namespace crumple {

/// Motion of rigid bodies, cut into pieces in which vertices move straight, as queries about motion assume
/// (docs/motion.md, "Rigid motions").
struct RigidMotion {
    std::int64_t pieces = 0;
    std::vector<Pose> poses;  ///< one per body for each of pieces + 1 times
    /// Upper bound on how much nearer two bodies come in the exact motion than in the pieces. Add it to a minimum
    /// distance so that no piece misses a contact of the motion.
    double min_distance = 0;

    /// Returns the poses at the start of piece k; those at its end are at(k + 1).
    std::span<const Pose> at(std::int64_t k) const {
        const std::size_t bodies = poses.size() / static_cast<std::size_t>(pieces + 1);
        return std::span(poses).subspan(static_cast<std::size_t>(k) * bodies, bodies);
    }
};

/// Cuts the motion from the poses at the start to those at the end into the smallest number of equal pieces that keeps
/// `min_distance` within `tolerance` (above 0), plus some units in the last place of the largest coordinate. Each body
/// turns about its origin by at most half a turn, at a constant rate about a fixed axis, while the origin moves
/// straight.
///
/// `radii`: one per body, the largest distance of a vertex from the origin of its shape. Poses must be rotations with
/// translations, one per body. Throws Error (invalid_argument) that names the body for other poses, and if 1,048,576
/// pieces do not suffice. Cost: O(bodies times pieces).
CRUMPLE_API RigidMotion cut_rigid_motion(std::span<const Pose> start, std::span<const Pose> end,
                                         std::span<const double> radii, double tolerance);

}  // namespace crumple
