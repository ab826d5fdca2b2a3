#pragma once

// Finds where cloth is near itself and obstacles, and shortens steps so that nothing touches, by Crumple's queries
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

/// Vertex and face, or two edges, that are near each other. The vector from the closest point of the second feature to
/// that of the first is the sum of `weights` times positions.
struct NearContact {
    std::array<std::int32_t, 4> points;
    std::array<double, 4> weights;  ///< those of the first sum to 1, those of the second to -1
    Vec3d direction{};              ///< unit vector along it when the contact was found
    double distance = 0;            ///< length of the vector then

    /// Returns the vector between the same points of the features, for other positions.
    Vec3d way(std::span<const Vec3d> positions) const;
};

class NearContactFinder {
   public:
    NearContactFinder(std::span<const Fabric::Corners> cloth, std::span<const Fabric::Corners> obstacles);

    /// Returns all pairs of features within `radius`, except pairs of obstacles, vertices and faces first. Throws Error
    /// (invalid_argument) if any touch, as there is no direction to separate them. Valid until the next call.
    std::span<const NearContact> find(std::span<const Vec3d> points, double radius);

    struct FreePath {
        double toi;    ///< share of the step until the first pair would have met; 1: none before its end
        double share;  ///< share of the step that all points made, after single points were held back
    };

    /// Shortens the step from `start` to `end` until nothing touches during it, for exactly the numbers left in `end`.
    /// Holds back points that would touch something, unless they are `held`, that is, driven. If that does not suffice,
    /// shortens the step of all points. Cost: one motion query, several if something would touch.
    FreePath shorten(std::span<const Vec3d> start, std::span<Vec3d> end, std::span<const std::uint8_t> held);

   private:
    MeshView view(std::span<const Vec3d> points) const;
    void hold_back(const Impacts& impacts, std::span<const Vec3d> start, std::span<Vec3d> end,
                   std::span<const std::uint8_t> held);

    Detector detector_{{.backend = Backend::cpu}};  // each step moves the points in host memory
    std::vector<Fabric::Corners> triangles_;        // of the cloth, then of obstacles
    std::vector<std::int32_t> groups_;
    PairFilter rules_;
    std::vector<double> toi_;  // of each point
    std::vector<NearContact> contacts_;
};

}  // namespace crumple::scenes
