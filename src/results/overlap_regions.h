#pragma once

// Regions of an overlap: connected pieces of its boundary. The boundary consists of the parts of each surface on which
// the winding number of the other one is not 0; where the surfaces cross, these parts meet. Host only.
//
// All numbers of a region are sums over its segments and its vertices (docs/overlap.md). So a region is a set of both:
//
//   segments that end at the same crossing of an edge and a face
//   neighbours along an edge (crossings of it, and its two vertices) with a winding number other than 0 between them
//   segments that are closed within a face, and what surrounds them there
//
// belong to the same region. If two sheets of one surface cross on a face of the other, their segments are joined, too,
// and the region is marked as merged, because sides of segments are not defined there.
//
// A piece is a connected part of one surface. Pieces are found by the same joins, applied to each surface alone: so
// each segment stands for two elements, one on either surface. Then joining both elements of every segment makes the
// regions.

#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "base/cancellation.h"
#include "results/joined_curves.h"
#include "results/overlap_output.h"

namespace crumple {

struct RegionInput {
    std::span<const Segment> segments;  ///< all of the same shift, and links from index `links` on (joined_curves.h)
    std::size_t links = 0;
    FaceReader face;
    std::array<const std::int32_t*, 2> corners{};  ///< by surface: three vertices per face, as from `face`
    /// By surface: the vertices at which the winding number of the other one is not 0, in any order.
    std::array<std::span<const VertexWinding>, 2> inside{};
    /// By surface: faces, at least all that have such a vertex and that nothing crosses.
    std::array<std::span<const std::int32_t>, 2> faces{};
    std::array<std::size_t, 2> vertex_count{}, face_count{};
    bool in_range = true;  ///< true if all points are in the range of double-double arithmetic
};

struct RegionParts {
    std::vector<std::int32_t> segments;                ///< ascending, without links
    std::array<std::vector<VertexWinding>, 2> inside;  ///< in the order of the input
    bool merged = false;
    std::array<std::int32_t, 2> pieces{};  ///< by surface: number of its connected pieces

    /// Key by which regions are sorted: their lowest segments, then their lowest vertices.
    std::tuple<std::int32_t, std::size_t, std::int32_t> key() const;
};

/// Returns the regions in the order of their lowest segments; those without segments are last, in the order of their
/// lowest vertices. Cost: O(n log n) for the segments, O(n) for faces and vertices; and more for a face with n
/// segments: O(n²) if all of their boxes overlap, and for each loop the number of segments that are as high as its ray.
std::vector<RegionParts> find_regions(const RegionInput& input, Cancellation& cancellation);

}  // namespace crumple
