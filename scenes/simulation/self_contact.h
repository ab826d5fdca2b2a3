#pragma once

// Finds where cloth comes close to itself, by intersection queries of Crumple.
//
// Every point of the sheet has a whisker, a triangle as thin as a hair, which extends from the point along the sheet's
// normal to both sides. Sheet and whiskers are one soup in two groups. A whisker that meets a triangle is a contact
// between its point and this triangle; the solver keeps the point on the side on which it is. If contacts are found
// before a point has passed through the sheet, this keeps the sheet apart. An edge that passes through another edge
// between two whiskers is not noticed, and cloth that is pressed hard stays partly entangled.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/detector.h"
#include "scenes/simulation/fabric.h"

namespace crumple::scenes {

struct SelfContact {
    std::int32_t point;
    Fabric::Corners triangle;
    std::array<double, 3> weights;  ///< barycentric coordinates of the point's projection to the triangle
    double side;      ///< 1 if the point is on the side of the triangle's normal, or in its plane; else -1
    double distance;  ///< distance between the point and the triangle's plane
};

class SelfContactFinder {
   public:
    /// Returns the contacts of all points, in the order of the triangles: with triangles that do not have the point as
    /// a corner, and are at most `reach` away from it along the normal. Valid until the next call.
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
