#pragma once

// Inner loops of intersection queries on the cpu, as tables of functions like those of the stages
// (backends/cpu/stages/kernels.h): one in plain C++ (intersection_kernels_scalar.cpp, from the per-pair sources that
// host and device share), and one for each SIMD instruction set (intersection_lanes.cpp). All tables yield the same
// pairs. A leaf is a small set of triangles that one sweep searches. Its candidates are the pairs of triangles, a row
// and a column of the sweep, whose boxes overlap (stages/layout.h).

#include <cstdint>
#include <vector>

#include "backends/cpu/intersections/verdicts.h"
#include "backends/cpu/stages/layout.h"
#include "crumple/intersections.h"
#include "crumple/options.h"
#include "filters/intersection/plane_filter.h"

namespace crumple::cpu {

struct IntersectKernels {
    const char* name;
    int group;  ///< number of candidates of one row that `filter` loads at a time (CandidateChunk::group)

    /// Computes records (planes not yet scaled) and boxes of a leaf's members, both at once because gathering the
    /// corners is the main cost.
    void (*build)(const BuildInput& input, Record* record, Boxes& boxes, LeafBounds& bounds);

    /// Copies record i to sorted[position[i]], its plane times `scale`.
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted);

    /// Filters candidates: lists each as hit or undecided, or drops it as apart. `record`: the leaf's, by physical row.
    /// `reach`: the leaf's largest |coordinate|.
    void (*filter)(const Record* record, const CandidateChunk& candidates, const PointRows& points,
                   const NarrowPolicy& policy, float reach, Verdicts& verdicts);

    /// Writes the triangles of packed pairs (column << 16 | row), lower id first. Reads and writes up to `padding`
    /// pairs more.
    void (*triangles_of_pairs)(const std::uint32_t* packed, std::size_t count, const RowLink* rows,
                               const RowLink* columns, Pair* out);
};

/// Returns the table of an instruction set. Throws Error (backend_unavailable) if the build or the machine lacks it.
const IntersectKernels& intersect_kernels(Simd simd);

/// Returns all tables that both the build and the machine support, the plain one first, in the order of
/// all_stage_kernels(). For tests.
std::vector<const IntersectKernels*> all_intersect_kernels();

extern const IntersectKernels scalar_intersect;

}  // namespace crumple::cpu
