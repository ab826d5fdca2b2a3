#pragma once

// Finds where cloth is near itself or obstacles, and shortens steps so that nothing touches. Uses Crumple's queries
// about nearness and motion (docs/nearness.md, docs/motion.md). Cloth and obstacles are one mesh. Its points are the
// solver's own, in float64, so a step that is found to be free is free for exactly these numbers. Obstacles are not
// tested against each other.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/detector.h"
#include "crumple/stencils.h"
#include "geometry/vec.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

class NearContactFinder {
   public:
    NearContactFinder(std::span<const Fabric::Corners> cloth, std::span<const Fabric::Corners> obstacles);

    /// Returns the stencils of all pairs of features within `radius`, except pairs of two obstacles. Throws Error
    /// (invalid_argument) if any pair touches, because there is no direction in which to separate it. Valid until the
    /// next call.
    const Stencils& find(std::span<const Vec3d> points, double radius);

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
    void hold_back(const MeshView& step, const Impacts& impacts, std::span<const Vec3d> start, std::span<Vec3d> end,
                   std::span<const std::uint8_t> held);

    Detector detector_{{.backend = Backend::cpu}};  // each step moves the points in host memory
    std::vector<Fabric::Corners> triangles_;        // of the cloth, then of the obstacles
    std::vector<std::int32_t> groups_;
    PairFilter rules_;
    std::vector<double> toi_;  // by point: time of its first impact
    Stencils contacts_;
};

}  // namespace crumple::scenes
