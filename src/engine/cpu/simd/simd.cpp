// One table of kernels for each instruction set, from one source: Highway includes this file once a target.

#include "engine/cpu/simd/simd.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/cpu/simd/simd.cpp"
#include "hwy/foreach_target.h"
// foreach_target.h comes first.
#include "hwy/highway.h"

// One-lane vectors have no fixed tags: the plain kernels serve there.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "engine/cpu/simd/assign-inl.h"
#include "engine/cpu/simd/balls-inl.h"
#include "engine/cpu/simd/build-inl.h"
#include "engine/cpu/simd/classify-inl.h"
#include "engine/cpu/simd/edge_test-inl.h"
#include "engine/cpu/simd/flat_test-inl.h"
#include "engine/cpu/simd/pairs-inl.h"
#include "engine/cpu/simd/plane_filter-inl.h"
#include "engine/cpu/simd/separation-inl.h"
#include "engine/cpu/simd/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

inline void filter(const SortedLeaf& leaf, const Candidates& candidates, const PointRows& points,
                   const NarrowPolicy& policy, float reach, Verdicts& verdicts) {
    verdicts.signs.resize(candidates.count);
    plane_filter(leaf, candidates, verdicts.signs);
    classify(candidates, policy, verdicts);
    flat_test(leaf, candidates, points, reach, verdicts);
    edge_test(leaf, candidates, reach, policy.proper, verdicts);
    separation_test_float(leaf, candidates, points, reach, verdicts);
    verdicts.double_tests = static_cast<std::int64_t>(verdicts.undecided.size());
    separation_test_double(leaf, candidates, points, verdicts);
}

const Kernels table{hwy::TargetName(HWY_TARGET),
                    balls,
                    repeats_corner,
                    assign,
                    list_members,
                    build,
                    quantise,
                    split_boxes,
                    scatter,
                    sweep,
                    filter,
                    name_pairs};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {

namespace {

struct Entry {
    std::int64_t target;
    Simd simd;
    const Kernels* kernels;
};

// Best first. What Highway left out of the build for this architecture is left out here.
constexpr Entry entries[] = {
#if HWY_TARGETS & HWY_AVX3_DL
    {HWY_AVX3_DL, Simd::avx512, &N_AVX3_DL::table},
#endif
#if HWY_TARGETS & HWY_AVX3
    {HWY_AVX3, Simd::avx512, &N_AVX3::table},
#endif
#if HWY_TARGETS & HWY_AVX2
    {HWY_AVX2, Simd::avx2, &N_AVX2::table},
#endif
#if HWY_TARGETS & HWY_SSE4
    {HWY_SSE4, Simd::sse4, &N_SSE4::table},
#endif
#if HWY_TARGETS & HWY_NEON
    {HWY_NEON, Simd::neon, &N_NEON::table},
#endif
    {0, Simd::scalar, nullptr},
};

bool machine_has(const Entry& entry) { return (hwy::SupportedTargets() & entry.target) != 0; }

}  // namespace

const Kernels* simd_kernels(Simd simd) {
    for (const Entry& entry : entries)
        if (machine_has(entry) && (simd == Simd::automatic || simd == entry.simd)) return entry.kernels;
    return nullptr;
}

std::vector<const Kernels*> all_simd_kernels() {
    std::vector<const Kernels*> tables;
    for (const Entry& entry : entries)
        if (machine_has(entry)) tables.push_back(entry.kernels);
    return tables;
}

}  // namespace crumple::cpu
#endif
