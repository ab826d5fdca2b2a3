#pragma once

// What comes close to what, cloth to itself and to obstacles, and how far all may go until something touches: by
// Crumple's nearness and motion (docs/nearness.md, docs/motion.md).
//
// Cloth and obstacles are one mesh. It is read where the solver has it, in float64, so what is found to be free is free
// for the solver's own numbers. Obstacles are not tested against each other.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/detector.h"
#include "geometry/vec.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

/// A vertex and a face, or two edges, that are near each other. The way from the closest point of the second to that of
/// the first is the sum of `weights` times positions.
struct NearContact {
    std::array<std::int32_t, 4> points;
    std::array<double, 4> weights;  ///< those of the first sum to 1, those of the second to -1
    Vec3d direction{};              ///< of that way when the contact was found, of length 1
    double distance = 0;            ///< its length then

    /// The way between the same two points, for other positions.
    Vec3d way(std::span<const Vec3d> positions) const;
};

class NearContactFinder {
   public:
    NearContactFinder(std::span<const Fabric::Corners> cloth, std::span<const Fabric::Corners> obstacles);

    /// All pairs of features within `radius` but those of obstacles alone, vertices and faces first. Throws Error
    /// (invalid_argument) if any touch: there is no direction to part them. Valid until the next call.
    std::span<const NearContact> find(std::span<const Vec3d> points, double radius);

    struct FreeWay {
        double toi;    ///< share of the way until the first pair would have met; 1: none would have before the end
        double share;  ///< share of it that all went, after single points had been held back
    };

    /// Shortens the way from `start` to `end` until nothing touches on it: it is free for the numbers that are left in
    /// `end`. Points on course for something are held back, unless they are `held`, which is to say driven; if that
    /// does not do, everything goes less far. Cost: a question about motion, several where something would touch.
    FreeWay shorten(std::span<const Vec3d> start, std::span<Vec3d> end, std::span<const std::uint8_t> held);

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
