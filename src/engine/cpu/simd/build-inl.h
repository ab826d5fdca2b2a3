// Records and boxes of a leaf (stage `align`), one triangle in each block of 128 bits, and the copies of `sort`.

#if defined(CRUMPLE_CPU_SIMD_BUILD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BUILD_INL_H_
#undef CRUMPLE_CPU_SIMD_BUILD_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BUILD_INL_H_
#endif

#include <algorithm>
#include <limits>

#include "engine/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

/// Stores the record of each block, whose rows are X, Y, Z and I.
template <class D, class V>
HWY_INLINE void store_records(D d, V X, V Y, V Z, V I, Record* HWY_RESTRICT record) {
    auto* out = reinterpret_cast<float*>(record);
    constexpr std::size_t lanes = hn::MaxLanes(d);
    if constexpr (blocks == 4) transpose_blocks(d, X, Y, Z, I);
    if constexpr (blocks == 2) {
        // Columns of two blocks to two rows of four.
        const V a = hn::ConcatLowerLower(d, Y, X), a2 = hn::ConcatLowerLower(d, I, Z);
        const V b = hn::ConcatUpperUpper(d, Y, X), b2 = hn::ConcatUpperUpper(d, I, Z);
        X = a, Y = a2, Z = b, I = b2;
    }
    hn::StoreU(X, d, out);
    hn::StoreU(Y, d, out + lanes);
    hn::StoreU(Z, d, out + 2 * lanes);
    hn::StoreU(I, d, out + 3 * lanes);
}

/// The members of one vector that are big: rewritten one by one, and left out of the leaf's bounds.
template <class D, class V = hn::Vec<D>>
HWY_NOINLINE void build_big(D d, const RecordInput& in, std::int64_t first, V size, Record* record, Boxes& boxes,
                            V& low, V& high, V& reach, LeafBounds& bounds) {
    HWY_ALIGN float sizes[4 * blocks];
    HWY_ALIGN std::uint32_t small[4 * blocks];
    hn::Store(size, d, sizes);
    for (int b = 0; b < blocks; ++b) {
        const float far = std::max(sizes[4 * b], std::max(sizes[4 * b + 1], sizes[4 * b + 2]));
        const bool is_big = !(far <= in.frame.big);
        for (int lane = 0; lane < 4; ++lane) small[4 * b + lane] = is_big ? 0 : ~0u;
        const std::int64_t i = first + b;
        if (!is_big || i >= in.members) continue;
        const std::int32_t* corner = in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]);
        Vec3d p[3], relative[3];
        for (int v = 0; v < 3; ++v) {
            const auto row = 4 * static_cast<std::int64_t>(corner[v]);
            p[v] = in.points.f ? Vec3d{in.points.f[row], in.points.f[row + 1], in.points.f[row + 2]}
                               : Vec3d{in.points.d[row], in.points.d[row + 1], in.points.d[row + 2]};
            relative[v] = p[v] - Vec3d{in.frame.origin.x, in.frame.origin.y, in.frame.origin.z};
        }
        make_big(relative, p[1] - p[0], p[2] - p[0], far, record[i], boxes.low[static_cast<std::size_t>(i)],
                 boxes.high[static_cast<std::size_t>(i)]);
        bounds.reach = max(bounds.reach, 0x1p-28f * far);
        ++bounds.big;
    }
    const auto keep = hn::MaskFromVec(hn::BitCast(d, hn::Load(hn::RebindToUnsigned<D>(), small)));
    constexpr float most = std::numeric_limits<float>::max();
    low = hn::IfThenElse(keep, low, hn::Set(d, most));
    high = hn::IfThenElse(keep, high, hn::Set(d, -most));
    reach = hn::IfThenElseZero(keep, size);
}

template <class Points>
HWY_INLINE void build_from(const RecordInput& in, const Points& points, Record* HWY_RESTRICT record, Boxes& boxes,
                           LeafBounds& bounds) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    const auto axis = [&](int lane) HWY_ATTR {  // column of the rotation: what one coordinate adds to each axis
        HWY_ALIGN const float lanes[4] = {in.frame.axis[0][lane], in.frame.axis[1][lane], in.frame.axis[2][lane], 0};
        return hn::LoadDup128(d, lanes);
    };
    const V column_x = axis(0), column_y = axis(1), column_z = axis(2);
    const V big = hn::Set(d, in.frame.big), tiny = hn::Set(d, plane_slack);
    const auto turn = [&](V p) HWY_ATTR {
        return hn::MulAdd(column_x, hn::Broadcast<0>(p),
                          hn::MulAdd(column_y, hn::Broadcast<1>(p), hn::Mul(column_z, hn::Broadcast<2>(p))));
    };
    constexpr float most = std::numeric_limits<float>::max();
    HWY_ALIGN static constexpr std::uint32_t first_three[4] = {~0u, ~0u, ~0u, 0};
    const auto is_id =
        hn::MaskFromVec(hn::BitCast(d, hn::LoadDup128(hn::RebindToUnsigned<decltype(d)>(), first_three)));
    V least = hn::Set(d, most), greatest = hn::Set(d, -most), reach = hn::Zero(d);
    bounds.reach = 0;
    bounds.big = 0;
    // A row of four indices would end behind the array for its last triangle, so that one is copied.
    const std::int32_t* last = in.corners + 3 * (in.triangles - 1);
    const std::int32_t last_copy[4] = {last[0], last[1], last[2], 0};
    const auto corners_of = [&](std::int64_t i) { return in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]); };
    for (std::int64_t i = 0; i < in.members; i += blocks) {
        const std::int32_t* corner[blocks];
        for (int b = 0; b < blocks; ++b) {
            // Members lie anywhere in memory: corners are fetched ahead, and further ahead what names them.
            hwy::Prefetch(corners_of(i + b + 24));
            const std::int32_t* ahead = corners_of(i + b + 12);
            for (int k = 0; k < 3; ++k) hwy::Prefetch(points.row(ahead[k]));
            corner[b] = in.triangle[i + b] == in.triangles - 1 ? last_copy : corners_of(i + b);
        }
        const auto [q0, q1, q2, a, b] = points.corners(d, corner);

        const V t0 = turn(q0), t1 = turn(q1), t2 = turn(q2);
        V low = hn::Min(t0, hn::Min(t1, t2)), high = hn::Max(t0, hn::Max(t1, t2));
        hn::StoreU(low, d, &boxes.low[static_cast<std::size_t>(i)].x);
        hn::StoreU(high, d, &boxes.high[static_cast<std::size_t>(i)].x);

        // The plane, normalised by the sum of its products' magnitudes, in which the error bound is expressed.
        const V m1 = hn::Mul(a, rotate_axes(d, b)), m2 = hn::Mul(b, rotate_axes(d, a));
        const V sum = hn::Add(sum_of(hn::Add(hn::Abs(m1), hn::Abs(m2))), tiny);
        const V n = hn::Div(rotate_axes(d, hn::Sub(m1, m2)), sum);
        const V c = sum_of(hn::Mul(n, q0));

        const V x0x2 = hn::InterleaveLower(d, q0, q2), x1nx = hn::InterleaveLower(d, q1, n);
        const V X = hn::InterleaveLower(d, x0x2, x1nx), Y = hn::InterleaveUpper(d, x0x2, x1nx);
        const V Z = hn::InterleaveLower(d, hn::InterleaveUpper(d, q0, q2), hn::InterleaveUpper(d, q1, n));
        const auto ids =
            gather_blocks(di, [&](int k) HWY_ATTR { return hn::LoadU(hn::RebindToSigned<Four>(), corner[k]); });
        const V I = hn::IfThenElse(is_id, hn::BitCast(d, ids), c);
        store_records(d, X, Y, Z, I, record + i);

        V size = hn::Max(hn::Abs(q0), hn::Max(hn::Abs(q1), hn::Abs(q2)));
        if (HWY_UNLIKELY(!hn::AllTrue(d, hn::Le(size, big))))
            build_big(d, in, i, size, record, boxes, low, high, size, bounds);
        least = hn::Min(least, low);
        greatest = hn::Max(greatest, high);
        reach = hn::Max(reach, size);
    }
    HWY_ALIGN float lanes[3][4 * blocks];
    hn::Store(least, d, lanes[0]);
    hn::Store(greatest, d, lanes[1]);
    hn::Store(reach, d, lanes[2]);
    bounds.low = {most, most, most};
    bounds.high = {-most, -most, -most};
    for (int b = 0; b < blocks; ++b) {
        const auto block = [&](int k) { return Vec3f{lanes[k][4 * b], lanes[k][4 * b + 1], lanes[k][4 * b + 2]}; };
        bounds.low = min(bounds.low, block(0));
        bounds.high = max(bounds.high, block(1));
        bounds.reach = max(bounds.reach, largest(block(2)));
    }
}

inline void build(const RecordInput& in, Record* record, Boxes& boxes, LeafBounds& bounds) {
    if (in.points.f)
        build_from(in, Points32(in.points.f, in.frame.origin), record, boxes, bounds);
    else
        build_from(in, Points64(in.points.d, in.frame.origin), record, boxes, bounds);
}

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
        // Both in one lane, and x last: the rest lies as `sort` copies it.
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

inline void scatter(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted) {
    const hn::ScalableTag<float> d;
    // Last lanes of blocks are the plane; others, ids among them, stay what they are.
    HWY_ALIGN static constexpr std::uint32_t last_lane[4] = {0, 0, 0, ~0u};
    const auto is_plane =
        hn::MaskFromVec(hn::BitCast(d, hn::LoadDup128(hn::RebindToUnsigned<decltype(d)>(), last_lane)));
    const auto factor = hn::Set(d, scale);
    for (std::int64_t i = 0; i < n; ++i) {
        const auto* in = reinterpret_cast<const float*>(record + i);
        auto* out = reinterpret_cast<float*>(sorted + position[i]);
        for (int lane = 0; lane < 16; lane += 4 * blocks) {
            const auto v = hn::Load(d, in + lane);
            hn::Store(hn::IfThenElse(is_plane, hn::Mul(v, factor), v), d, out + lane);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
