#pragma once

// Where cloth comes close to itself, found by Crumple.
//
// Every point of the sheet carries a whisker, a triangle that is thin as a hair: it reaches from the point along the
// sheet's normal, to both sides. Sheet and whiskers are one soup in two groups, and a whisker that meets a triangle
// tells which one, on which side. Asked before a point has gone through, that keeps the sheet apart; edges that pass
// through edges between two whiskers go unnoticed, and cloth that is pressed hard stays partly entangled.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/detector.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

struct SelfContact {
    std::int32_t point;
    Fabric::Corners triangle;
    std::array<double, 3> weights;  ///< barycentric, of the point's projection to the triangle
    double side;                    ///< 1 if the point is on the side that the triangle's normal shows to, else -1
    double distance;                ///< between the point and the triangle's plane
};

class SelfContactFinder {
   public:
    /// Contacts of all points with triangles that are not their own and at most `reach` away along the normal; in the
    /// order of the triangles. Valid until the next call.
    std::span<const SelfContact> find(std::span<const Vec3d> points, std::span<const Fabric::Corners> triangles,
                                      double reach);

   private:
    Detector detector_{{.backend = Backend::cpu}};  // each step moves the points in host memory
    std::vector<Vec3d> normals_;
    std::vector<float> vertices_;
    std::vector<Fabric::Corners> soup_;
    std::vector<std::int32_t> groups_;
    std::vector<SelfContact> contacts_;
};

}  // namespace crumple::scenes
