// Kernels of intersection queries that compute the records and boxes of the members of a leaf (small set of triangles
// that one sweep searches), with one triangle in each block of 128 bits of a vector, and that copy records to their
// rows.

#if defined(CRUMPLE_INTERSECT_CPU_BUILD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_BUILD_INL_H_
#undef CRUMPLE_INTERSECT_CPU_BUILD_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_BUILD_INL_H_
#endif

#include "backends/cpu/simd/boxes-inl.h"
#include "filters/intersection/triangle_record.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

/// Rewrites the record of a big member (geometry/leaf_frame.h): its plane is computed in float64, its corners are NaN.
HWY_INLINE void rewrite_big(const BuildInput& in, std::int64_t i, Record& record) {
    const std::int32_t* corner = in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]);
    const Vec3d origin{in.frame.origin.x, in.frame.origin.y, in.frame.origin.z};
    Vec3d p[3], relative[3];
    for (int k = 0; k < 3; ++k) {
        p[k] = in.points[corner[k]];
        relative[k] = p[k] - origin;
    }
    make_big(relative, p[1] - p[0], p[2] - p[0], record);
}

template <class Points>
HWY_INLINE void build_from(const BuildInput& in, const Points& points, Record* HWY_RESTRICT record, Boxes& boxes,
                           LeafBounds& bounds) {
    const hn::ScalableTag<float> d;
    const hn::RebindToSigned<decltype(d)> di;
    using V = hn::Vec<decltype(d)>;
    BoxLanes lanes(in.frame);
    const V tiny = hn::Set(d, plane_slack);
    HWY_ALIGN static constexpr std::uint32_t first_three[4] = {~0u, ~0u, ~0u, 0};
    const auto is_id =
        hn::MaskFromVec(hn::BitCast(d, hn::LoadDup128(hn::RebindToUnsigned<decltype(d)>(), first_three)));
    bounds = {};
    // For the last triangle, a load of four indices would end past the array, so its indices are copied.
    const std::int32_t* last = in.corners + 3 * (in.triangles - 1);
    const std::int32_t last_copy[4] = {last[0], last[1], last[2], 0};
    const auto corners_of = [&](std::int64_t i) { return in.corners + 3 * static_cast<std::int64_t>(in.triangle[i]); };
    for (std::int64_t i = 0; i < in.members; i += blocks) {
        const std::int32_t* corner[blocks];
        for (int b = 0; b < blocks; ++b) {
            // Members are scattered in memory: prefetches the corners of later members, and the indices of still later
            // ones.
            hwy::Prefetch(corners_of(i + b + 24));
            const std::int32_t* ahead = corners_of(i + b + 12);
            for (int k = 0; k < 3; ++k) hwy::Prefetch(points.row(ahead[k]));
            corner[b] = in.triangle[i + b] == in.triangles - 1 ? last_copy : corners_of(i + b);
        }
        const auto [q0, q1, q2, a, b] = points.corners(d, corner);

        const V t0 = lanes.turn(q0), t1 = lanes.turn(q1), t2 = lanes.turn(q2);
        BoxLanes::Box box{hn::Min(t0, hn::Min(t1, t2)), hn::Max(t0, hn::Max(t1, t2))};
        lanes.store(box, i, boxes);

        // The plane n . p = c, divided by the sum of the magnitudes of the normal's products: the error bound is
        // relative to this sum.
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
        float* out[blocks];
        for (int k = 0; k < blocks; ++k) out[k] = reinterpret_cast<float*>(record + i + k);
        store_rows(d, X, Y, Z, I, out);

        V size = hn::Max(hn::Abs(q0), hn::Max(hn::Abs(q1), hn::Abs(q2)));
        if (lanes.any_big(size))
            lanes.replace_big(in, i, box, size, boxes, bounds,
                              [&](std::int64_t member) { rewrite_big(in, member, record[member]); });
        lanes.count(box, size);
    }
    lanes.finish(bounds);
}

inline void build(const BuildInput& in, Record* record, Boxes& boxes, LeafBounds& bounds) {
    if (in.points.f)
        build_from(in, Points32(in.points.f, in.frame.origin), record, boxes, bounds);
    else
        build_from(in, Points64(in.points.d, in.frame.origin), record, boxes, bounds);
}

inline void scatter(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted) {
    const hn::ScalableTag<float> d;
    // A record has four blocks of four lanes. The last lanes of all blocks are the plane, which is scaled; other lanes,
    // ids among them, stay unchanged.
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
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
