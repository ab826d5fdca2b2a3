#pragma once

// Stars of a leaf (small set of triangles, its members, that one sweep searches). The star of a vertex is all members
// that contain the vertex. Boxes of a star's members all overlap, so a vertex of d needles (long thin triangles) makes
// d (d - 1) / 2 candidates. This class proves that nearly all of these pairs are apart, in the time to sort d numbers.
//
// Seen from the vertex v, in a projection, a triangle (v, p, q) covers an arc: the directions from v between p and q.
// If the arcs of two triangles are disjoint, the triangles have only v in common, and do not collide (docs/narrow.md).
// So the members of a large star get a common ownership bit (stages/ownership.h), by which the sweep lists no pair
// within the star, and pairs whose arcs overlap are listed here. They go to `narrow` as further candidates.

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/leaf_members.h"

namespace crumple::cpu {

class VertexStars {
   public:
    explicit VertexStars(MemoryMeter* m) : triangles_(m), arcs_(m), pairs_(m), candidates_(m) {}

    /// Finds large stars, sets ownership bits in members.lower that the leaf does not use otherwise, and lists the
    /// pairs whose arcs overlap. Without an unused bit, no star is found.
    void find(const BuildInput& input, LeafMembers& members);

    /// Completes `sort`: converts the listed pairs of members to pairs of rows.
    void sort(const SortedLeaf& leaf);

    /// Returns the position of the first listed pair with a row of at least `row`.
    std::size_t first_pair(std::int64_t row) const;

    /// Fills `chunk` with the pairs from position `next` on whose rows are below `last`, up to about chunk_columns of
    /// them. Moves `next` behind them. Returns false if there are none.
    bool list(const SortedLeaf& leaf, std::int64_t last, std::size_t& next, CandidateChunk& chunk) const;

   private:
    /// Member (v, p, q) of the star of v.
    struct StarTriangle {
        std::int32_t member, p, q;
    };
    /// Closed interval of pseudo-angles that contains a member's arc.
    struct Arc {
        double low, high;
        std::int32_t member;
    };
    struct MemberPair {
        std::int32_t a, b;
    };
    class Projection;

    bool add(const BuildInput& input, std::int32_t vertex, std::uint16_t bit, LeafMembers& members);
    void gather(const BuildInput& input, std::int32_t vertex);
    void make_arcs(const Projection& projection);
    template <class Visit>
    bool for_each_overlap(Visit visit) const;

    Array<StarTriangle> triangles_;
    Array<Arc> arcs_;
    Array<MemberPair> pairs_;
    Array<std::uint32_t> candidates_;  ///< row << 16 | column, ascending
};

}  // namespace crumple::cpu
