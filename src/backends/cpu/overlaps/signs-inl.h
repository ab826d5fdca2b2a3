// Signs by which pairs of faces cross (exact/overlap/face_crossing.h), in float64 lanes. A pair whose signs are all
// known needs no exact arithmetic.
//
// A sign is known if the filter of geometry/predicates.h is certain, or if the determinant is certainly 0: because each
// of its products has a factor 0, or because two of the four points are equal. Bounds: a determinant whose monomials
// pass at most eight roundings is off by at most 9 u of the sum of their magnitudes, u = 2^-53, a component of a cross
// product by at most 5 u. Nothing underflows, as coordinates are in the range of double words: a nonzero difference is
// at least 2^-202.

#if defined(CRUMPLE_CPU_OVERLAPS_SIGNS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_OVERLAPS_SIGNS_INL_H_
#undef CRUMPLE_CPU_OVERLAPS_SIGNS_INL_H_
#else
#define CRUMPLE_CPU_OVERLAPS_SIGNS_INL_H_
#endif

#include "backends/overlap_kernels.h"
#include "hwy/highway.h"

#include "backends/cpu/overlaps/words-inl.h"
#include "backends/cpu/simd/common-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::overlaps {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Mask = hn::Mask<D>;

struct VectorLanes {
    V x, y, z;
    HWY_INLINE friend VectorLanes operator-(const VectorLanes& p, const VectorLanes& q) {
        return {hn::Sub(p.x, q.x), hn::Sub(p.y, q.y), hn::Sub(p.z, q.z)};
    }
};
using Face = VectorLanes[3];

/// Cross product, and the sums of the magnitudes of its terms.
struct Product {
    VectorLanes value, size;
};

/// Sign of a number, which is unknown if neither `nonzero` nor `zero` is set. `positive` counts only with `nonzero`.
struct Sign {
    Mask positive, nonzero, zero;
};

HWY_INLINE VectorLanes load_corner(const double (&p)[3][PairBlock::size], int i) {
    const D d;
    return {hn::Load(d, p[0] + i), hn::Load(d, p[1] + i), hn::Load(d, p[2] + i)};
}
HWY_INLINE Mask equal(const VectorLanes& p, const VectorLanes& q) {
    return hn::And(hn::Eq(p.x, q.x), hn::And(hn::Eq(p.y, q.y), hn::Eq(p.z, q.z)));
}
HWY_INLINE VectorLanes choose(Mask mask, const VectorLanes& p, const VectorLanes& q) {
    return {hn::IfThenElse(mask, p.x, q.x), hn::IfThenElse(mask, p.y, q.y), hn::IfThenElse(mask, p.z, q.z)};
}

/// Computes a b − c d, and the sum of the magnitudes of its terms.
HWY_INLINE void add_terms(V a, V b, V c, V d, V& value, V& size) {
    const V plus = hn::Mul(a, b), minus = hn::Mul(c, d);
    value = hn::Sub(plus, minus);
    size = hn::Add(hn::Abs(plus), hn::Abs(minus));
}
HWY_INLINE Product cross(const VectorLanes& p, const VectorLanes& q) {
    Product c;
    add_terms(p.y, q.z, p.z, q.y, c.value.x, c.size.x);
    add_terms(p.z, q.x, p.x, q.z, c.value.y, c.size.y);
    add_terms(p.x, q.y, p.y, q.x, c.value.z, c.size.z);
    return c;
}
HWY_INLINE V dot(const VectorLanes& p, const VectorLanes& q) {
    return hn::MulAdd(p.x, q.x, hn::MulAdd(p.y, q.y, hn::Mul(p.z, q.z)));
}

/// Returns the sign of a number that is off by at most `bound` u of `size`, and is 0 if `size` is 0.
HWY_INLINE Sign sign_of(V value, V size, double bound) {
    const V zero = hn::Zero(D());
    return {hn::Gt(value, zero), hn::Gt(hn::Abs(value), hn::Mul(set(bound * 0x1p-53), size)), hn::Eq(size, zero)};
}
HWY_INLINE Sign determinant(const Product& product, const VectorLanes& p) {
    return sign_of(dot(product.value, p), dot(product.size, {hn::Abs(p.x), hn::Abs(p.y), hn::Abs(p.z)}), 9);
}
/// Returns the sign of v · (e, e², e³), e → 0+: that of the first component which is not 0.
HWY_INLINE Sign first_sign(const Product& v) {
    const Sign x = sign_of(v.value.x, v.size.x, 5), y = sign_of(v.value.y, v.size.y, 5),
               z = sign_of(v.value.z, v.size.z, 5);
    const auto then = [](const Sign& first, const Sign& second) HWY_ATTR {
        return Sign{hn::Or(hn::And(first.nonzero, first.positive), hn::And(first.zero, second.positive)),
                    hn::Or(first.nonzero, hn::And(first.zero, second.nonzero)), hn::And(first.zero, second.zero)};
    };
    return then(x, then(y, z));
}

HWY_INLINE Mask any(const Mask (&m)[3]) { return hn::Or(m[0], hn::Or(m[1], m[2])); }
HWY_INLINE Mask all(const Mask (&m)[3]) { return hn::And(m[0], hn::And(m[1], m[2])); }

/// Sides of a face's corners relative to the plane of the other face.
struct PlaneSides {
    Mask positive[3], nonzero[3], zero[3];
    Mask known;       ///< all are known, also those of corners in the plane, once that is shifted
    Sign first_sign;  ///< of the plane's normal

    HWY_INLINE PlaneSides(const Face& p, const Face& plane, const Product& normal)
        : first_sign(HWY_NAMESPACE::first_sign(normal)) {
        Mask each[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const Sign side = determinant(normal, p[k] - plane[0]);
            positive[k] = side.positive;
            nonzero[k] = side.nonzero;
            zero[k] = hn::Or(side.zero, hn::Or(equal(p[k], plane[1]), equal(p[k], plane[2])));
            each[k] = hn::Or(nonzero[k], hn::And(zero[k], first_sign.nonzero));
        }
        known = all(each);
    }
};

/// Sides under one shift.
struct ShiftedSides {
    Mask positive[3];
    Mask cut;  ///< the plane cuts the face

    /// `tie`: where true, corners in the plane are on the positive side.
    HWY_INLINE ShiftedSides(const PlaneSides& sides, Mask tie) {
        for (std::size_t k = 0; k < 3; ++k)
            positive[k] = hn::Or(hn::And(sides.nonzero[k], sides.positive[k]), hn::And(sides.zero[k], tie));
        cut = hn::Or(hn::Xor(positive[0], positive[1]), hn::Xor(positive[1], positive[2]));
    }
};

/// Corner that is alone on its side, and the corners after and before it.
struct LoneCorner {
    VectorLanes at, next, previous;

    HWY_INLINE LoneCorner(const Face& p, const ShiftedSides& side) {
        const Mask not_2 = hn::Xor(side.positive[0], side.positive[1]);
        const Mask is_0 = hn::And(not_2, hn::Xor(side.positive[0], side.positive[2]));
        const auto choose_corner = [&](std::size_t k) HWY_ATTR {  // k-th corner after the lone one
            return choose(is_0, p[k], choose(not_2, p[(k + 1) % 3], p[(k + 2) % 3]));
        };
        at = choose_corner(0), next = choose_corner(1), previous = choose_corner(2);
    }
};

/// Signs of the edges at the lone corners, under one shift.
struct EdgeSigns {
    Mask positive[2][2];
    Mask known, tied;  ///< all signs are known; some sign comes from the shift

    HWY_INLINE EdgeSigns(const LoneCorner& a, const LoneCorner& b, bool forward) {
        const D d;
        // With the points relative to the lone corner of a, a sign is that of (q × q') · (p' − p).
        const VectorLanes at = b.at - a.at;
        const Product ends = cross(b.previous - a.at, at), begins = cross(at, b.next - a.at);
        const VectorLanes along_a[2] = {a.at - a.previous, a.next - a.at},
                          along_b[2] = {b.at - b.previous, b.next - b.at};
        const Mask same = equal(a.at, b.at);
        known = hn::FirstN(d, hn::Lanes(d));
        tied = hn::FirstN(d, 0);
        for (std::size_t i = 0; i < 2; ++i)
            for (std::size_t j = 0; j < 2; ++j) {
                const VectorLanes &end_a = i == 0 ? a.previous : a.next, &end_b = j == 0 ? b.previous : b.next;
                const Sign sign = determinant(j == 0 ? ends : begins, along_a[i]);
                const Mask zero = hn::Or(hn::Or(sign.zero, same),
                                         hn::Or(equal(end_a, b.at), hn::Or(equal(a.at, end_b), equal(end_a, end_b))));
                positive[i][j] = hn::And(sign.nonzero, sign.positive);
                known = hn::And(known, hn::Or(sign.nonzero, zero));
                tied = hn::Or(tied, zero);
                if (hn::AllFalse(d, zero)) continue;
                const Sign tie = first_sign(cross(along_b[j], along_a[i]));
                known = hn::AndNot(hn::AndNot(tie.nonzero, zero), known);
                positive[i][j] = hn::Or(positive[i][j], hn::And(zero, forward ? tie.positive : hn::Not(tie.positive)));
            }
    }
};

/// Signs of some pairs of a block, all bits at once.
class SignsOfPairs {
   public:
    HWY_INLINE SignsOfPairs(CrossingSigns& signs, int first) : signs_(signs), first_(first) {}

    HWY_INLINE void put(Mask mask, std::uint64_t& bits) const {
        bits |= cpu::HWY_NAMESPACE::bits_of(D(), mask) << first_;
    }
    HWY_INLINE void put(const Mask (&mask)[3], std::uint64_t (&bits)[3]) const {
        for (std::size_t k = 0; k < 3; ++k) put(mask[k], bits[k]);
    }

    HWY_INLINE void find(const Face& a, const Face& b) {
        const D d;
        const PlaneSides of_a(a, b, cross(b[1] - b[0], b[2] - b[0])), of_b(b, a, cross(a[1] - a[0], a[2] - a[0]));
        const Mask in_plane = all(of_a.zero);
        Mask decided = hn::AndNot(hn::AndNot(of_b.first_sign.nonzero, in_plane), of_a.known);
        Mask tied = any(of_a.zero), apart = hn::AndNot(in_plane, decided);
        put(of_a.zero, signs_.zero[0]);
        put(of_b.zero, signs_.zero[1]);
        for (int shift = 0; shift < 2; ++shift) {
            const bool forward = shift == 0;
            const auto tie = [&](Mask positive) HWY_ATTR { return forward ? positive : hn::Not(positive); };
            const ShiftedSides side_a(of_a, tie(hn::Not(of_a.first_sign.positive))),
                side_b(of_b, tie(of_b.first_sign.positive));
            put(side_a.positive, signs_.sides[shift][0]);
            put(side_b.positive, signs_.sides[shift][1]);
            const Mask cut = hn::And(side_a.cut, side_b.cut);
            // If not both faces cut the other one's plane, their edges do not matter.
            Mask known = hn::Or(hn::Not(side_a.cut), of_b.known);
            if (forward) tied = hn::Or(tied, hn::And(side_a.cut, any(of_b.zero)));
            const Mask open = hn::And(decided, hn::And(known, cut));
            if (!hn::AllFalse(d, open)) {
                const EdgeSigns edges(LoneCorner(a, side_a), LoneCorner(b, side_b), forward);
                for (std::size_t i = 0; i < 2; ++i)
                    for (std::size_t j = 0; j < 2; ++j) put(edges.positive[i][j], signs_.edges[shift][i][j]);
                known = hn::AndNot(hn::AndNot(edges.known, cut), known);
                if (forward) tied = hn::Or(tied, hn::And(cut, edges.tied));
            }
            // A pair that is not tied is the same under both shifts.
            const Mask matters = forward ? decided : hn::And(decided, tied);
            decided = hn::AndNot(hn::AndNot(known, matters), decided);
            apart = hn::AndNot(hn::And(matters, cut), apart);
            if (forward && hn::AllFalse(d, hn::And(decided, tied))) break;
        }
        const auto same_side = [](const PlaneSides& of) HWY_ATTR {
            const Mask cut = hn::Or(hn::Xor(of.positive[0], of.positive[1]), hn::Xor(of.positive[1], of.positive[2]));
            return hn::AndNot(cut, all(of.nonzero));
        };
        put(hn::Or(hn::And(apart, decided), hn::Or(same_side(of_a), same_side(of_b))), signs_.apart);
        put(decided, signs_.decided);
        put(tied, signs_.tied);
    }

   private:
    CrossingSigns& signs_;
    int first_;
};

HWY_INLINE void find_signs(const PairBlock& block, CrossingSigns& signs) {
    signs = {};
    for (int i = 0; i < block.count; i += static_cast<int>(hn::Lanes(D()))) {
        const Face a{load_corner(block.a[0], i), load_corner(block.a[1], i), load_corner(block.a[2], i)};
        const Face b{load_corner(block.b[0], i), load_corner(block.b[1], i), load_corner(block.b[2], i)};
        SignsOfPairs(signs, i).find(a, b);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::overlaps
HWY_AFTER_NAMESPACE();

#endif
