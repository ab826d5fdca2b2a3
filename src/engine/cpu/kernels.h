#pragma once

// The inner loops of the cpu backend, as a table of functions: plain C++ (kernels_scalar.cpp, which also documents what
// each computes) and one table for each SIMD instruction set, from one source (simd/, by Highway). All tables give the
// same pairs; approximate results may differ in the last bit.

#include <cstdint>

#include "crumple/collisions.h"
#include "crumple/options.h"
#include "engine/cpu/layout.h"
#include "questions/intersect/plane_filter.h"

namespace crumple::cpu {

struct RecordInput {
    PointRows points;
    const std::int32_t* corners;   ///< 3 a triangle
    std::int64_t triangles;        ///< of the scene
    const std::int32_t* triangle;  ///< the leaf's members; the last one is repeated `padding` times
    std::int64_t members;
    LeafFrame frame;
};

/// Axis by axis; the fourth element is 0.
struct Quantisation {
    float base_low[4], base_high[4], scale[4];
};

struct Kernels {
    const char* name;

    /// ball[t] holds triangle t, for t in [begin, end), and rubbish up to the next multiple of four past `end`; `begin`
    /// is a multiple of four. `corners`: 3 a triangle.
    void (*balls)(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  Ball* ball);

    /// Whether a triangle of [begin, end) names a vertex twice.
    bool (*repeats_corner)(const std::int32_t* corners, std::int64_t begin, std::int64_t end);

    /// Bit k of mask[i]: ball i may hold a point that is nearest to centre k (docs/subdivide.md). Adds the number of
    /// such balls to count[k].
    void (*assign)(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count);

    /// Lists the positions in [begin, end) whose `mask` has bit `child`; returns their number. Writes up to
    /// `padding` more.
    std::int64_t (*list_members)(const std::uint64_t* mask, std::int64_t begin, std::int64_t end, int child,
                                 std::int32_t* member);

    /// Records (plane not yet scaled) and boxes of a leaf's members.
    void (*build)(const RecordInput& input, Record* record, Boxes& boxes, LeafBounds& bounds);

    /// Boxes to 16 bits by (x - base) * scale, rounded down and clamped to [0, 65534]; monotone, so overlaps survive.
    void (*quantise)(const Boxes& boxes, std::int64_t n, const Quantisation& by, QuantisedBox* out);

    /// Writes the four columns of the sorted boxes of `rows` rows, and of half of the padding.
    void (*split_boxes)(const RowBox* box, std::int64_t rows, SortedLeaf& sorted);

    /// Copies record i to sorted[position[i]], its plane times `scale`.
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted);

    /// Appends to `out` the candidates of rows [row, last) with columns in [columns, block_end), until at least
    /// `capacity` columns are there; returns the row to go on with. `dummy` is the block's padding column.
    std::int64_t (*sweep)(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                          std::uint16_t dummy, std::int64_t capacity, Candidates& out);

    /// Filters: sorts each candidate into hit, undecided or (silently) apart.
    void (*filter)(const SortedLeaf& leaf, const Candidates& candidates, const PointRows& points,
                   const NarrowPolicy& policy, float reach, Verdicts& verdicts);

    /// The triangles of packed pairs (column << 16 | row), lower id first. Reads and writes up to `padding` more.
    void (*name_pairs)(const std::uint32_t* packed, std::size_t count, const RowLink* rows, const RowLink* columns,
                       Pair* out);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const Kernels& kernels_for(Simd simd);

extern const Kernels scalar_kernels;

}  // namespace crumple::cpu
