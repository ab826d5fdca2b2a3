#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/export.h"
#include "crumple/world.h"

namespace crumple {

/// A motion of rigid bodies in pieces, in each of which vertices go straight, as queries about motion see them
/// (docs/motion.md#rigid-motions).
struct RigidMotion {
    std::int64_t pieces = 0;
    std::vector<Pose> poses;  ///< moment by moment, pieces + 1 of them: one a body
    /// Bound on how much nearer two bodies come in the motion than in its pieces: what to add to a minimum distance, so
    /// that no piece misses a contact of the motion.
    double min_distance = 0;

    /// Poses at the start of piece k; those at its end are at(k + 1).
    std::span<const Pose> at(std::int64_t k) const {
        const std::size_t bodies = poses.size() / static_cast<std::size_t>(pieces + 1);
        return std::span(poses).subspan(static_cast<std::size_t>(k) * bodies, bodies);
    }
};

/// Cuts the motion of bodies from the poses at the start to those at the end into as few equal pieces as keep
/// `min_distance` within `tolerance`, above 0, and some units in the last place of the largest coordinate. Each body
/// turns about its origin by at most half a turn at a constant rate about a fixed axis, while the origin goes straight.
///
/// `radii`: one a body, the largest distance of a vertex from the origin of its shape. Poses are rotations and
/// translations, one a body. Throws Error (invalid_argument) for others, with the body, and where 1,048,576 pieces do
/// not suffice. Cost: O(bodies times pieces).
CRUMPLE_API RigidMotion cut_rigid_motion(std::span<const Pose> start, std::span<const Pose> end,
                                         std::span<const double> radii, double tolerance);

}  // namespace crumple
