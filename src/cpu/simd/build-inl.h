// Records and boxes of a leaf (stage `align`), and the two copies of `sort`: one triangle at a time in vectors of four,
// (x, y, z, -), whatever the instruction set, because corners come from scattered rows.

#if defined(CRUMPLE_CPU_SIMD_BUILD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_BUILD_INL_H_
#undef CRUMPLE_CPU_SIMD_BUILD_INL_H_
#else
#define CRUMPLE_CPU_SIMD_BUILD_INL_H_
#endif

#include <limits>

#include "cpu/big.h"
#include "cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

template <class Points, class Origin>
HWY_INLINE void build_from(const RecordInput& in, const Points& points, const Origin& origin,
                           Record* HWY_RESTRICT record, Box* HWY_RESTRICT box, LeafBounds& bounds) {
    const Four d;
    const auto axis = [&](int lane) {  // column of the rotation: what one coordinate adds to each axis
        const float lanes[4] = {in.frame.axis[0][lane], in.frame.axis[1][lane], in.frame.axis[2][lane], 0};
        return hn::LoadU(d, lanes);
    };
    const V4 column_x = axis(0), column_y = axis(1), column_z = axis(2);
    const V4 big = hn::Set(d, in.frame.big), tiny = hn::Set(d, 1e-30f);
    const auto turn = [&](V4 p) {
        return hn::MulAdd(column_x, hn::Broadcast<0>(p),
                          hn::MulAdd(column_y, hn::Broadcast<1>(p), hn::Mul(column_z, hn::Broadcast<2>(p))));
    };
    constexpr float most = std::numeric_limits<float>::max();
    V4 least = hn::Set(d, most), greatest = hn::Set(d, -most), reach = hn::Zero(d);
    int bigs = 0;
    const auto corners_of = [&](std::int64_t i) {
        return in.corners + 3 * static_cast<std::int64_t>(in.triangle[i < in.members ? i : in.members - 1]);
    };
    for (std::int64_t i = 0; i < in.members; ++i) {
        // Members lie anywhere in memory: corners are fetched ahead, and further ahead what names them.
        hwy::Prefetch(corners_of(i + 24));
        const std::int32_t* ahead = corners_of(i + 12);
        for (int k = 0; k < 3; ++k) points.prefetch(ahead[k]);
        const std::int32_t* corner = corners_of(i);
        const auto p0 = points.load(corner[0]), p1 = points.load(corner[1]), p2 = points.load(corner[2]);
        const V4 q0 = Points::difference(p0, origin), q1 = Points::difference(p1, origin),
                 q2 = Points::difference(p2, origin);
        const V4 a = Points::difference(p1, p0), b = Points::difference(p2, p0);

        const V4 t0 = turn(q0), t1 = turn(q1), t2 = turn(q2);
        const V4 low = hn::Min(t0, hn::Min(t1, t2)), high = hn::Max(t0, hn::Max(t1, t2));
        hn::Store(low, d, box[i].low);
        hn::Store(high, d, box[i].high);

        // The plane, normalised by the sum of its products' magnitudes, in which the error bound is expressed.
        const V4 m1 = hn::Mul(a, rotate_axes(b)), m2 = hn::Mul(b, rotate_axes(a));
        const V4 sum = hn::Add(sum_of(hn::Add(hn::Abs(m1), hn::Abs(m2))), tiny);
        const V4 n = hn::Div(rotate_axes(hn::Sub(m1, m2)), sum);
        const V4 c = sum_of(hn::Mul(n, q0));

        const V4 x0x2 = hn::InterleaveLower(d, q0, q2), x1nx = hn::InterleaveLower(d, q1, n);
        Record& out = record[i];
        hn::Store(hn::InterleaveLower(d, x0x2, x1nx), d, out.x);
        hn::Store(hn::InterleaveUpper(d, x0x2, x1nx), d, out.y);
        hn::Store(hn::InterleaveLower(d, hn::InterleaveUpper(d, q0, q2), hn::InterleaveUpper(d, q1, n)), d, out.z);
        out.id[0] = corner[0];
        out.id[1] = corner[1];
        out.id[2] = corner[2];
        out.c = hn::GetLane(c);

        const V4 size = hn::Max(hn::Abs(q0), hn::Max(hn::Abs(q1), hn::Abs(q2)));
        if (HWY_LIKELY(hn::AllTrue(d, hn::Le(size, big)))) {
            least = hn::Min(least, low);
            greatest = hn::Max(greatest, high);
            reach = hn::Max(reach, size);
        } else {
            Vec3d relative[3];
            const auto exact = [&](std::int32_t vertex, int k) {
                const auto at = 4 * static_cast<std::int64_t>(vertex) + k;
                return in.points.f ? static_cast<double>(in.points.f[at]) : in.points.d[at];
            };
            Vec3d p[3];
            for (int v = 0; v < 3; ++v) {
                p[v] = {exact(corner[v], 0), exact(corner[v], 1), exact(corner[v], 2)};
                relative[v] = p[v] - Vec3d{in.frame.origin.x, in.frame.origin.y, in.frame.origin.z};
            }
            const float far = hn::GetLane(hn::MaxOfLanes(d, size));
            make_big(relative, p[1] - p[0], p[2] - p[0], far, out, box[i]);
            reach = hn::Max(reach, hn::Set(d, 0x1p-28f * far));
            ++bigs;
        }
    }
    HWY_ALIGN float lanes[3][4];
    hn::Store(least, d, lanes[0]);
    hn::Store(greatest, d, lanes[1]);
    hn::Store(reach, d, lanes[2]);
    bounds.low = {lanes[0][0], lanes[0][1], lanes[0][2]};
    bounds.high = {lanes[1][0], lanes[1][1], lanes[1][2]};
    bounds.reach = largest(Vec3f{lanes[2][0], lanes[2][1], lanes[2][2]});
    bounds.big = bigs;
}

inline void build(const RecordInput& in, Record* record, Box* box, LeafBounds& bounds) {
    if (in.points.f) {
        build_from(in, Points32{in.points.f}, Points32::origin(in.frame.origin), record, box, bounds);
    } else {
        const double origin[4] = {in.frame.origin.x, in.frame.origin.y, in.frame.origin.z, 0};
        build_from(in, Points64{in.points.d}, Points64::Row{origin}, record, box, bounds);
    }
}

inline void quantise(const Box* box, std::int64_t n, const float base_low[4], const float base_high[4],
                     const float scale[4], QuantisedBox* out) {
    const Four d;
    const hn::RebindToSigned<Four> di;
    const hn::Rebind<std::uint16_t, Four> d16;
    const V4 low = hn::LoadU(d, base_low), high = hn::LoadU(d, base_high), factor = hn::LoadU(d, scale),
             most = hn::Set(d, 65534.0f), zero = hn::Zero(d);
    const auto to_16_bits = [&](V4 value, V4 base) {
        const V4 clamped = hn::Min(hn::Max(hn::Mul(hn::Sub(value, base), factor), zero), most);
        return hn::DemoteTo(d16, hn::ConvertTo(di, clamped));
    };
    for (std::int64_t i = 0; i < n; ++i) {
        hn::StoreU(to_16_bits(hn::Load(d, box[i].low), low), d16, out[i].low);
        hn::StoreU(to_16_bits(hn::Load(d, box[i].high), high), d16, out[i].high);
    }
}

inline void scatter(const Record* record, std::int64_t n, const std::int32_t* position, float scale, Record* sorted) {
    const Four d;
    const float lanes[4] = {1, 1, 1, scale};
    const V4 factor = hn::LoadU(d, lanes);
    for (std::int64_t i = 0; i < n; ++i) {
        const Record& in = record[i];
        Record& out = sorted[position[i]];
        hn::Store(hn::Mul(hn::Load(d, in.x), factor), d, out.x);
        hn::Store(hn::Mul(hn::Load(d, in.y), factor), d, out.y);
        hn::Store(hn::Mul(hn::Load(d, in.z), factor), d, out.z);
        // Ids are no numbers: as floats most would be subnormal, and slow.
        out.id[0] = in.id[0];
        out.id[1] = in.id[1];
        out.id[2] = in.id[2];
        out.c = in.c * scale;
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
