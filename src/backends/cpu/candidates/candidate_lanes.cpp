// Inner loop of candidate queries, one table for each instruction set, from one source: Highway includes this file once
// per target. In each round (LaneSteps), eight pairs of features are tested at once, by the largest of six gaps between
// their boxes, two on each axis. With AVX-512, a query for vertex_face and edge_edge tests all their pairs of lanes at
// once, and writes them at once.

#include <span>

#include "backends/cpu/candidates/candidate_kernels.h"
#include "backends/cpu/simd/tables.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/candidates/candidate_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow foreach_target.h.
#include "hwy/highway.h"

// Highway's one-lane targets lack the fixed-size vectors that these kernels use. The plain kernel takes their place.
#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "backends/cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::candidates {
namespace HWY_NAMESPACE {

using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

// Vectors of the eight lanes, or of as many as fit a register.
using D = hn::CappedTag<float, candidate_lanes>;

// Boxes of a row's lanes, by round: in the order in which the lanes of a column are tested against them.
struct ScheduledRow {
    alignas(64) float low[LaneSteps::most][3][candidate_lanes], high[LaneSteps::most][3][candidate_lanes];

    HWY_INLINE void read(const CandidateRecord& a, const LaneSteps& rounds) {
        for (int j = 0; j < rounds.count; ++j) {
            const std::uint8_t* lanes = rounds.row[j];
            for (int axis = 0; axis < 3; ++axis) {
                choose(D(), a.low[axis], lanes, low[j][axis]);
                choose(D(), a.high[axis], lanes, high[j][axis]);
            }
        }
    }

    template <class T, class Tag>
    static HWY_INLINE void choose(Tag d, const T* from, const std::uint8_t* lanes, T* to) {
        if constexpr (hn::MaxLanes(Tag()) == candidate_lanes) {
            const auto index =
                hn::PromoteTo(hn::RebindToSigned<Tag>(), hn::LoadU(hn::Rebind<std::uint8_t, Tag>(), lanes));
            hn::Store(hn::TableLookupLanes(hn::Load(d, from), hn::IndicesFromVec(d, index)), d, to);
        } else {
            for (int l = 0; l < candidate_lanes; ++l) to[l] = from[lanes[l]];
        }
    }
};

// Returns, for the column's lanes from `first` on, the largest gap on any axis between the boxes of round j; at most 0
// if they overlap.
HWY_INLINE hn::Vec<D> gap(const ScheduledRow& a, int j, const CandidateRecord& b, std::size_t first) {
    const D d;
    const auto on_axis = [&](int axis) HWY_ATTR {
        const auto after = hn::Sub(hn::Load(d, b.low[axis] + first), hn::Load(d, a.high[j][axis] + first));
        const auto before = hn::Sub(hn::Load(d, a.low[j][axis] + first), hn::Load(d, b.high[axis] + first));
        return hn::Max(after, before);
    };
    return hn::Max(on_axis(0), hn::Max(on_axis(1), on_axis(2)));
}

// Returns SharedCorners::bits().
HWY_INLINE std::size_t shared_corners(const CandidateRecord& a, const CandidateRecord& b) {
    const hn::FixedTag<std::int32_t, 4> d;
    const auto names = hn::LoadU(d, b.name);
    std::size_t bits = 0;
    for (int k = 0; k < 3; ++k) bits |= (bits_of(d, hn::Eq(names, hn::Set(d, a.name[k]))) & 7) << 3 * k;
    return bits;
}

// Runs the tests round by round. `known`: the number of rounds if known at compile time, else 0.
template <int known>
HWY_INLINE std::size_t find_by_schedule(const CandidateRecord* record, const CandidateChunk& candidates,
                                        std::int64_t begin, std::int64_t end, const LaneSteps& rounds, PairEnds& ends,
                                        UncertainTests* unsure) {
    const D d;
    const auto zero = hn::Zero(d);
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    const int step_count = known ? known : rounds.count;
    struct Hit {
        std::uint64_t certain;
        std::uint16_t row, column;
    };
    Hit hits[CandidateKernels::most + 1];
    std::size_t hit = 0;
    ScheduledRow row;
    std::int64_t last = -1;  // index of the row that `row` holds
    std::size_t count = 0;
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        if (i != last) row.read(a, rounds), last = i;
        std::uint64_t overlap = 0, equal = 0;
        for (int round = 0; round < step_count; ++round)
            for (std::size_t first = 0; first < candidate_lanes; first += hn::MaxLanes(d)) {
                const auto between = gap(row, round, b, first);
                const std::size_t shift = 8 * static_cast<std::size_t>(round) + first;
                overlap |= bits_of(d, hn::Le(between, zero)) << shift;
                equal |= bits_of(d, hn::Eq(between, zero)) << shift;
            }
        overlap &= ~rounds.incident[shared_corners(a, b)];
        hits[hit] = {overlap & ~equal, i, j};
        hit += (overlap & ~equal) != 0;
        unsure[count] = {overlap & equal, i, j};
        count += (overlap & equal) != 0;
    }
    PairEnds next = ends;
    for (const Hit& h : std::span(hits, hit)) list_pairs(h.certain, rounds, rows[h.row], columns[h.column], next);
    ends = next;
    return count;
}

#if HWY_TARGET <= HWY_AVX3

// Pairs of lanes of the kinds that impacts have, vertex_face and edge_edge: fifteen, which fit one register. The nine
// pairs of edges come first, then the row's vertices with the column's face, and the row's face with the column's
// vertices.
struct ImpactKindTests {
    static constexpr unsigned edges = 0x1ff, faces = 0x7e00, column_first = 0x7000, all = edges | faces;
    alignas(64) std::int32_t row[16] = {3, 3, 3, 4, 4, 4, 5, 5, 5, 0, 1, 2, 6, 6, 6, 7};
    alignas(64) std::int32_t column[16] = {3, 4, 5, 3, 4, 5, 3, 4, 5, 6, 6, 6, 0, 1, 2, 7};
    /// Indices that interleave the first eight lanes of two vectors.
    alignas(64) std::int32_t zip[16] = {0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23};
    /// Bits of the tests whose features have a common vertex, indexed by SharedCorners::bits().
    std::uint16_t incident[512] = {};

    ImpactKindTests() {
        for (unsigned shared = 0; shared < 512; ++shared)
            for (int bit = 0; bit < 15; ++bit)
                if (SharedCorners(shared).incident(row[bit], column[bit]))
                    incident[shared] = static_cast<std::uint16_t>(incident[shared] | 1 << bit);
    }
    /// Converts bits that are indices in `row` and `column` to bits of LaneSteps.
    std::uint64_t in_schedule(unsigned bits, const LaneSteps& rounds) const {
        std::uint64_t out = 0;
        for (; bits; bits &= bits - 1) {
            const int slot = std::countr_zero(bits);
            for (int bit = 0; bit < 8 * rounds.count; ++bit)
                if (rounds.listed[bit].row == row[slot] && rounds.listed[bit].column == column[slot])
                    out |= std::uint64_t{1} << bit;
        }
        return out;
    }
};

// Runs all tests first, then writes the pairs: overlaps are unpredictable, and a branch for each candidate, or for each
// pair, would cost more than a second pass.
std::size_t find_impacts(const CandidateRecord* record, const CandidateChunk& candidates, std::int64_t begin,
                         std::int64_t end, const LaneSteps& rounds, PairEnds& ends, UncertainTests* unsure) {
    static const ImpactKindTests impacts;
    const hn::FixedTag<float, 16> d;
    const hn::FixedTag<std::int32_t, 16> di;
    using V = hn::Vec<decltype(d)>;
    using I = hn::Vec<decltype(di)>;
    const auto zero = hn::Zero(d);
    const I of_row = hn::Load(di, impacts.row), of_column = hn::Load(di, impacts.column),
            zip = hn::Load(di, impacts.zip), zip_ninth = hn::Add(zip, hn::Set(di, 8));
    // Returns lanes of the k-th group of eight floats of a record: low x, y, z, then high x, y, z. Loads two groups at
    // once.
    const auto lanes = [&](const CandidateRecord& r, int k, I lane) HWY_ATTR {
        const V both = hn::Load(d, reinterpret_cast<const float*>(&r) + 16 * (k / 2));
        return hn::TableLookupLanes(both, hn::IndicesFromVec(d, k % 2 ? hn::Add(lane, hn::Set(di, 8)) : lane));
    };
    const auto ids = [&](const CandidateRecord& r, I lane) HWY_ATTR {
        const hn::Half<decltype(di)> half;
        return hn::TableLookupLanes(hn::ZeroExtendVector(di, hn::Load(half, r.id)), hn::IndicesFromVec(di, lane));
    };
    const auto mask_of = [](unsigned bits) HWY_ATTR { return static_cast<__mmask16>(bits); };
    const auto write = [&](I first, I second, unsigned bits, Pair*& next) HWY_ATTR {
        const __m512i a = _mm512_maskz_compress_epi32(mask_of(bits), first.raw);
        const __m512i b = _mm512_maskz_compress_epi32(mask_of(bits), second.raw);
        _mm512_storeu_si512(next, _mm512_permutex2var_epi32(a, zip.raw, b));
        if (HWY_UNLIKELY(bits == ImpactKindTests::edges))  // nine pairs: the first store wrote eight
            _mm512_storeu_si512(next + 8, _mm512_permutex2var_epi32(a, zip_ninth.raw, b));
        next += hwy::PopCount(bits);
    };
    const CandidateRecord* rows = record + candidates.rows;
    const CandidateRecord* columns = record + candidates.columns;
    struct Hit {
        std::uint16_t overlaps, equal, row, column;
    };
    Hit hits[CandidateKernels::most + 1];
    std::size_t hit = 0;
    V row[6] = {zero, zero, zero, zero, zero, zero};
    std::int64_t last = -1;  // index of the row that `row` holds
    for (std::int64_t k = begin; k < end; ++k) {
        const std::uint16_t i = candidates.row[k], j = candidates.column[k];
        if (j == candidates.dummy) continue;
        const CandidateRecord &a = rows[i], &b = columns[j];
        if (i != last) {
            for (int n = 0; n < 6; ++n) row[n] = lanes(a, n, of_row);
            last = i;
        }
        V between = hn::Max(hn::Sub(lanes(b, 0, of_column), row[3]), hn::Sub(row[0], lanes(b, 3, of_column)));
        for (int axis = 1; axis < 3; ++axis)
            between = hn::Max(between, hn::Max(hn::Sub(lanes(b, axis, of_column), row[3 + axis]),
                                               hn::Sub(row[axis], lanes(b, 3 + axis, of_column))));
        const unsigned apart = impacts.incident[shared_corners(a, b)] | ~ImpactKindTests::all;
        const auto overlap = static_cast<unsigned>(bits_of(d, hn::Le(between, zero))) & ~apart;
        const auto equal = static_cast<unsigned>(bits_of(d, hn::Eq(between, zero)));
        hits[hit] = {static_cast<std::uint16_t>(overlap), static_cast<std::uint16_t>(equal), i, j};
        hit += overlap != 0;
    }
    Pair *faces = ends[static_cast<std::size_t>(CandidateKind::vertex_face)],
         *edges = ends[static_cast<std::size_t>(CandidateKind::edge_edge)];
    std::size_t count = 0;
    for (const Hit& h : std::span(hits, hit)) {
        const unsigned certain = h.overlaps & ~unsigned{h.equal};
        const I row_id = ids(rows[h.row], of_row), column_id = ids(columns[h.column], of_column);
        const unsigned swapped =
            ImpactKindTests::column_first |
            (ImpactKindTests::edges & static_cast<unsigned>(bits_of(di, hn::Lt(column_id, row_id))));
        const I first{_mm512_mask_blend_epi32(mask_of(swapped), row_id.raw, column_id.raw)};
        const I second{_mm512_mask_blend_epi32(mask_of(swapped), column_id.raw, row_id.raw)};
        write(first, second, certain & ImpactKindTests::edges, edges);
        write(first, second, certain & ImpactKindTests::faces, faces);
        if (const unsigned perhaps = h.overlaps & h.equal; HWY_UNLIKELY(perhaps))
            unsure[count++] = {impacts.in_schedule(perhaps, rounds), h.row, h.column};
    }
    ends[static_cast<std::size_t>(CandidateKind::vertex_face)] = faces;
    ends[static_cast<std::size_t>(CandidateKind::edge_edge)] = edges;
    return count;
}

#endif

std::size_t find(const CandidateRecord* record, const CandidateChunk& candidates, std::int64_t begin, std::int64_t end,
                 const LaneSteps& rounds, PairEnds& next, UncertainTests* unsure) {
#if HWY_TARGET <= HWY_AVX3
    if (rounds.has_impact_kinds_only) return find_impacts(record, candidates, begin, end, rounds, next, unsure);
#endif
    // Three rounds: vertex_face and edge_edge, the usual kinds.
    return rounds.count == 3 ? find_by_schedule<3>(record, candidates, begin, end, rounds, next, unsure)
                             : find_by_schedule<0>(record, candidates, begin, end, rounds, next, unsure);
}

const CandidateKernels table{find};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::candidates
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace candidates {
namespace {

using Kernels = CandidateKernels;
#include "backends/cpu/simd/tables-inl.h"

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
