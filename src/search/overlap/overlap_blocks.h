#pragma once

// Copies faces and segments to blocks, the input of kernels (backends/overlap_kernels.h). Host only.

#include <algorithm>
#include <span>

#include "backends/overlap_kernels.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

namespace detail {
template <std::size_t size>
void put(const Vec3d& p, std::size_t i, double (&to)[3][size]) {
    for (int axis = 0; axis < 3; ++axis) to[axis][i] = p[axis];
}
inline std::size_t padded(std::size_t count) {
    return (count + WordSum::most_lanes - 1) / WordSum::most_lanes * WordSum::most_lanes;
}
}  // namespace detail

inline void fill(const SurfacePair& surfaces, std::size_t side, std::span<const CountedFace> faces, FaceBlock& block) {
    block.count = static_cast<int>(faces.size());
    for (std::size_t i = 0; i < detail::padded(faces.size()); ++i) {
        const auto& [face, times] = faces[std::min(i, faces.size() - 1)];
        const FaceCorners p = surfaces.corners(side, face);
        for (std::size_t k = 0; k < 3; ++k) detail::put(p[k], i, block.corner[k]);
        block.times[i] = i < faces.size() ? times : 0;
    }
}

inline void fill(const SurfacePair& surfaces, std::span<const Segment> segments, SegmentBlock& block) {
    block.count = static_cast<int>(segments.size());
    for (std::size_t i = 0; i < detail::padded(segments.size()); ++i) {
        const Segment& segment = segments[std::min(i, segments.size() - 1)];
        const std::array<FaceCorners, 2> face{surfaces.corners_a(segment), surfaces.corners_b(segment)};
        for (std::size_t e = 0; e < 2; ++e) {
            const SegmentEnd& end = e == 0 ? segment.start : segment.end;
            const FaceCorners &of = face[end.side], &crossed = face[1 - end.side];
            detail::put(of[end.edge], i, block.from[e]);
            detail::put(of[next_corner(end.edge)], i, block.to[e]);
            block.share[e][i] = end.vertex < 0 ? -1 : int{end.vertex} == int{end.edge} ? 0 : 1;
            for (std::size_t k = 0; k < 3; ++k) detail::put(crossed[k], i, block.face[e][k]);
            block.of_b[e][i] = end.side;
            block.jump[e][i] = end.edge == 1 ? end.jump : 0;
            detail::put(face[e][0], i, block.first[e]);
        }
        block.in_volume[i] = i < segments.size() && segment.in_volume ? 1 : 0;
        block.times[i] = i < segments.size() ? segment.times : 0;
    }
}

}  // namespace crumple
