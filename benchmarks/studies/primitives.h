#pragma once

// Triangles with centroids and radii, as the stages before `narrow` use them, but in float64. For studies that compare
// the library's algorithms with others.

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/vec.h"
#include "workload.h"

namespace crumple::benchmark {

struct Primitive {
    std::array<Vec3d, 3> corner;
    Vec3d centroid;
    double radius = 0;  ///< distance from the centroid to the farthest corner
};

inline std::vector<Primitive> primitives_of(const io::TriangleMesh& mesh) {
    const std::vector<double> xyz = coordinates<double>(mesh);
    std::vector<Primitive> primitives(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::size_t t = 0; t < primitives.size(); ++t) {
        Primitive& p = primitives[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const double* at = xyz.data() + 3 * static_cast<std::size_t>(mesh.triangles[3 * t + k]);
            p.corner[k] = {at[0], at[1], at[2]};
        }
        p.centroid = (1.0 / 3.0) * (p.corner[0] + p.corner[1] + p.corner[2]);
        for (const Vec3d& corner : p.corner)
            p.radius = std::max(p.radius, std::sqrt(dot(corner - p.centroid, corner - p.centroid)));
    }
    return primitives;
}

/// Returns a mesh of the chosen triangles, in their order, which has only the vertices of these triangles.
inline io::TriangleMesh extract(const io::TriangleMesh& mesh, const std::vector<std::int32_t>& chosen) {
    io::TriangleMesh part;
    std::visit(
        [&](const auto& xyz) {
            auto& own = part.vertices.template emplace<std::decay_t<decltype(xyz)>>();
            std::vector<std::int32_t> place(xyz.size() / 3, -1);
            for (const std::int32_t t : chosen) {
                for (std::size_t c = 3 * static_cast<std::size_t>(t); c < 3 * static_cast<std::size_t>(t) + 3; ++c) {
                    const auto v = static_cast<std::size_t>(mesh.triangles[c]);
                    if (place[v] < 0) {
                        place[v] = static_cast<std::int32_t>(own.size() / 3);
                        for (const std::size_t axis : {0u, 1u, 2u}) own.push_back(xyz[3 * v + axis]);
                    }
                    part.triangles.push_back(place[v]);
                }
            }
        },
        mesh.vertices);
    return part;
}

}  // namespace crumple::benchmark
