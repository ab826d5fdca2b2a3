// The inner loop of candidates, a table for each instruction set, from one source: Highway includes this file once a
// target. A feature of the row is held against all eight lanes of the column at once: the largest of the six gaps.

#include "engine/cpu/simd/tables.h"
#include "questions/candidates/cpu/kernels.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "questions/candidates/cpu/lanes.cpp"
#include "hwy/foreach_target.h"
// foreach_target.h comes first.
#include "hwy/highway.h"

// One-lane vectors have no fixed tags: the plain kernel serves there.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::candidates {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// As many of the eight lanes as a register has.
using D = hn::CappedTag<float, candidate_lanes>;

// Lanes from `first` on: the largest gap on any axis between them and lane f of `a`.
HWY_INLINE hn::Vec<D> gap(const CandidateRecord& a, int f, const CandidateRecord& b, std::size_t first) {
    const D d;
    const auto on_axis = [&](int axis) HWY_ATTR {
        const auto after = hn::Sub(hn::Load(d, b.low[axis] + first), hn::Set(d, a.high[axis][f]));
        const auto before = hn::Sub(hn::Set(d, a.low[axis][f]), hn::Load(d, b.high[axis] + first));
        return hn::Max(after, before);
    };
    return hn::Max(on_axis(0), hn::Max(on_axis(1), on_axis(2)));
}

template <class Mask>
HWY_INLINE unsigned bits_of(const Mask& mask, std::size_t first) {
    const D d;
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, mask, bytes);
    return unsigned{bytes[0]} << first;
}

HWY_INLINE bool share_a_vertex(const CandidateRecord& a, const CandidateRecord& b) {
    const hn::FixedTag<std::int32_t, 4> d;
    const auto names = hn::LoadU(d, b.name);
    const auto same = [&](int k) HWY_ATTR { return hn::Eq(names, hn::Set(d, a.name[k])); };
    return !hn::AllFalse(d, hn::Or(same(0), hn::Or(same(1), same(2))));
}

std::size_t overlaps(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin, std::int64_t end,
                     const AskedLanes& asked, BoxHit* hit) {
    const D d;
    const auto zero = hn::Zero(d);
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    const unsigned rows_asked = asked_rows(asked);
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        const bool neighbours = share_a_vertex(a, b);
        for (unsigned lanes = a.owned & rows_asked; lanes; lanes &= lanes - 1) {
            const int f = std::countr_zero(lanes);
            unsigned overlap = 0, unsure = 0;
            for (std::size_t first = 0; first < candidate_lanes; first += hn::Lanes(d)) {
                const auto between = gap(a, f, b, first);
                overlap |= bits_of(hn::Le(between, zero), first);
                unsure |= bits_of(hn::Eq(between, zero), first);
            }
            overlap &= asked[f];
            if (neighbours) overlap &= ~incident_lanes(a, f, b);
            hit[count] = {i, j, static_cast<std::uint8_t>(f), static_cast<std::uint8_t>(overlap),
                          static_cast<std::uint8_t>(unsure & overlap)};
            count += overlap != 0;
        }
    }
    return count;
}

const CandidateKernels table{overlaps};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::candidates
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace candidates {
namespace {

using Kernels = CandidateKernels;
#include "engine/cpu/simd/tables-inl.h"

}  // namespace
}  // namespace candidates

const CandidateKernels& candidate_kernels(Simd simd) {
    return choose<CandidateKernels>(candidates::tables, scalar_candidates, simd);
}

std::vector<const CandidateKernels*> all_candidate_kernels() {
    return all_of<CandidateKernels>(candidates::tables, scalar_candidates);
}

}  // namespace crumple::cpu
#endif
