#pragma once

// Small cases that exercise every path of the exact arithmetic, to compare a device with the host (comparison_cases.h).
// Each case is a pair of moving triangles that may share one or two vertices. Most start on a small integer grid, where
// signs are often 0 or can be decided only with expansions.

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/vec.h"

namespace crumple::cuda {

struct ComparisonCases {
    /// Vertices at the start and at the end of the motion, six per case.
    std::vector<Vec3d> start, end;
    /// Vertex indices, three per triangle; triangles 2i and 2i + 1 are case i. If they share vertices, the second
    /// triangle refers to vertices of the first, and nothing refers to the vertices that these replace.
    std::vector<std::int32_t> corners;

    std::size_t count() const { return corners.size() / 6; }
};

/// Returns pseudo-random cases, identical on every machine.
inline ComparisonCases make_comparison_cases(std::size_t count) {
    std::uint64_t state = 1;
    const auto below = [&](std::uint64_t n) {  // pseudo-random integer below n, after Vigna's splitmix64
        std::uint64_t z = state += 0x9e3779b97f4a7c15;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
        z = (z ^ z >> 27) * 0x94d049bb133111eb;
        return static_cast<double>((z ^ z >> 31) % n);
    };
    const auto on_grid = [&](std::uint64_t width) {
        const double x = below(width), y = below(width);
        return Vec3d{x, y, below(width)};
    };
    ComparisonCases cases;
    for (std::size_t i = 0; i < count; ++i) {
        std::array<Vec3d, 6> p;
        for (Vec3d& corner : p) corner = on_grid(4);
        const Vec3d u = p[1] - p[0], v = p[2] - p[0];
        std::size_t shared = 0;
        switch (i % 10) {
            case 0:  // triangles that share no vertex
                break;
            case 1:  // triangles that share 1 or 2 vertices
                shared = 1 + i / 10 % 2;
                break;
            case 2:  // triangles that share 1 or 2 vertices, in one plane
                shared = 1 + i / 10 % 2;
                for (Vec3d& corner : p) corner.z = 0;
                break;
            case 3:  // triangles in one plane
                for (Vec3d& corner : p) corner.z = corner.x - 2 * corner.y;
                break;
            case 4:  // degenerate: collinear corners
                p[2] = p[0] + 2 * u;
                break;
            case 5:  // a corner in the other triangle's plane, or on its edge
                p[3] = p[0] + 0.25 * (u + below(4) * v);
                break;
            case 6:  // almost coplanar, because of rounding
                for (std::size_t k = 0; k < 3; ++k) p[k] = (1. / 3) * p[k] + Vec3d{0.1, 0.2, 0.3};
                for (std::size_t k = 3; k < 6; ++k)
                    p[k] = p[0] + (1. / 7) * (below(8) * (p[1] - p[0]) + below(8) * (p[2] - p[0]));
                break;
            case 7:  // coordinates of widely different magnitude
                for (Vec3d& corner : p)
                    corner = {corner.x + 0x1p-52 * below(4), 0x1p30 * corner.y + below(4), corner.z - 0x1p-40};
                break;
            case 8:  // for i = 8 beyond the range of expansions, else as in case 0
                if (i == 8)
                    for (Vec3d& corner : p) corner = 0x1p310 * corner;
                break;
            default:  // crossing triangles with a contact that is rounded
                p = {Vec3d{0, 0, 0}, {3, 0, 0.1 * below(9)}, {0, 3, 0},
                     {1, 1, -1},     {1, 1, 1 + below(3)},   {0.7, 2.3, 1}};
                break;
        }
        for (std::size_t k = 0; k < 6; ++k) {
            const std::size_t corner = k >= 3 && k - 3 < shared ? k - 3 : k;
            cases.corners.push_back(static_cast<std::int32_t>(6 * i + corner));
            cases.start.push_back(p[k]);
            // Each corner moves independently: in every third case by integers, in the others by 0.3 times integers, so
            // that end positions are rounded.
            const Vec3d way = on_grid(5) - Vec3d{2, 2, 2};
            cases.end.push_back(p[k] + (i % 3 == 0 ? 1 : 0.3) * way);
        }
    }
    return cases;
}

}  // namespace crumple::cuda
