// Kernels for the overlap of two bodies (backends/overlap_kernels.h) in SIMD lanes, one table for each instruction set,
// from one source: Highway includes this file once per target. Sums are computed in double words.
//
// Each number has an error bound in float64. With u = 2^-53, a sum of words errs by at most 3.01 u² of itself, a
// product by 7 u², a quotient by 15.01 u². So, from exact differences, a component of a cross product errs by 10.1 u²
// of the sum of the magnitudes of its terms, and a determinant by 24 u². The factors below are larger, so that they
// cover the roundings of the bounds themselves. Their excess also covers underflow, for coordinates in the range of
// double words: a nonzero difference is at least 2^-202, and every bound at least 2^-1012.

#include "backends/cpu/overlaps/overlap_lanes.h"
#include "backends/cpu/simd/tables.h"

#include "hwy/detect_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "backends/cpu/overlaps/overlap_lanes.cpp"
#include "hwy/foreach_target.h"
// Must follow foreach_target.h.
#include "hwy/highway.h"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
#include "backends/cpu/overlaps/signs-inl.h"
#include "backends/cpu/overlaps/words-inl.h"
#include "backends/cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::overlaps {
namespace HWY_NAMESPACE {

using cpu::HWY_NAMESPACE::bits_of;

constexpr double uu = 0x1p-106;  // u²
/// Segment ends whose parameter along their edge has a larger error are uncertain.
constexpr double largest_share_error = 0x1p-80;
/// Bound on the error of the sum over a block, relative to the sum of the terms' magnitudes: at most 3.01 u² for each
/// addition, with up to three additions for each vector of segments.
constexpr double of_additions = 5 * SegmentBlock::size * uu;

struct Total {
    Word sum;
    V error;

    HWY_INLINE Total() : sum{hn::Zero(D()), hn::Zero(D())}, error(hn::Zero(D())) {}
    HWY_INLINE void add(Word term, V term_error) {
        sum = sum + term;
        error = hn::Add(error, hn::MulAdd(set(of_additions), hn::Abs(term.high), term_error));
    }
    HWY_INLINE void store(WordSum& to) const {
        const D d;
        hn::StoreU(sum.high, d, to.high);
        hn::StoreU(sum.low, d, to.low);
        to.error = (1 + 0x1p-20) * hn::GetLane(hn::SumOfLanes(d, error));
    }
};
struct VectorTotal {
    Total x, y, z;

    HWY_INLINE VectorTotal() {}
    HWY_INLINE void add(const Words& term, const Sizes& error) {
        x.add(term.x, error.x), y.add(term.y, error.y), z.add(term.z, error.z);
    }
    HWY_INLINE void store(WordSum (&to)[3]) const { x.store(to[0]), y.store(to[1]), z.store(to[2]); }
};

/// Number with a bound on its error.
struct Bounded {
    Word value;
    V error;

    HWY_INLINE V size() const { return hn::Add(hn::Abs(value.high), error); }
};

template <class Mask>
HWY_INLINE Words only(Mask mask, const Words& p) {
    const auto part = [&](const Word& w) HWY_ATTR {
        return Word{hn::IfThenElseZero(mask, w.high), hn::IfThenElseZero(mask, w.low)};
    };
    return {part(p.x), part(p.y), part(p.z)};
}
template <class Mask>
HWY_INLINE Sizes only(Mask mask, const Sizes& p) {
    return {hn::IfThenElseZero(mask, p.x), hn::IfThenElseZero(mask, p.y), hn::IfThenElseZero(mask, p.z)};
}
template <class Mask>
HWY_INLINE Bounded only(Mask mask, const Bounded& b) {
    return {{hn::IfThenElseZero(mask, b.value.high), hn::IfThenElseZero(mask, b.value.low)},
            hn::IfThenElseZero(mask, b.error)};
}
template <class Mask>
HWY_INLINE Words choose(Mask mask, const Words& p, const Words& q) {
    const auto part = [&](const Word& v, const Word& w) HWY_ATTR {
        return Word{hn::IfThenElse(mask, v.high, w.high), hn::IfThenElse(mask, v.low, w.low)};
    };
    return {part(p.x, q.x), part(p.y, q.y), part(p.z, q.z)};
}

/// Returns the dot product of an exact vector and one that errs by `error`.
HWY_INLINE Bounded dot(const Words& exact, const Words& p, const Sizes& error) {
    const Sizes size = size_of(exact);
    return {dot(exact, p), dot(size, error + 16 * uu * (size_of(p) + error))};
}
HWY_INLINE Sizes error_of_product(const Bounded& b, const Sizes& size, const Sizes& error) {
    return hn::MulAdd(set(16 * uu), b.size(), b.error) * size + b.size() * error;
}

/// End of a segment, relative to the origin.
struct End {
    Words at;
    Sizes size, error;
    hn::Mask<D> certain;
    Words edge_end;  ///< SegmentBlock::to: corner at which the edge under this point ends, relative to the origin
};

HWY_INLINE End end_of(const SegmentBlock& block, const Vec3d& origin, int e, int i) {
    const auto& face = block.face[e];
    const Words side = difference(face[1], face[0], i), other_side = difference(face[2], face[0], i);
    const Words normal = cross(side, other_side);
    const Sizes normal_size = cross(size_of(side), size_of(other_side));
    const Words from = difference(block.from[e], face[0], i), to = difference(block.to[e], face[0], i);
    const Words along = difference(block.to[e], block.from[e], i);
    const V known = hn::Load(D(), block.share[e] + i);
    const auto at_vertex = hn::Ge(known, hn::Zero(D()));
    const Word distance = dot(normal, from), all = distance - dot(normal, to);
    const V distance_error = hn::Mul(set(32 * uu), dot(normal_size, size_of(from) + size_of(to)));
    const V least = hn::Sub(hn::Mul(set(1 - 0x1p-40), hn::Abs(all.high)), distance_error);
    const Word quotient = distance / all;
    V error = hn::MulAdd(hn::Div(distance_error, least), set(2.1), set(20 * uu));
    End end;
    end.certain = hn::Or(at_vertex, hn::And(hn::Gt(least, hn::Zero(D())), hn::Le(error, set(largest_share_error))));
    // Quotients that are not needed, or uncertain, may be NaN.
    const auto computed = hn::AndNot(at_vertex, end.certain);
    const Word share{hn::IfThenElse(computed, quotient.high, hn::Max(known, hn::Zero(D()))),
                     hn::IfThenElseZero(computed, quotient.low)};
    error = hn::IfThenElseZero(computed, error);
    end.at = difference(block.from[e], origin, i) + share * along;
    end.error = hn::Mul(set(1.5), error) * size_of(along) + 12 * uu * (size_of(end.at) + size_of(along));
    end.size = size_of(end.at) + end.error;
    end.edge_end = difference(block.to[e], origin, i);
    return end;
}

template <bool numbers>
HWY_INLINE std::uint64_t segments(const SegmentBlock& block, const Vec3d& origin, BlockSums& sums) {
    const D d;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));
    Total volume;
    VectorTotal moment, area, torque;
    std::uint64_t uncertain = 0;
    for (int i = 0; i < block.count; i += lanes) {
        const End s = end_of(block, origin, 0, i), e = end_of(block, origin, 1, i);
        const V times = hn::Load(d, block.times + i), in_volume = hn::Load(d, block.in_volume + i);
        const auto wanted = hn::Gt(hn::Add(times, in_volume), hn::Zero(d)), certain = hn::And(s.certain, e.certain);
        uncertain |= bits_of(d, hn::AndNot(certain, wanted)) << i;
        const auto on_curve = hn::And(certain, hn::Gt(times, hn::Zero(d)));
        const auto counts = hn::And(certain, hn::Gt(in_volume, hn::Zero(d)));

        const Words step = e.at - s.at, c = cross(s.at, step);
        const Sizes step_error = s.error + e.error + 4 * uu * size_of(step), step_size = size_of(step) + step_error;
        const Sizes c_error =
            cross(s.size, step_error) + cross(s.error, step_size) + 12 * uu * cross(s.size, step_size);
        const Words a = difference(block.first[0], origin, i), b = difference(block.first[1], origin, i);
        const Bounded between = dot(difference(block.first[0], block.first[1], i), c, c_error);
        {
            const Bounded term = only(counts, between);
            volume.add(term.value, term.error);
        }
        if (numbers) {
            const auto curve = [&](const Words& p) HWY_ATTR {
                const auto part = [&](const Word& w) HWY_ATTR { return scaled(w, times); };
                return only(on_curve, Words{part(p.x), part(p.y), part(p.z)});
            };
            const auto curve_error = [&](const Sizes& p) HWY_ATTR { return only(on_curve, times * p); };
            area.add(curve(c), curve_error(c_error));
            const Word square = dot(s.at, s.at + e.at) + dot(e.at, e.at);
            const V square_size = hn::Add(dot(s.size, s.size + e.size), dot(e.size, e.size));
            const V square_error =
                hn::MulAdd(set(24 * uu), square_size,
                           hn::Add(dot(s.error, 2 * s.size + e.size), dot(e.error, s.size + 2 * e.size)));
            torque.add(curve(square * step),
                       curve_error(hn::Mul(set(1.1), square_size) * step_error +
                                   hn::MulAdd(set(8 * uu), square_size, square_error) * step_size));

            const Bounded of_a = dot(a, c, c_error), of_b = dot(b, c, c_error);
            const Words middle = s.at + e.at;
            const Sizes middle_size = s.size + e.size, none = 0 * middle_size;
            const Words term = of_a.value * a - of_b.value * b + between.value * middle;
            const Sizes error = error_of_product(of_a, size_of(a), none) + error_of_product(of_b, size_of(b), none) +
                                error_of_product(between, middle_size, s.error + e.error + 4 * uu * middle_size);
            moment.add(only(counts, term), only(counts, error));
        }
        // Adds the terms of an end that lies on edge 12 of a face, from corner 1 to corner 2.
        const auto add_edge = [&](const End& end, int number) HWY_ATTR {
            const V jump = hn::Load(d, block.jump[number] + i);
            if (hn::AllTrue(d, hn::Eq(jump, hn::Zero(d)))) return;
            const auto of_b = hn::Gt(hn::Load(d, block.of_b[number] + i), hn::Zero(d));
            const Words first = choose(of_b, b, a), normal = cross(end.edge_end, first);
            const Sizes normal_size = cross(size_of(end.edge_end), size_of(first));
            Bounded cone{scaled(dot(end.at, normal), jump),
                         hn::Mul(hn::Abs(jump), dot(normal_size, end.error + 28 * uu * end.size))};
            // The terms of the cone may cancel, so errors are relative to their magnitudes.
            const V size = dot(normal_size, end.size);
            cone = only(counts, cone);
            volume.add(cone.value, cone.error);
            if (!numbers) return;
            const Words corners = first + end.at + end.edge_end;
            const Sizes corners_size = size_of(first) + end.size + size_of(end.edge_end);
            const Sizes error = cone.error * corners_size + only(counts, size * (end.error + 24 * uu * corners_size));
            moment.add(cone.value * corners, hn::Mul(set(1.1), hn::Abs(jump)) * error);
        };
        add_edge(s, 0);
        add_edge(e, 1);
    }
    sums.lanes = lanes;
    volume.store(sums.volume);
    moment.store(sums.moment);
    area.store(sums.area);
    torque.store(sums.torque);
    return uncertain;
}

template <bool numbers>
HWY_INLINE void faces(const FaceBlock& block, const Vec3d& origin, BlockSums& sums) {
    const D d;
    constexpr int lanes = static_cast<int>(hn::MaxLanes(D()));
    Total volume;
    VectorTotal moment;
    for (int i = 0; i < block.count; i += lanes) {
        const Words p = difference(block.corner[0], origin, i);
        const Words side = difference(block.corner[1], block.corner[0], i),
                    other_side = difference(block.corner[2], block.corner[0], i);
        const V times = hn::Load(d, block.times + i);
        const Word cone = dot(cross(side, other_side), p) * Word{times, hn::Zero(d)};
        const V size = hn::Mul(hn::Abs(times), dot(cross(size_of(side), size_of(other_side)), size_of(p)));
        volume.add(cone, hn::Mul(set(36 * uu), size));
        if (!numbers) continue;
        const Words q = difference(block.corner[1], origin, i), r = difference(block.corner[2], origin, i);
        moment.add(cone * (p + q + r), hn::Mul(set(64 * uu), size) * (size_of(p) + size_of(q) + size_of(r)));
    }
    sums.lanes = lanes;
    volume.store(sums.volume);
    moment.store(sums.moment);
}

void add_faces(const FaceBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums) {
    numbers ? faces<true>(block, origin, sums) : faces<false>(block, origin, sums);
}
std::uint64_t add_segments(const SegmentBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums) {
    return numbers ? segments<true>(block, origin, sums) : segments<false>(block, origin, sums);
}

const OverlapKernels table{find_signs, add_faces, add_segments};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::overlaps
HWY_AFTER_NAMESPACE();
#endif

#if HWY_ONCE
namespace crumple::cpu {
namespace overlaps {
namespace {

using Kernels = OverlapKernels;
#include "backends/cpu/simd/tables-inl.h"

const OverlapKernels none{};

}  // namespace
}  // namespace overlaps

const OverlapKernels* overlap_kernels(Simd simd) {
    const OverlapKernels& chosen = choose<OverlapKernels>(overlaps::tables, overlaps::none, simd);
    return &chosen == &overlaps::none ? nullptr : &chosen;
}

}  // namespace crumple::cpu
#endif
