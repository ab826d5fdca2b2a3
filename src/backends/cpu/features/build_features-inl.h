// Records and boxes of the members of a leaf (small set of triangles that one sweep searches), one triangle in each
// block of 128 bits of a vector: SIMD versions (counterparts) of the functions in filters/features/feature_record.h.
// Integer template arguments are the number of time samples: 1 for static scenes, 2 for motion.

#if defined(CRUMPLE_FEATURES_CPU_BUILD_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_BUILD_INL_H_
#undef CRUMPLE_FEATURES_CPU_BUILD_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_BUILD_INL_H_
#endif

#include "backends/cpu/features/feature_member.h"
#include "backends/cpu/simd/boxes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

/// Counterpart of direction(), for one vector in each block.
template <class D, class V>
HWY_INLINE V direction(D d, V v) {
    const V one = hn::Set(d, 1.0f), size = largest_of(hn::Abs(v));
    const V w = hn::Mul(hn::Div(one, size), v);
    const V n = hn::Mul(hn::Div(one, hn::Sqrt(sum_of(hn::Mul(w, w)))), w);
    return hn::IfThenElseZero(hn::Gt(size, hn::Set(d, 1e-30f)), n);
}

/// Computes the geometry of records at one time sample: rows X, Y and Z, each of three corners and the normal.
template <class D, class V>
HWY_INLINE void geometry_rows(D d, const LocalCorners<V>& c, V& X, V& Y, V& Z) {
    const V across = hn::Sub(hn::Mul(c.a, rotate_axes(d, c.b)), hn::Mul(c.b, rotate_axes(d, c.a)));
    const V n = direction(d, rotate_axes(d, across));
    const V x0x2 = hn::InterleaveLower(d, c.q0, c.q2), x1nx = hn::InterleaveLower(d, c.q1, n);
    X = hn::InterleaveLower(d, x0x2, x1nx);
    Y = hn::InterleaveUpper(d, x0x2, x1nx);
    Z = hn::InterleaveLower(d, hn::InterleaveUpper(d, c.q0, c.q2), hn::InterleaveUpper(d, c.q1, n));
}

/// Returns the corners at `time`, in [0, 1], interpolated between start and end. Each coordinate errs by at most 8 u
/// times the largest |coordinate| of `start` and of the result, including the errors of the inputs (docs/features.md).
template <class D, class V>
HWY_INLINE LocalCorners<V> corners_between(D d, const LocalCorners<V>& start, const LocalCorners<V>& end, float time) {
    const V t = hn::Set(d, time);
    const auto at = [&](V p, V q) HWY_ATTR { return hn::MulAdd(t, hn::Sub(q, p), p); };
    return {at(start.q0, end.q0), at(start.q1, end.q1), at(start.q2, end.q2), at(start.a, end.a), at(start.b, end.b)};
}

/// Inflation of the box of each block's member.
template <int moments>
class Widenings {
   public:
    explicit Widenings(const BuildInput& in) : in_(in), same_(!in.inflation.radius && in.inflation.path_share == 0) {}

    template <class D>
    HWY_INLINE hn::Vec<D> operator()(D d, std::int64_t i) const {
        if (HWY_LIKELY(same_)) return hn::Set(d, in_.inflation(0));
        return gather_blocks(d, [&](int b) HWY_ATTR {
            Vec3d p[3 * moments];
            corners_of<moments>(in_, in_.triangle[i + b], p);
            return hn::Set(Four(), widening<moments>(in_, in_.triangle[i + b], p));
        });
    }

   private:
    const BuildInput& in_;
    bool same_;
};

template <int moments, class Points>
HWY_INLINE void build_from(const BuildInput& in, const Points& start, const Points& end, const SceneFeatures& features,
                           FeatureRecord<moments>* HWY_RESTRICT record, Boxes& boxes, LeafBounds& bounds) {
    const hn::ScalableTag<float> d;
    using V = hn::Vec<decltype(d)>;
    BoxLanes lanes(in.frame);
    const Widenings<moments> widenings(in);
    bounds = {};
    const auto corners_at = [&](std::int64_t i) { return in.corners + 3 * std::int64_t{in.triangle[i]}; };
    const auto rewrite_big = [&](std::int64_t i) {
        Vec3d p[3 * moments];
        corners_of<moments>(in, in.triangle[i], p);
        const auto member = widened<moments>(in, in.triangle[i], p);
        write_geometry<moments>(p, member, record[i]);
        boxes.low[static_cast<std::size_t>(i)] = {member.low.x, member.low.y, member.low.z, 0};
        boxes.high[static_cast<std::size_t>(i)] = {member.high.x, member.high.y, member.high.z, 0};
        bounds.reach = max(bounds.reach, member.counted_extent());
    };
    for (std::int64_t i = 0; i < in.members; i += blocks) {
        const std::int32_t* corner[blocks];
        for (int b = 0; b < blocks; ++b) {
            // Members are scattered in memory: prefetches the vertices of later members, and the indices of still later
            // ones.
            hwy::Prefetch(corners_at(i + b + 24));
            hwy::Prefetch(&features.edges_of(in.triangle[i + b + 24]));
            const std::int32_t* ahead = corners_at(i + b + 12);
            for (int k = 0; k < 3; ++k) {
                hwy::Prefetch(start.row(ahead[k]));
                if constexpr (moments == 2) hwy::Prefetch(end.row(ahead[k]));
            }
            corner[b] = corners_at(i + b);
        }
        BoxLanes::Box box{hn::Set(d, LeafBounds::most), hn::Set(d, -LeafBounds::most)};
        V size = hn::Zero(d), row[8] = {};
        const auto add_time_sample = [&](const LocalCorners<V>& c, int m) HWY_ATTR {
            const V t0 = lanes.turn(c.q0), t1 = lanes.turn(c.q1), t2 = lanes.turn(c.q2);
            box.low = hn::Min(box.low, hn::Min(t0, hn::Min(t1, t2)));
            box.high = hn::Max(box.high, hn::Max(t0, hn::Max(t1, t2)));
            size = hn::Max(size, hn::Max(hn::Abs(c.q0), hn::Max(hn::Abs(c.q1), hn::Abs(c.q2))));
            geometry_rows(d, c, row[m], row[moments + m], row[2 * moments + m]);
        };
        const LocalCorners<V> first = start.corners(d, corner);
        add_time_sample(first, 0);
        V more = widenings(d, i);
        if constexpr (moments == 2) {
            const LocalCorners<V> last = end.corners(d, corner);
            if (HWY_LIKELY(in.until == 1)) {
                add_time_sample(last, 1);
            } else {
                add_time_sample(corners_between(d, first, last, in.until), 1);
                more = hn::MulAdd(hn::Set(d, 24 * unit_roundoff), largest_of(size), more);
            }
        }
        box.low = hn::Sub(box.low, more);
        box.high = hn::Add(box.high, more);
        lanes.store(box, i, boxes);

        float* out[blocks];
        for (int b = 0; b < blocks; ++b) out[b] = reinterpret_cast<float*>(record + i + b);
        store_rows(d, row[0], row[1], row[2], row[3], out);
        if constexpr (moments == 2) {
            for (float*& to : out) to += 16;
            store_rows(d, row[4], row[5], row[6], row[7], out);
        }
        // Overwrites the end of each record, where store_rows() has stored unused rows.
        for (int b = 0; b < blocks; ++b) write_feature_ids(in, in.triangle[i + b], features, record[i + b]);

        if (lanes.any_big(size)) {
            lanes.replace_big(in, i, box, size, boxes, bounds, rewrite_big);
            more = hn::IfThenElseZero(hn::Le(box.low, box.high),
                                      more);  // boxes of big members (geometry/leaf_frame.h) are empty by now
        }
        lanes.count(box, hn::Add(size, more));
    }
    lanes.finish(bounds);
}

template <int moments>
void build(const BuildInput& in, const SceneFeatures& features, FeatureRecord<moments>* record, Boxes& boxes,
           LeafBounds& bounds) {
    const Vec3f start = origin_at<moments>(in, 0), end = origin_at<moments>(in, 1);
    if (in.points.f) {
        const float* rows = in.points.f;
        build_from(in, Points32(rows, start), Points32(rows + 4 * in.ends, end), features, record, boxes, bounds);
    } else {
        const double* rows = in.points.d;
        build_from(in, Points64(rows, start), Points64(rows + 4 * in.ends, end), features, record, boxes, bounds);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
