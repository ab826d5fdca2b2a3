// Kernels of queries about features, tables for each instruction set, from one source: Highway includes this file once
// per target. They replace the per-pair sources of filters/features/, with the same bounds, and are tested against
// them.

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/simd/tables.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/features/feature_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow foreach_target.h.
#include "hwy/highway.h"

// Highway's one-lane targets lack the fixed-size vectors that these kernels use. Plain kernels take their place.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "backends/cpu/features/build_features-inl.h"
#include "backends/cpu/features/filter_features-inl.h"
#include "backends/cpu/features/list_tests-inl.h"
#include "backends/cpu/features/separating_direction-inl.h"
#include "backends/cpu/features/squared_distances-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {

template <int moments>
FeatureKernels<moments> kernels() {
    const FeatureKernels<moments>& plain = scalar_features.of<moments>();
    return {build<moments>,
            plain.scatter,
            separate<moments>,
            list<moments>,
            {filter_list<FeatureKind::vertex_face, moments>, filter_list<FeatureKind::edge_edge, moments>},
            {filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::edge_edge, moments>,
             filter<FeatureKind::vertex_face, moments>, filter<FeatureKind::vertex_face, moments>}};
}
const FeatureTables table{kernels<1>(), kernels<2>(), near::HWY_NAMESPACE::squared};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace features {
namespace {

using Kernels = FeatureTables;
#include "backends/cpu/simd/tables-inl.h"

}  // namespace
}  // namespace features

const FeatureTables& feature_kernels(Simd simd) {
    return choose<FeatureTables>(features::tables, scalar_features, simd);
}

std::vector<const FeatureTables*> all_feature_kernels() {
    return all_of<FeatureTables>(features::tables, scalar_features);
}

}  // namespace crumple::cpu
#endif
