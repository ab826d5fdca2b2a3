// Survivors of the plane filter, sorted by what can decide them:
//
//   edges    no shared vertex, all six signs certain                      -> edge_test
//   hit      one shared vertex, all four other signs certain, and crossing -> done
//   flat     other neighbours: mostly nearly coplanar ones                -> flat_test
//   open     the rest: no shared vertex, and signs that are not certain   -> separation tests, exact arithmetic
//
// One shared vertex v, A = (v, a1, a2), B = (v, b1, b2), signs certain and straddling: both triangles meet the line of
// the two planes in a segment that starts at v. They overlap iff both segments leave v in the same direction, that is
// iff a1 lies on the other side of B's plane than b1 does of A's (docs/narrow.md).

#if defined(CRUMPLE_CPU_SIMD_CLASSIFY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_CLASSIFY_INL_H_
#undef CRUMPLE_CPU_SIMD_CLASSIFY_INL_H_
#else
#define CRUMPLE_CPU_SIMD_CLASSIFY_INL_H_
#endif

#include "cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// The pairs of one PlaneSigns, `Lanes(d)` at a time, beginning with pair `first`: field(word) is each pair's nibble.
class Nibbles {
   public:
    using D = hn::ScalableTag<std::uint32_t>;
    using V = hn::Vec<D>;

    explicit Nibbles(int first) : first_(first) {
        const D d;
        const V pair = hn::Iota(d, static_cast<std::uint32_t>(first));
        shift_ = hn::ShiftLeft<2>(hn::And(pair, hn::Set(d, 7u)));
    }
    V half(std::uint64_t word) const {  // the 32 bits in which each lane's nibble lies
        const D d;
        const auto low = static_cast<std::uint32_t>(word), high = static_cast<std::uint32_t>(word >> 32);
        if constexpr (hn::MaxLanes(D()) == 16)
            return hn::IfThenElse(hn::FirstN(d, 8), hn::Set(d, low), hn::Set(d, high));
        else
            return hn::Set(d, first_ < 8 ? low : high);
    }
    V field(std::uint64_t word) const { return hn::And(hn::Shr(half(word), shift_), hn::Set(D(), 7u)); }
    /// 16 bits for each four pairs, instead of four for each.
    V sixteen(std::uint64_t word) const {
        const D d;
        return hn::And(hn::Shr(half(word), hn::And(shift_, hn::Set(d, 16u))), hn::Set(d, 0xffffu));
    }

   private:
    int first_;
    V shift_;
};

inline void classify(const Candidates& candidates, const PlaneSigns* HWY_RESTRICT signs, std::size_t count, bool proper,
                     Verdicts& out) {
    const Nibbles::D d;
    using V = Nibbles::V;
    const hn::Rebind<std::uint16_t, Nibbles::D> d16;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(Nibbles::D()));
    const V zero = hn::Zero(d), seven = hn::Set(d, 7u), one = hn::Set(d, 1u);
    const auto is_single = [&](V e) { return hn::And(hn::Ne(e, zero), hn::Eq(hn::And(e, hn::Sub(e, one)), zero)); };
    const auto next_corner = [&](V e) { return hn::And(hn::Or(hn::Add(e, e), hn::ShiftRight<2>(e)), seven); };

    std::uint32_t *edges = out.edges.data(), *edge_signs = out.edge_signs.data(), *flat = out.flat.data(),
                  *flat_shared = out.flat_shared.data(), *hit = out.hit.data(), *open = out.undecided.data();
    std::size_t edge_count = 0, flat_count = 0, hit_count = 0, open_count = 0;
    for (std::size_t s = 0; s < count; ++s) {
        const PlaneSigns& w = signs[s];
        std::uint64_t rows;
        std::memcpy(&rows, candidates.row.data() + w.group, sizeof rows);
        for (int first = 0; first < 16; first += lanes) {
            const Nibbles pairs(first);
            const V row = pairs.sixteen(rows);
            const V column = hn::PromoteTo(
                d, hn::LoadU(d16, candidates.column.data() + 4 * w.group + static_cast<std::size_t>(first)));
            const V packed = hn::Or(row, hn::ShiftLeft<16>(column));
            const V below_a = pairs.field(w.below_a), below_b = pairs.field(w.below_b);
            const V certain_a = pairs.field(w.below_a | w.above_a), certain_b = pairs.field(w.below_b | w.above_b);
            const V shared_a = pairs.field(w.shared_a), shared_b = pairs.field(w.shared_b);
            const auto real =
                hn::Ne(column, hn::Set(d, std::uint32_t{candidates.dummy}));  // a big row's NaN keeps padding
            const auto keep = hn::And(real, hn::Ne(hn::And(pairs.field(w.keep), one), zero));
            const auto certain = hn::Eq(hn::And(hn::Or(certain_a, shared_b), hn::Or(certain_b, shared_a)), seven);

            const auto strangers = hn::Eq(shared_b, zero);
            const auto edge = hn::And(hn::And(keep, certain), strangers);
            auto single = hn::And(hn::And(keep, certain), hn::And(is_single(shared_a), is_single(shared_b)));
            // Two segments that end in the same point cross no inside, so `proper` has to look closer.
            if (proper) single = hn::And(single, hn::Ne(zero, zero));
            const auto a1 = hn::Ne(hn::And(below_b, next_corner(shared_a)), zero);
            const auto b1 = hn::Ne(hn::And(below_a, next_corner(shared_b)), zero);
            const auto crossing = hn::And(single, hn::Xor(a1, b1));
            const auto other = hn::And(keep, hn::Not(hn::Or(edge, single)));
            const auto neighbours = hn::And(other, hn::Not(strangers));

            compress_to(d, packed, edge, edges + edge_count);
            edge_count += compress_to(d, hn::Or(below_a, hn::ShiftLeft<3>(below_b)), edge, edge_signs + edge_count);
            compress_to(d, packed, neighbours, flat + flat_count);
            flat_count +=
                compress_to(d, hn::Or(shared_b, hn::ShiftLeft<3>(shared_a)), neighbours, flat_shared + flat_count);
            open_count += compress_to(d, packed, hn::And(other, strangers), open + open_count);
            hit_count += compress_to(d, packed, crossing, hit + hit_count);
        }
    }
    out.edges.resize(edge_count);
    out.edge_signs.resize(edge_count);
    out.flat.resize(flat_count);
    out.flat_shared.resize(flat_count);
    out.hit.resize(hit_count);
    out.undecided.resize(open_count);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
