#pragma once

// Inner loops of the stages that all kinds of query share, as tables of functions: one in plain C++
// (kernels_scalar.cpp, the version to read first), and one for each SIMD instruction set, from one source (simd/, by
// Highway). Results of queries do not depend on the table; approximate intermediate results may differ in the last bit.
// Each kind of query has tables of its own loops (such as intersections/intersection_kernels.h).

#include <cstdint>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "crumple/options.h"

namespace crumple::cpu {

/// Parameters of `quantise`, by axis: `base_low` is subtracted from the low ends of boxes, `base_high` from the high
/// ends, before multiplication by `scale`. The fourth element is 0.
struct Quantisation {
    float base_low[4], base_high[4], scale[4];
};

struct StageKernels {
    const char* name;

    /// Computes ball[t] for t in [begin, end), where `begin` is a multiple of four; entries from `end` to the next
    /// multiple of four become garbage. The ball contains all points within `more` of triangle t or, if `ends` is not 0
    /// (see BuildInput), of its swept volume. `corners`: 3 per triangle.
    void (*balls)(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  std::int64_t ends, float more, Ball* ball);

    /// Returns true if a triangle of [begin, end) has a repeated vertex.
    bool (*repeats_corner)(const std::int32_t* corners, std::int64_t begin, std::int64_t end);

    /// Sets mask[i]: bit k is 1 if ball i may contain a point whose nearest centre is k (docs/subdivide.md), else 0.
    /// Adds to count[k] the number of balls whose bit k is 1.
    void (*assign)(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count);

    /// Lists in `member` the positions in [begin, end) whose `mask` has bit `child`; returns their number. May write up
    /// to `padding` entries past these.
    std::int64_t (*list_members)(const std::uint64_t* mask, std::int64_t begin, std::int64_t end, int child,
                                 std::int32_t* member);

    /// Converts boxes to 16 bits: (x - base) * scale, rounded down and clamped to [0, 65534]. This is monotone, so
    /// overlaps survive.
    void (*quantise)(const Boxes& boxes, std::int64_t n, const Quantisation& by, QuantisedBox* out);

    /// Splits the sorted boxes of `rows` rows, and of half of the padding, into the columns low_y, high_y, low_z and
    /// high_z of `sorted`.
    void (*split_boxes)(const RowBox* box, std::int64_t rows, SortedLeaf& sorted);

    /// Appends to `out` the candidates of rows [row, last) with columns in [out.columns, block_end), until `out` has at
    /// least `capacity` entries; returns the row to continue with. `dummy` is the block's padding column (layout.h).
    std::int64_t (*sweep)(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                          std::uint16_t dummy, std::int64_t capacity, CandidateChunk& out);
};

/// Returns the table of an instruction set. Throws Error (backend_unavailable) if the build or the machine lacks it.
const StageKernels& stage_kernels(Simd simd);

/// Returns all tables that both the build and the machine support, the plain one first. For tests.
std::vector<const StageKernels*> all_stage_kernels();

extern const StageKernels scalar_stages;

}  // namespace crumple::cpu
