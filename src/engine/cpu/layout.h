#pragma once

// The arrays that the stages of the cpu backend hand on.
//
//   bounds      scene            -> Points (one a vertex), Balls (one a triangle)
//   subdivide   Balls            -> Memberships: leaves, each a list of triangles
//   align       one leaf         -> Record (questions/intersect/record.h) and box of each member, in the leaf's frame
//   sort        Records, Boxes   -> SortedLeaf: by start along the leaf's first axis, boxes in 16 bits
//   sweep       SortedLeaf       -> Candidates: pairs whose boxes overlap, four by four
//   narrow      Candidates       -> pairs
//
// Sorted members lie in blocks of `block_members`, each followed by one dummy that overlaps nothing, so that a column
// fits 16 bits: physical position of member j = j + j / block_members. Nearly every leaf has one block.

#include <array>
#include <cstdint>

#include "crumple/array.h"
#include "geometry/ball.h"
#include "geometry/point_rows.h"
#include "model/fuzzy_c_means.h"
#include "questions/intersect/edge_test.h"
#include "questions/intersect/record.h"

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

/// A box in 16 bits. Its extent across the sweep direction is what `sort` scatters at once, before it lies in columns.
struct alignas(8) RowBox {
    std::uint16_t low_y, high_y, low_z, high_z;
};
struct alignas(16) QuantisedBox {
    RowBox across;
    std::uint16_t unused[2];
    std::uint16_t low_x, high_x;
};

inline constexpr int block_stride = 65472;  ///< a multiple of the widest vector of 16-bit lanes
inline constexpr int block_members = block_stride - 1;

inline std::int64_t physical(std::int64_t member) { return member + member / block_members; }

/// Normalised vertices: float32 where that is exact, else float64. Rows of four, the last element 0.
struct Points {
    Array<float> f;
    Array<double> d;
    explicit Points(MemoryMeter* meter) : f(meter), d(meter) {}
};

/// What `align` leaves behind beside records and boxes.
struct LeafBounds {
    Vec3f low, high;  ///< of the boxes of all members that are not big
    float reach = 0;  ///< largest |coordinate| of their corners, relative to the origin
    int big = 0;      ///< number of big members
};

struct RowLink {
    std::int32_t end;       ///< first physical row whose start lies behind this row's end
    std::int32_t triangle;  ///< id in the scene
};

/// A leaf after `sort`. `rows` arrays have physical positions.
struct SortedLeaf {
    std::int64_t members = 0;
    std::int64_t rows = 0;  ///< physical length, dummies included
    Array<Record> record;
    Array<std::uint16_t> low_y, high_y, low_z, high_z;
    Array<std::uint16_t> lower;  ///< memberships in lower clusters, sides; pairs with a common bit are not ours
    Array<std::int32_t> begin;   ///< first row to test with; empty: the next one
    Array<RowLink> link;
    Array<std::int32_t> member;  ///< position in the subdivision's member arrays
    std::int64_t work = 0;       ///< sum of end - begin over rows: interval tests ([MZ] sec. 3.1)
    std::int64_t begin_of(std::int64_t row) const {
        return begin.empty() ? row + 1 : begin[static_cast<std::size_t>(row)];
    }
    explicit SortedLeaf(MemoryMeter* m)
        : record(m), low_y(m), high_y(m), low_z(m), high_z(m), lower(m), begin(m), link(m), member(m) {}
};

/// Candidate pairs: row[i] against column[i], as offsets from `rows` and `columns`. Four in a row, from a multiple of
/// four on, have the same row; gaps are filled with the block's dummy. `count` is a multiple of 16.
struct Candidates {
    std::int64_t rows = 0, columns = 0;  ///< physical position of row 0 and column 0
    std::int64_t count = 0;
    std::int64_t pairs = 0;   ///< without padding
    std::uint16_t dummy = 0;  ///< the padding column
    Array<std::uint16_t> row, column;
    explicit Candidates(MemoryMeter* m) : row(m), column(m) {}
};

/// Where the corners of candidates lie: one nibble a pair, its three low bits one a corner; the fourth means nothing.
struct PlaneSigns {
    Array<std::uint8_t> above_a, below_a;  ///< the column's corners against the row's plane, where certain
    Array<std::uint8_t> above_b, below_b;  ///< the row's corners against the column's plane
    Array<std::uint8_t> same[3];           ///< the column's corners that are the row's corner 0, 1, 2
    explicit PlaneSigns(MemoryMeter* m)
        : above_a(m),
          below_a(m),
          above_b(m),
          below_b(m),
          same{Array<std::uint8_t>(m), Array<std::uint8_t>(m), Array<std::uint8_t>(m)} {}
    void resize(std::int64_t candidates) {
        for (auto* stream : {&above_a, &below_a, &above_b, &below_b, &same[0], &same[1], &same[2]})
            stream->resize_discard(static_cast<std::size_t>(candidates / 2 + padding));
    }
};

/// What the filters of `narrow` say, and what they hand to each other. Pairs are packed as column << 16 | row.
struct Verdicts {
    Array<std::uint32_t> hit;        ///< collide for certain
    Array<std::uint32_t> undecided;  ///< for exact arithmetic
    std::int64_t edge_tests = 0;     ///< pairs that no plane separated
    std::int64_t double_tests = 0;   ///< pairs that float32 filters left open
    // Between the SIMD filters:
    PlaneSigns signs;
    Array<std::uint8_t> code;                      ///< what `classify` makes of each candidate
    Array<std::uint32_t> survivor, survivor_code;  ///< those that no plane separates
    Array<std::uint32_t> edges, edge_signs;        ///< pairs for edge_test; below_a | below_b << 3
    Array<std::uint32_t> flat, flat_shared;        ///< pairs for flat_test; shared_b | shared_a << 3
    explicit Verdicts(MemoryMeter* m)
        : hit(m),
          undecided(m),
          signs(m),
          code(m),
          survivor(m),
          survivor_code(m),
          edges(m),
          edge_signs(m),
          flat(m),
          flat_shared(m) {}
    void make_room(std::int64_t candidates) {
        const auto n = static_cast<std::size_t>(candidates + 2 * padding);
        signs.resize(candidates);
        code.reserve(n);
        for (auto* list : {&hit, &undecided, &survivor, &survivor_code, &edges, &edge_signs, &flat, &flat_shared})
            list->reserve(n);
    }
};

/// Corner orders for the edge test, by below_a | below_b << 3.
inline constexpr std::array<std::int32_t, 64> edge_orders = [] {
    std::array<std::int32_t, 64> orders{};
    for (int bits = 0; bits < 64; ++bits) orders[static_cast<std::size_t>(bits)] = edge_order(bits & 7, bits >> 3);
    return orders;
}();

}  // namespace crumple::cpu
