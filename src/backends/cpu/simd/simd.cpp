// Kernels of the stages, one table for each instruction set, from one source: Highway includes this file once per
// target.

#include "backends/cpu/simd/tables.h"
#include "backends/cpu/stages/kernels.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/simd/simd.cpp"
#include "hwy/foreach_target.h"
// Must follow foreach_target.h.
#include "hwy/highway.h"

// Highway's one-lane targets lack the fixed-size vectors that these kernels use. Plain kernels take their place.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "backends/cpu/simd/assign-inl.h"
#include "backends/cpu/simd/balls-inl.h"
#include "backends/cpu/simd/boxes-inl.h"
#include "backends/cpu/simd/sweep-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

const StageKernels table{
    hwy::TargetName(HWY_TARGET), balls, repeats_corner, assign, list_members, quantise, split_boxes, sweep};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace {

using Kernels = StageKernels;
#include "backends/cpu/simd/tables-inl.h"

}  // namespace

const StageKernels& stage_kernels(Simd simd) { return choose<StageKernels>(tables, scalar_stages, simd); }

std::vector<const StageKernels*> all_stage_kernels() { return all_of<StageKernels>(tables, scalar_stages); }

}  // namespace crumple::cpu
#endif
