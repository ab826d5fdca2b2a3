#pragma once

// The inner loops of the stages that every question shares, as a table of functions: plain C++ (kernels_scalar.cpp,
// which also documents what each computes) and one table for each SIMD instruction set, from one source (simd/, by
// Highway). All tables give the same overlaps; approximate results may differ in the last bit. A question's own loops
// are a table of its own (backends/cpu/intersections/intersection_kernels.h).

#include <cstdint>
#include <vector>

#include "backends/cpu/stages/layout.h"
#include "crumple/options.h"

namespace crumple::cpu {

/// Axis by axis; the fourth element is 0.
struct Quantisation {
    float base_low[4], base_high[4], scale[4];
};

struct StageKernels {
    const char* name;

    /// ball[t] holds triangle t, for t in [begin, end), and rubbish up to the next multiple of four past `end`; `begin`
    /// is a multiple of four. `corners`: 3 a triangle. It holds what is at most `more` away as well, and, where `ends`
    /// is not 0, as in BuildInput, the triangle's whole way.
    void (*balls)(const PointRows& points, const std::int32_t* corners, std::int64_t begin, std::int64_t end,
                  std::int64_t ends, float more, Ball* ball);

    /// Whether a triangle of [begin, end) names a vertex twice.
    bool (*repeats_corner)(const std::int32_t* corners, std::int64_t begin, std::int64_t end);

    /// Bit k of mask[i]: ball i may hold a point that is nearest to centre k (docs/subdivide.md). Adds the number of
    /// such balls to count[k].
    void (*assign)(const Ball* ball, std::int64_t n, const Centres& centres, std::uint64_t* mask, std::int64_t* count);

    /// Lists the positions in [begin, end) whose `mask` has bit `child`; returns their number. Writes up to
    /// `padding` more.
    std::int64_t (*list_members)(const std::uint64_t* mask, std::int64_t begin, std::int64_t end, int child,
                                 std::int32_t* member);

    /// Boxes to 16 bits by (x - base) * scale, rounded down and clamped to [0, 65534]; monotone, so overlaps survive.
    void (*quantise)(const Boxes& boxes, std::int64_t n, const Quantisation& by, QuantisedBox* out);

    /// Writes the four columns of the sorted boxes of `rows` rows, and of half of the padding.
    void (*split_boxes)(const RowBox* box, std::int64_t rows, SortedLeaf& sorted);

    /// Appends to `out` the candidates of rows [row, last) with columns in [columns, block_end), until at least
    /// `capacity` columns are there; returns the row to go on with. `dummy` is the block's padding column.
    std::int64_t (*sweep)(const SortedLeaf& leaf, std::int64_t row, std::int64_t last, std::int64_t block_end,
                          std::uint16_t dummy, std::int64_t capacity, CandidateChunk& out);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const StageKernels& stage_kernels(Simd simd);

/// Every table that build and machine have, the plain one first: for tests.
std::vector<const StageKernels*> all_stage_kernels();

extern const StageKernels scalar_stages;

}  // namespace crumple::cpu
