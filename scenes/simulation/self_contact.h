#pragma once

// Finds where cloth comes close to itself, by intersection queries of Crumple.
// Every point of the sheet carries a whisker, a triangle that is thin as a hair: it extends from the point along the
// sheet's normal, to both sides. Sheet and whiskers are one soup in two groups, and a whisker that meets a triangle is
// a contact, on the point's side. Queried before a point has passed through, this keeps the sheet apart. Edges that
// pass through edges between two whiskers go unnoticed, and cloth that is pressed hard stays partly entangled.

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
    double side;                    ///< 1 if the point is on the side to which the triangle's normal points, else -1
    double distance;                ///< between the point and the triangle's plane
};

class SelfContactFinder {
   public:
    /// Returns the contacts of all points with triangles that are not their own and at most `reach` away along the
    /// normal, in the order of the triangles. Valid until the next call.
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
