#pragma once

// Arrays that the stages of the cpu backend pass on.
//
//   bounds      scene            -> Points (1 per vertex), Balls (1 per triangle)
//   subdivide   Balls            -> Subdivision: leaves, each a list of triangles
//   align       one leaf         -> LeafFrame; the query's `build` computes Boxes in it, along with its own records
//   sort        Boxes            -> SortedLeaf: by start along the leaf's first axis, boxes in 16 bits; and the row of
//                                   each member, for the query's records
//   sweep       SortedLeaf       -> CandidateChunk: pairs whose boxes overlap, grouped by row
//   narrow      CandidateChunk   -> rows of a result, by kind of query
//
// A leaf is a small set of triangles, its members, that one sweep searches. After `sort`, each member has a row. If the
// scene is two meshes, the rows of the first mesh come first, and each mesh is sorted by itself. The sweep tests each
// row with other rows, its columns, and a candidate is a pair of a row and a column. Rows are stored in blocks of
// `block_members` members, each followed by one dummy that overlaps nothing, so that the offset of a column from its
// block fits 16 bits. The physical position (row) of the j-th sorted member is j + j / block_members. Nearly every leaf
// has one block.

#include <cstdint>
#include <limits>

#include "crumple/array.h"
#include "geometry/ball.h"
#include "geometry/inflation.h"
#include "geometry/leaf_frame.h"
#include "geometry/point_rows.h"
#include "partition/fuzzy_c_means.h"

namespace crumple::cpu {

inline constexpr int padding = 64;  ///< elements that kernels may read, and write, past an array's end

/// A corner of a box, in the leaf's frame.
struct alignas(16) BoxCorner {
    float x, y, z, unused;
};

/// Boxes of a leaf's members.
struct Boxes {
    Array<BoxCorner> low, high;
    explicit Boxes(MemoryMeter* m) : low(m), high(m) {}
    void resize(std::size_t n) {
        low.resize_discard(n + padding);
        high.resize_discard(n + padding);
    }
};

/// Extent of a box in 16 bits (QuantisedBox) across the sweep direction. `sort` scatters it as a whole, before
/// splitting it into columns.
struct alignas(8) RowBox {
    std::uint16_t low_y, high_y, low_z, high_z;
};
struct alignas(16) QuantisedBox {
    RowBox across;
    std::uint16_t unused[2];
    std::uint16_t low_x, high_x;
};

/// Rows per block; a multiple of the number of 16-bit lanes in the widest vector.
inline constexpr int block_stride = 65472;
inline constexpr int block_members = block_stride - 1;

inline std::int64_t physical(std::int64_t member) { return member + member / block_members; }

/// Normalised vertices: float32 if that is exact, else float64. If they move, all end positions follow all start
/// positions. Rows of four, the last element 0.
struct Points {
    Array<float> f;
    Array<double> d;
    explicit Points(MemoryMeter* meter) : f(meter), d(meter) {}
};

/// Input of a query's `build`.
struct BuildInput {
    PointRows points;
    const std::int32_t* corners;   ///< 3 per triangle
    std::int64_t triangles;        ///< number of triangles in the scene
    const std::int32_t* triangle;  ///< ids of the leaf's members; the last one is repeated `padding` times
    std::int64_t members;
    LeafFrame frame;
    std::int64_t ends = 0;  ///< rows from a vertex's start position to its end position in `points`; 0: static
    Inflation inflation = {};
    /// Mean displacement of the members during the step. For queries about motion, the origin of the leaf's frame moves
    /// by it, which shortens trajectories.
    Vec3f drift = {};
    /// End of the part of the step, which starts at 0, that boxes and records cover; 1: the whole step.
    float until = 1;
};

/// Bounds that `build` computes along with boxes and records. Without members: a box with low > high.
struct LeafBounds {
    static constexpr float most = std::numeric_limits<float>::max();
    Vec3f low{most, most, most}, high{-most, -most, -most};  ///< box of all members that are not big
    float reach = 0;  ///< largest |coordinate| of corners relative to the origin; times big_share for big members
    int big = 0;      ///< number of big members
};

struct RowLink {
    std::int32_t end;       ///< physical end of the row's columns: members from there on start behind its interval
    std::int32_t triangle;  ///< id in the scene
};

/// Leaf after `sort`. Arrays over rows are indexed by physical position.
struct SortedLeaf {
    std::int64_t members = 0;
    std::int64_t rows = 0;         ///< number of physical rows: members and one dummy per block
    Array<std::int32_t> position;  ///< physical position of each member, in the order of LeafMembers
    Array<std::uint16_t> low_y, high_y, low_z, high_z;  ///< boxes across the sweep direction
    /// Ownership bits (ownership.h): the leaf does not own a pair of members with a common bit.
    Array<std::uint16_t> lower;
    /// Two meshes: physical position of each row's first column. One mesh: empty, as the first column is the next row.
    Array<std::int32_t> begin;
    Array<RowLink> link;
    /// Position of each row's member in the arrays of Subdivision (subdivide.h), if LeafMembers::keep_members.
    Array<std::int32_t> member;
    std::int64_t work = 0;  ///< number of interval tests: sum of the rows' numbers of columns
    std::int64_t begin_of(std::int64_t row) const {
        return begin.empty() ? row + 1 : begin[static_cast<std::size_t>(row)];
    }
    explicit SortedLeaf(MemoryMeter* m)
        : position(m), low_y(m), high_y(m), low_z(m), high_z(m), lower(m), begin(m), link(m), member(m) {}
};

/// Calls visit(row) for each row that holds no member: the blocks' dummies, and the padding.
template <class Visit>
void for_each_dummy(const SortedLeaf& leaf, Visit visit) {
    for (std::int64_t row = block_members; row < leaf.rows - 1; row += block_stride) visit(row);
    for (std::int64_t row = leaf.rows - 1; row < leaf.rows + padding; ++row) visit(row);
}

/// Candidate pairs: row[i] against column[i], as offsets from `rows` and `columns`. Aligned groups of `group` entries
/// have the same row; the block's dummy fills the gaps. `count` is a multiple of 16.
struct CandidateChunk {
    int group = 4;                       ///< 1, 2 or 4: number of candidates of one row that `narrow` loads at a time
    std::int64_t rows = 0, columns = 0;  ///< physical position of row 0 and column 0
    std::int64_t count = 0;
    std::int64_t pairs = 0;   ///< number of pairs without padding
    std::uint16_t dummy = 0;  ///< the padding column
    Array<std::uint16_t> row, column;
    explicit CandidateChunk(MemoryMeter* m) : row(m), column(m) {}
};

}  // namespace crumple::cpu
