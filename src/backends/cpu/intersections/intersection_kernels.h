#pragma once

// The inner loops of this question on the cpu, as a table of functions beside those of the stages
// (backends/cpu/stages/kernels.h): plain C++ (intersection_kernels_scalar.cpp, from the per-pair sources that host and
// device share) and one table for each SIMD instruction set, which overrides it (intersection_lanes.cpp). All tables
// give the same pairs.

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

    /// Records (plane not yet scaled) and boxes of a leaf's members: both at once, since what they cost is to gather
    /// the corners.
    void (*build)(const BuildInput& input, Record* record, Boxes& boxes, LeafBounds& bounds);

    /// Copies record i to sorted[position[i]], its plane times `scale`.
    void (*scatter)(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted);

    /// Filters: sorts each candidate into hit, undecided or (silently) apart. `record`: by physical row.
    void (*filter)(const Record* record, const CandidateChunk& candidates, const PointRows& points,
                   const NarrowPolicy& policy, float reach, Verdicts& verdicts);

    /// The triangles of packed pairs (column << 16 | row), lower id first. Reads and writes up to `padding` more.
    void (*name_pairs)(const std::uint32_t* packed, std::size_t count, const RowLink* rows, const RowLink* columns,
                       Pair* out);
};

/// The table for an instruction set; throws backend_unavailable if the build or the machine lacks it.
const IntersectKernels& intersect_kernels(Simd simd);

/// Every table that build and machine have, the plain one first, in the order of all_stage_kernels(): for tests.
std::vector<const IntersectKernels*> all_intersect_kernels();

extern const IntersectKernels scalar_intersect;

}  // namespace crumple::cpu
