#pragma once

// Crossings of the edges of one surface with the faces of another, sorted along each edge, for the regions of an
// overlap (overlap_regions.h). Each end of a segment is at one of them, and several segments may end at the same one.
// The order along an edge is exact: parameters are compared in float64, then in double words, then in rational
// arithmetic. Host only.

#include <array>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "exact/overlap/rounded_parameter.h"
#include "exact/overlap/shifted_point.h"
#include "results/overlap_regions.h"
#include "scene/placement.h"

namespace crumple {

/// End of a segment, where the edge between vertices `low` and `high` of surface `side` crosses face `crossed`.
struct EdgeEnd {
    std::size_t side;
    std::int32_t low, high, crossed, segment;
    int jump;           ///< change of the winding number from `low` to `high`
    std::int32_t face;  ///< a face with that edge, and which of its edges it is
    std::uint8_t edge;
    bool upward;  ///< true if that face traverses the edge from `low` to `high`
    /// Where on the edge, from `low` to `high`; its error is infinite if that is not known in float64.
    RoundedParameter parameter = {};

    auto edge_key() const { return std::tie(side, low, high); }
    /// Keys in the order of (side, low, high) and of (crossed, segment).
    std::array<std::uint64_t, 2> keys() const {
        const auto bits = [](std::int32_t x) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)); };
        return {std::uint64_t{side} << 62 | bits(low) << 31 | bits(high), bits(crossed) << 32 | bits(segment)};
    }
};

class EdgeCrossings {
   public:
    /// The input must outlive the object. Cost: O(n log n) for n segments.
    EdgeCrossings(const RegionInput& input, Cancellation& cancellation);

    /// Returns the ends of all segments, sorted by edge, and along each edge from its lower to its higher vertex.
    std::span<const EdgeEnd> ends() const { return ends_; }
    /// Returns one end for each crossing of an edge, from `from` to `to`.
    std::vector<const EdgeEnd*> on_edge(std::size_t side, std::int32_t from, std::int32_t to) const;
    /// Returns the position in ends() behind the ends on the edge of ends()[begin].
    std::size_t end_of_edge(std::size_t begin) const;
    /// True if edge k of a face is crossed.
    bool is_crossed(std::size_t side, std::int32_t face, std::size_t k) const {
        return crossed_[side][static_cast<std::size_t>(face)] >> k & 1;
    }
    /// Returns a box that contains both ends of a segment.
    const Bounds& box(std::int32_t segment) const { return box_[static_cast<std::size_t>(segment)]; }

    CrossedEdge crossed_edge(const EdgeEnd& end) const;
    CrossedEdge crossed_edge(const Segment& segment, const SegmentEnd& end) const;

   private:
    EdgeEnd edge_end(std::size_t segment, bool start) const;
    void list_ends();
    void locate(std::size_t begin, std::size_t end);
    Bounds box_at(const CrossedEdge& edge, const RoundedParameter& parameter) const;
    void sort_along_edge(std::size_t begin, std::size_t end);

    const RegionInput& in_;
    Cancellation& cancellation_;
    std::vector<EdgeEnd> ends_;
    std::vector<Bounds> box_;                           ///< by segment
    std::array<std::vector<std::uint8_t>, 2> crossed_;  ///< by surface and face: bit k is set if its edge k is crossed
};

}  // namespace crumple
