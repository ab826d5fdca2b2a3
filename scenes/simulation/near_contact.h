#pragma once

// Finds where cloth is near itself or obstacles, and shortens steps so that nothing touches. Uses Crumple's queries
// about nearness and motion (docs/nearness.md, docs/motion.md). Cloth and obstacles are one mesh. Its points are the
// solver's own, in float64, so a step that is found to be free is free for exactly these numbers. Obstacles are not
// tested against each other.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/detector.h"
#include "geometry/vec.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

/// Pair of features that are near each other: a vertex and a face, or two edges. The vector from the closest point of
/// the second feature to the closest point of the first is the sum of `weights` times the positions of `points`.
struct NearContact {
    std::array<std::int32_t, 4> points;
    std::array<double, 4> weights;  ///< sums: 1 over points of the first feature, -1 of the second
    Vec3d direction{};              ///< unit vector along this vector when the contact was found
    double distance = 0;            ///< length of this vector when the contact was found

    /// Returns this vector, between the same points of the features, for the given positions.
    Vec3d way(std::span<const Vec3d> positions) const;
};

class NearContactFinder {
   public:
    NearContactFinder(std::span<const Fabric::Corners> cloth, std::span<const Fabric::Corners> obstacles);

    /// Returns all pairs of features within `radius`, except pairs of two obstacles: first vertex-face pairs, then
    /// edge-edge pairs. Throws Error (invalid_argument) if any pair touches, because there is no direction in which to
    /// separate it. Valid until the next call.
    std::span<const NearContact> find(std::span<const Vec3d> points, double radius);

    struct FreePath {
        /// Fraction of the step until the first pair would have come too close, which is to a tenth of its distance at
        /// the start; 1: none would have.
        double toi;
        double share;  ///< fraction of its remaining movement that each point made
    };

    /// Changes `end` until nothing touches during the step from `start` to `end`, decided exactly for the resulting
    /// numbers. Holds back points that would touch something, unless they are `held` (moved by the caller). If this
    /// does not suffice, shortens the step of all points. Cost: one motion query, several if something would touch.
    FreePath shorten(std::span<const Vec3d> start, std::span<Vec3d> end, std::span<const std::uint8_t> held);

   private:
    MeshView view(std::span<const Vec3d> points) const;
    void hold_back(const Impacts& impacts, std::span<const Vec3d> start, std::span<Vec3d> end,
                   std::span<const std::uint8_t> held);

    Detector detector_{{.backend = Backend::cpu}};  // each step moves the points in host memory
    std::vector<Fabric::Corners> triangles_;        // of the cloth, then of the obstacles
    std::vector<std::int32_t> groups_;
    PairFilter rules_;
    std::vector<double> toi_;  // by point: time of its first impact
    std::vector<NearContact> contacts_;
};

}  // namespace crumple::scenes
