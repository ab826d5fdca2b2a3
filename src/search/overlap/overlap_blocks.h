#pragma once

// Copies pairs of faces, faces and segments to blocks, the input of kernels (backends/overlap_kernels.h), and reads the
// signs that kernels return. Host only.

#include <algorithm>
#include <span>

#include "backends/overlap_kernels.h"
#include "crumple/intersections.h"
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

inline void fill(const SurfacePair& surfaces, std::span<const Pair> pairs, PairBlock& block) {
    block.count = static_cast<int>(pairs.size());
    for (std::size_t i = 0; i < detail::padded(pairs.size()); ++i) {
        const Pair& pair = pairs[std::min(i, pairs.size() - 1)];
        const FaceCorners a = surfaces.corners(0, pair.a), b = surfaces.corners(1, pair.b);
        for (std::size_t k = 0; k < 3; ++k) {
            detail::put(a[k], i, block.a[k]);
            detail::put(b[k], i, block.b[k]);
        }
    }
}

/// Signs of a decided pair of a block, for decide_crossings().
class DecidedSigns {
   public:
    DecidedSigns(const CrossingSigns& signs, std::size_t pair)
        : tied(signs.tied >> pair & 1), signs_(signs), pair_(pair) {}

    static constexpr bool has_inside_a = true, has_inside_b = true;
    bool tied;

    void set(Shift shift) {
        shift_ = shift == Shift::forward ? 0 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            a_[k] = sign(signs_.sides[shift_][0][k]);
            b_[k] = sign(signs_.sides[shift_][1][k]);
        }
    }
    int a_side(std::size_t i) const { return a_[i]; }
    int b_side(std::size_t i) const { return b_[i]; }
    int edges(std::size_t i, std::size_t j) const {
        return sign(signs_.edges[shift_][i == lone_corner(a_) ? 1 : 0][j == lone_corner(b_) ? 1 : 0]);
    }
    int vertex(std::size_t of_b, std::size_t edge) const {
        const auto in_plane = [&](std::size_t corner) { return is_set(signs_.zero[of_b][corner]); };
        if (!tied) return -1;
        if (in_plane(edge)) return static_cast<int>(edge);
        return in_plane(next_corner(edge)) ? static_cast<int>(next_corner(edge)) : -1;
    }
    bool in_plane_of_b(std::size_t i) const { return is_set(signs_.zero[0][i]); }

   private:
    bool is_set(std::uint64_t bits) const { return (bits >> pair_ & 1) != 0; }
    int sign(std::uint64_t bits) const { return is_set(bits) ? 1 : -1; }

    const CrossingSigns& signs_;
    std::size_t pair_, shift_ = 0;
    std::array<int, 3> a_{}, b_{};
};

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
