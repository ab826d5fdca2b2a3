// The inner loop of candidates, a table for each instruction set, from one source: Highway includes this file once a
// target. Eight features of the row are held against the eight lanes of the column at once: the largest of six gaps.

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
HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::candidates {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// As many of the eight lanes as a register has.
using D = hn::CappedTag<float, candidate_lanes>;

// The boxes of a row as its rounds want them.
struct RowOfRounds {
    alignas(64) float low[Rounds::most][3][candidate_lanes], high[Rounds::most][3][candidate_lanes];

    void read(const CandidateRecord& a, const Rounds& rounds) {
        for (int j = 0; j < rounds.count; ++j)
            for (int axis = 0; axis < 3; ++axis)
                for (int l = 0; l < candidate_lanes; ++l) {
                    low[j][axis][l] = a.low[axis][rounds.row[j][l]];
                    high[j][axis][l] = a.high[axis][rounds.row[j][l]];
                }
    }
};

// Lanes from `first` on: the largest gap on any axis in round j.
HWY_INLINE hn::Vec<D> gap(const RowOfRounds& a, int j, const CandidateRecord& b, std::size_t first) {
    const D d;
    const auto on_axis = [&](int axis) HWY_ATTR {
        const auto after = hn::Sub(hn::Load(d, b.low[axis] + first), hn::Load(d, a.high[j][axis] + first));
        const auto before = hn::Sub(hn::Load(d, a.low[j][axis] + first), hn::Load(d, b.high[axis] + first));
        return hn::Max(after, before);
    };
    return hn::Max(on_axis(0), hn::Max(on_axis(1), on_axis(2)));
}

template <class Mask>
HWY_INLINE std::uint64_t bits_of(const Mask& mask) {
    const D d;
    std::uint8_t bytes[8];
    hn::StoreMaskBits(d, mask, bytes);
    return bytes[0];
}

HWY_INLINE bool share_a_vertex(const CandidateRecord& a, const CandidateRecord& b) {
    const hn::FixedTag<std::int32_t, 4> d;
    const auto names = hn::LoadU(d, b.name);
    const auto same = [&](int k) HWY_ATTR { return hn::Eq(names, hn::Set(d, a.name[k])); };
    return !hn::AllFalse(d, hn::Or(same(0), hn::Or(same(1), same(2))));
}

std::size_t overlaps(const CandidateRecord* record, const Candidates& candidates, std::int64_t begin, std::int64_t end,
                     const Rounds& rounds, BoxHit* hit) {
    const D d;
    const auto zero = hn::Zero(d);
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    RowOfRounds row;
    std::int64_t last = -1;  // that `row` is of
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        if (i != last) row.read(a, rounds), last = i;
        std::uint64_t overlap = 0, unsure = 0;
        for (int round = 0; round < rounds.count; ++round)
            for (std::size_t first = 0; first < candidate_lanes; first += hn::Lanes(d)) {
                const auto between = gap(row, round, b, first);
                const std::size_t shift = 8 * static_cast<std::size_t>(round) + first;
                overlap |= bits_of(hn::Le(between, zero)) << shift;
                unsure |= bits_of(hn::Eq(between, zero)) << shift;
            }
        if (share_a_vertex(a, b)) overlap = without_incident(overlap, rounds, a, b);
        hit[count] = {overlap, unsure & overlap, i, j};
        count += overlap != 0;
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
