// Classifies candidates, that is, pairs of a row and a column of the sweep (stages/layout.h), by the plane filter's
// signs. A pair is apart if all corners of one triangle, except for shared ones, certainly lie on one side of the
// other's plane; if adjacent triangles are skipped (NarrowPolicy), all pairs with a shared vertex are apart, too. If
// all corners of the second triangle are shared, as in a duplicated face, signs decide nothing. The survivors are
// sorted by what can decide them:
//
//   edge   no shared vertex, all six signs certain                        -> edge_test
//   hit    one shared vertex, all four other signs certain, and crossing  -> decided
//   flat   other adjacent triangles: mostly nearly coplanar               -> flat_test
//   open   the rest: no shared vertex, and uncertain signs                -> separating tests, exact decision
//
// Let A = (v, a1, a2) and B = (v, b1, b2) share one vertex v, and each have its other corners on different sides of the
// other's plane, with certain signs. Then both triangles meet the line of the two planes in a segment that starts at v.
// They overlap iff both segments leave v in the same direction, that is, iff a1 is above B's plane and b1 below A's, or
// a1 below and b1 above (docs/narrow.md).
//
// Three passes: compute the codes of all candidates, in 8-bit lanes; pack those that are not 0; sort these by kind.
// About one in five candidates survives, so the last pass, the only one that writes several lists, is short.

#if defined(CRUMPLE_INTERSECT_CPU_CLASSIFY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_CLASSIFY_INL_H_
#undef CRUMPLE_INTERSECT_CPU_CLASSIFY_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_CLASSIFY_INL_H_
#endif

#include "backends/cpu/intersections/plane_signs-inl.h"
#include "backends/cpu/simd/compress-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

// Codes of pairs. One of the two upper bits is set for edge or flat; the six bits below are then an entry of
// Verdicts::edge_signs or Verdicts::flat_shared. All other codes are complete.
constexpr std::uint8_t code_apart = 0, code_hit = 1, code_open = 2, code_edge = 0x40, code_flat = 0x80;

/// Returns the codes of one vector of pairs, from the nibbles of PlaneSigns, one per 8-bit lane.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V code_of(D d, V above_a, V below_a, V above_b, V below_b, V same0, V same1, V same2,
                     const NarrowPolicy& policy) {
    const V zero = hn::Zero(d), one = hn::Set(d, 1), two = hn::Set(d, 2), four = hn::Set(d, 4), seven = hn::Set(d, 7);
    const auto some = [&](V e) { return hn::Ne(e, zero); };
    const auto all = [&](V e) { return hn::Eq(e, seven); };
    const auto single = [&](V e) { return hn::Or(hn::Or(hn::Eq(e, one), hn::Eq(e, two)), hn::Eq(e, four)); };
    const auto next_corner = [&](V e) { return hn::IfThenElse(hn::Eq(e, four), one, hn::Add(e, e)); };
    const auto times_eight = [&](V e) {
        const V twice = hn::Add(e, e), four_times = hn::Add(twice, twice);
        return hn::Add(four_times, four_times);
    };
    const V shared_b = hn::Or(same0, hn::Or(same1, same2));
    const V shared_a = hn::Or(hn::IfThenElseZero(some(same0), one),
                              hn::Or(hn::IfThenElseZero(some(same1), two), hn::IfThenElseZero(some(same2), four)));
    auto apart = hn::Or(hn::Or(all(hn::Or(above_a, shared_b)), all(hn::Or(below_a, shared_b))),
                        hn::Or(all(hn::Or(above_b, shared_a)), all(hn::Or(below_b, shared_a))));
    apart = hn::And(apart, hn::Ne(shared_b, seven));  // duplicated faces are left to the exact test
    const auto neighbours = some(shared_b);
    if (policy.skip_adjacent) apart = hn::Or(apart, neighbours);

    const auto certain =
        all(hn::And(hn::Or(hn::Or(above_a, below_a), shared_b), hn::Or(hn::Or(above_b, below_b), shared_a)));
    auto by_direction = hn::And(certain, hn::And(single(shared_a), single(shared_b)));
    // A common segment that starts at the shared vertex may cross no interior, so `proper` leaves these pairs to the
    // flat test.
    if (policy.proper) by_direction = hn::And(by_direction, some(zero));
    const auto a1 = some(hn::And(below_b, next_corner(shared_a))), b1 = some(hn::And(below_a, next_corner(shared_b)));
    const V direction = hn::IfThenElseZero(hn::Xor(a1, b1), hn::Set(d, code_hit));

    const V flat = hn::Or(hn::Set(d, code_flat), hn::Or(shared_b, times_eight(shared_a)));
    const V edge = hn::Or(hn::Set(d, code_edge), hn::Or(below_a, times_eight(below_b)));
    const V strangers = hn::IfThenElse(certain, edge, hn::Set(d, code_open));
    return hn::IfThenZeroElse(apart,
                              hn::IfThenElse(by_direction, direction, hn::IfThenElse(neighbours, flat, strangers)));
}

/// Writes the codes of all candidates, and of up to 2 * `padding` more.
inline void write_codes(PlaneSigns& signs, std::int64_t count, const NarrowPolicy& policy,
                        std::uint8_t* HWY_RESTRICT out) {
    static_assert(2 * sign_lanes <= 2 * padding);
    const SignsOfPairs of(signs, count);
    const auto code = [&](auto... nibbles) HWY_ATTR { return code_of(SignBytes(), nibbles..., policy); };
    for (std::int64_t i = 0; i < count;) i += of.write_codes(i, code, out);
}

/// Lists the candidates that are not apart, packed as column << 16 | row, and their codes; returns their number.
inline std::size_t pack_survivors(const CandidateChunk& candidates, const std::uint8_t* HWY_RESTRICT code,
                                  std::uint32_t* HWY_RESTRICT survivor, std::uint32_t* HWY_RESTRICT survivor_code) {
    const hn::ScalableTag<std::uint32_t> d;
    const hn::Rebind<std::uint16_t, decltype(d)> d16;
    const hn::Rebind<std::uint8_t, decltype(d)> d8;
    constexpr auto lanes = static_cast<std::int64_t>(hn::MaxLanes(hn::ScalableTag<std::uint32_t>()));
    const std::uint16_t* HWY_RESTRICT row = candidates.row.data();
    const std::uint16_t* HWY_RESTRICT column = candidates.column.data();
    std::size_t survivors = 0;
    for (std::int64_t i = 0; i < candidates.count; i += lanes) {
        const auto codes = hn::PromoteTo(d, hn::LoadU(d8, code + i));
        const auto columns = hn::PromoteTo(d, hn::LoadU(d16, column + i));
        const auto packed = hn::Or(hn::PromoteTo(d, hn::LoadU(d16, row + i)), hn::ShiftLeft<16>(columns));
        const auto survives = hn::Ne(codes, hn::Zero(d));
        compress_to(d, codes, survives, survivor_code + survivors);
        survivors += compress_to(d, packed, survives, survivor + survivors);
    }
    return survivors;
}

/// Distributes the survivors to the lists edges, flat, hit and undecided of `out`.
inline void sort_survivors(std::size_t count, std::uint16_t dummy, Verdicts& out) {
    const hn::ScalableTag<std::uint32_t> d;
    const std::size_t lanes = hn::Lanes(d);
    std::uint32_t *edges = out.edges.data(), *edge_signs = out.edge_signs.data(), *flat = out.flat.data(),
                  *flat_shared = out.flat_shared.data(), *hit = out.hit.data(), *open = out.undecided.data();
    std::size_t edge_count = 0, flat_count = 0, hit_count = 0, open_count = 0;
    for (std::size_t s = 0; s < count; s += lanes) {
        const auto packed = hn::LoadU(d, out.survivor.data() + s), code = hn::LoadU(d, out.survivor_code.data() + s);
        const auto column = hn::ShiftRight<16>(packed);
        // Padding survives in rows of big members, whose NaN decide nothing.
        const auto valid = hn::And(hn::FirstN(d, count - s), hn::Ne(column, hn::Set(d, std::uint32_t{dummy})));
        const auto kind = hn::And(code, hn::Set(d, 0xc0u)), detail = hn::And(code, hn::Set(d, 0x3fu));
        const auto is_edge = hn::And(valid, hn::Eq(kind, hn::Set(d, std::uint32_t{code_edge})));
        const auto is_flat = hn::And(valid, hn::Eq(kind, hn::Set(d, std::uint32_t{code_flat})));
        const auto is_hit = hn::And(valid, hn::Eq(code, hn::Set(d, std::uint32_t{code_hit})));
        const auto is_open = hn::And(valid, hn::Eq(code, hn::Set(d, std::uint32_t{code_open})));
        compress_to(d, packed, is_edge, edges + edge_count);
        edge_count += compress_to(d, detail, is_edge, edge_signs + edge_count);
        compress_to(d, packed, is_flat, flat + flat_count);
        flat_count += compress_to(d, detail, is_flat, flat_shared + flat_count);
        hit_count += compress_to(d, packed, is_hit, hit + hit_count);
        open_count += compress_to(d, packed, is_open, open + open_count);
    }
    out.edges.resize(edge_count);
    out.edge_signs.resize(edge_count);
    out.flat.resize(flat_count);
    out.flat_shared.resize(flat_count);
    out.hit.resize(hit_count);
    out.undecided.resize(open_count);
}

inline void classify(const CandidateChunk& candidates, const NarrowPolicy& policy, Verdicts& out) {
    const auto count = static_cast<std::size_t>(candidates.count);
    out.code.resize_discard(count + 2 * padding);
    out.survivor.resize_discard(count + padding);
    out.survivor_code.resize_discard(count + padding);
    write_codes(out.signs, candidates.count, policy, out.code.data());
    const std::size_t survivors =
        pack_survivors(candidates, out.code.data(), out.survivor.data(), out.survivor_code.data());
    for (auto* list : {&out.edges, &out.edge_signs, &out.flat, &out.flat_shared, &out.hit, &out.undecided})
        list->resize_discard(survivors + padding);
    sort_survivors(survivors, candidates.dummy, out);
    out.edge_tests = static_cast<std::int64_t>(survivors);
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
