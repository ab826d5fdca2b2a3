// Boxes of a leaf's members in the leaf's frame (stage `align`), one member in each block of 128 bits of a vector, and
// their quantisation for `sort`. A leaf is a small set of triangles, its members, that one sweep searches. A query's
// `build` (LeafQuery::build) calls BoxLanes while it has the corners in registers.

#if defined(CRUMPLE_CPU_SIMD_BOXES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BOXES_INL_H_
#undef CRUMPLE_CPU_SIMD_BOXES_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BOXES_INL_H_
#endif

#include <algorithm>

#include "backends/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// Rotates corners into a leaf's frame and computes the leaf's bounds.
class BoxLanes {
    using D = hn::ScalableTag<float>;
    using V = hn::Vec<D>;

   public:
    /// Boxes, one member in each block.
    struct Box {
        V low, high;
    };

    explicit HWY_INLINE BoxLanes(const LeafFrame& frame)
        : column_x_(column(frame, 0)),
          column_y_(column(frame, 1)),
          column_z_(column(frame, 2)),
          big_(hn::Set(D(), frame.big)),
          least_(hn::Set(D(), LeafBounds::most)),
          greatest_(hn::Set(D(), -LeafBounds::most)),
          reach_(hn::Zero(D())) {}

    /// Returns a corner of each member in the frame's axes. `p`: the corner relative to the origin.
    HWY_INLINE V turn(V p) const {
        return hn::MulAdd(column_x_, hn::Broadcast<0>(p),
                          hn::MulAdd(column_y_, hn::Broadcast<1>(p), hn::Mul(column_z_, hn::Broadcast<2>(p))));
    }

    /// Stores the boxes of the members from i on; writes up to a vector's length.
    static HWY_INLINE void store(const Box& box, std::int64_t i, Boxes& boxes) {
        hn::StoreU(box.low, D(), &boxes.low[static_cast<std::size_t>(i)].x);
        hn::StoreU(box.high, D(), &boxes.high[static_cast<std::size_t>(i)].x);
    }

    /// Returns true if a member may be big. `size`: the largest |coordinate| of each member's corners, by axis.
    HWY_INLINE bool any_big(V size) const { return HWY_UNLIKELY(!hn::AllTrue(D(), hn::Le(size, big_))); }

    /// Updates the leaf's bounds by boxes and sizes.
    HWY_INLINE void count(const Box& box, V size) {
        least_ = hn::Min(least_, box.low);
        greatest_ = hn::Max(greatest_, box.high);
        reach_ = hn::Max(reach_, size);
    }

    /// Excludes big members (geometry/leaf_frame.h) from count(); call before it if any_big(). Widens their boxes one
    /// by one, calls rewrite(i) for each, and makes them empty in `box` and `size`. Not inlined, and static, so that
    /// the vectors of *this stay in registers.
    template <class Rewrite>
    static HWY_NOINLINE void replace_big(const BuildInput& in, std::int64_t first, Box& box, V& size, Boxes& boxes,
                                         LeafBounds& bounds, Rewrite rewrite) {
        HWY_ALIGN float sizes[4 * blocks];
        HWY_ALIGN std::uint32_t small[4 * blocks];
        hn::Store(size, D(), sizes);
        for (int b = 0; b < blocks; ++b) {
            const float far = std::max(sizes[4 * b], std::max(sizes[4 * b + 1], sizes[4 * b + 2]));
            const bool is_big = !(far <= in.frame.big);
            for (int lane = 0; lane < 4; ++lane) small[4 * b + lane] = is_big ? 0 : ~0u;
            const std::int64_t i = first + b;
            if (!is_big || i >= in.members) continue;
            widen_big(far, boxes.low[static_cast<std::size_t>(i)], boxes.high[static_cast<std::size_t>(i)]);
            rewrite(i);
            bounds.reach = max(bounds.reach, big_share * far);
            ++bounds.big;
        }
        const auto keep = hn::MaskFromVec(hn::BitCast(D(), hn::Load(hn::RebindToUnsigned<D>(), small)));
        box.low = hn::IfThenElse(keep, box.low, hn::Set(D(), LeafBounds::most));
        box.high = hn::IfThenElse(keep, box.high, hn::Set(D(), -LeafBounds::most));
        size = hn::IfThenElseZero(keep, size);
    }

    /// Merges the counted bounds into `bounds`.
    HWY_INLINE void finish(LeafBounds& bounds) const {
        HWY_ALIGN float lanes[3][4 * blocks];
        hn::Store(least_, D(), lanes[0]);
        hn::Store(greatest_, D(), lanes[1]);
        hn::Store(reach_, D(), lanes[2]);
        for (int b = 0; b < blocks; ++b) {
            const auto block = [&](int k) { return Vec3f{lanes[k][4 * b], lanes[k][4 * b + 1], lanes[k][4 * b + 2]}; };
            bounds.low = min(bounds.low, block(0));
            bounds.high = max(bounds.high, block(1));
            bounds.reach = max(bounds.reach, largest(block(2)));
        }
    }

   private:
    /// Returns a column of the rotation: what one coordinate contributes to each axis.
    static HWY_INLINE V column(const LeafFrame& frame, int coordinate) {
        HWY_ALIGN const float lanes[4] = {frame.axis[0][coordinate], frame.axis[1][coordinate],
                                          frame.axis[2][coordinate], 0};
        return hn::LoadDup128(D(), lanes);
    }

    V column_x_, column_y_, column_z_, big_;
    V least_, greatest_, reach_;
};

inline void quantise(const Boxes& boxes, std::int64_t n, const Quantisation& by, QuantisedBox* out) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto base_low = hn::LoadDup128(d, by.base_low), base_high = hn::LoadDup128(d, by.base_high),
               scale = hn::LoadDup128(d, by.scale);
    const auto most = hn::Set(d, 65534.0f), zero = hn::Zero(d);
    const auto to_16_bits = [&](const BoxCorner& corner, auto base) HWY_ATTR {
        const auto value = hn::Mul(hn::Sub(hn::LoadU(d, &corner.x), base), scale);
        return hn::ConvertTo(di, hn::Min(hn::Max(value, zero), most));
    };
    for (std::int64_t i = 0; i < n; i += blocks) {
        const auto low = to_16_bits(boxes.low[i], base_low), high = to_16_bits(boxes.high[i], base_high);
        // Packs low and high in one lane, and moves x last: the rest is then laid out as the RowBox that `sort` copies.
        const auto pairs = hn::Shuffle0321(hn::Or(low, hn::ShiftLeft<16>(high)));
        hn::StoreU(pairs, di, reinterpret_cast<std::int32_t*>(out + i));
    }
}

inline void split_boxes(const RowBox* box, std::int64_t rows, SortedLeaf& sorted) {
    const hn::ScalableTag<std::uint16_t> d;
    const auto lanes = static_cast<std::int64_t>(hn::Lanes(d));
    static_assert(hn::MaxLanes(hn::ScalableTag<std::uint16_t>()) <= padding / 2);
    for (std::int64_t row = 0; row < rows + padding / 2; row += lanes) {
        hn::Vec<decltype(d)> low_y, high_y, low_z, high_z;
        hn::LoadInterleaved4(d, &box[row].low_y, low_y, high_y, low_z, high_z);
        hn::Store(low_y, d, sorted.low_y.data() + row);
        hn::Store(high_y, d, sorted.high_y.data() + row);
        hn::Store(low_z, d, sorted.low_z.data() + row);
        hn::Store(high_z, d, sorted.high_z.data() + row);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
