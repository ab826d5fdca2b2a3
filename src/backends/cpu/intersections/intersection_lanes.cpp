// Kernels of intersection queries, one table for each instruction set, from one source: Highway includes this file once
// per target. They replace the per-pair sources of filters/intersection/, with the same bounds, and are tested against
// them.

#include "backends/cpu/intersections/intersection_kernels.h"
#include "backends/cpu/simd/tables.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/intersections/intersection_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow foreach_target.h.
#include "hwy/highway.h"

// Highway's one-lane targets lack the fixed-size vectors that these kernels use. Plain kernels take their place.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "backends/cpu/intersections/build_triangles-inl.h"
#include "backends/cpu/intersections/classify-inl.h"
#include "backends/cpu/intersections/edge_test-inl.h"
#include "backends/cpu/intersections/flat_test-inl.h"
#include "backends/cpu/intersections/pairs-inl.h"
#include "backends/cpu/intersections/plane_filter-inl.h"
#include "backends/cpu/intersections/separating_plane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {

inline void filter(const Record* record, const CandidateChunk& candidates, const PointRows& points,
                   const NarrowPolicy& policy, float reach, Verdicts& verdicts) {
    verdicts.signs.resize(candidates.count);
    plane_filter(record, candidates, verdicts.signs);
    classify(candidates, policy, verdicts);
    flat_test(record, candidates, points, reach, verdicts);
    edge_test(record, candidates, reach, policy.proper, verdicts);
    separating_test_float(record, candidates, points, reach, verdicts);
    verdicts.double_tests = static_cast<std::int64_t>(verdicts.undecided.size());
    separating_test_double(record, candidates, points, verdicts);
}

const IntersectKernels table{hwy::TargetName(HWY_TARGET), blocks, build, scatter, filter, triangles_of_pairs};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace intersect {
namespace {

using Kernels = IntersectKernels;
#include "backends/cpu/simd/tables-inl.h"

}  // namespace
}  // namespace intersect

const IntersectKernels& intersect_kernels(Simd simd) {
    return choose<IntersectKernels>(intersect::tables, scalar_intersect, simd);
}

std::vector<const IntersectKernels*> all_intersect_kernels() {
    return all_of<IntersectKernels>(intersect::tables, scalar_intersect);
}

}  // namespace crumple::cpu
#endif
