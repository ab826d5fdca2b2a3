// Loads records of triangles (filters/intersection/triangle_record.h), in any order, into vectors, for the filters of
// stage `narrow`.

#if defined(CRUMPLE_INTERSECT_CPU_RECORDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_INTERSECT_CPU_RECORDS_INL_H_
#undef CRUMPLE_INTERSECT_CPU_RECORDS_INL_H_
#else
#define CRUMPLE_INTERSECT_CPU_RECORDS_INL_H_
#endif

#include "backends/cpu/simd/corners-inl.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::intersect {
namespace HWY_NAMESPACE {
using namespace cpu::HWY_NAMESPACE;  // helpers shared with the stages

/// Loads record *record(b) into block b, transposed: X = x0 x1 x2 nx | ..., I = id0 id1 id2 c | ... Halves of vectors
/// are combined while loading, which saves shuffles that the filters would have to wait for.
template <class D, class RecordOf, class V>
HWY_INLINE void load_records(D d, RecordOf record, V& X, V& Y, V& Z, V& I) {
    const auto at = [&](int b) { return reinterpret_cast<const float*>(record(b)); };
    if constexpr (blocks == 1) {
        X = hn::Load(d, at(0)), Y = hn::Load(d, at(0) + 4), Z = hn::Load(d, at(0) + 8), I = hn::Load(d, at(0) + 12);
    } else {
        const hn::Half<D> half;
        const auto join = [&](int b, int lane) HWY_ATTR {
            return hn::Combine(d, hn::Load(half, at(b + 1) + lane), hn::Load(half, at(b) + lane));
        };
        if constexpr (blocks == 2) {
            X = join(0, 0), Y = join(0, 4), Z = join(0, 8), I = join(0, 12);
        } else {
            const V xy0 = join(0, 0), xy2 = join(2, 0), zi0 = join(0, 8), zi2 = join(2, 8);
            X = even_blocks(xy0, xy2), Y = odd_blocks(xy0, xy2), Z = even_blocks(zi0, zi2), I = odd_blocks(zi0, zi2);
        }
    }
}

/// Vector of triangles, one per lane.
template <class D>
struct Triangles {
    using V = hn::Vec<D>;
    Point<V> corner[3], normal;
    hn::Vec<hn::RebindToSigned<D>> id[3];

    /// Returns corner `which` of each lane.
    HWY_INLINE Point<V> at(hn::Vec<hn::RebindToSigned<D>> which) const {
        const D d;
        const hn::RebindToSigned<D> di;
        const auto first = hn::RebindMask(d, hn::Eq(which, hn::Zero(di)));
        const auto second = hn::RebindMask(d, hn::Eq(which, hn::Set(di, 1)));
        const auto pick = [&](V a, V b, V c)
                              HWY_ATTR { return hn::IfThenElse(first, a, hn::IfThenElse(second, b, c)); };
        return {pick(corner[0].x, corner[1].x, corner[2].x), pick(corner[0].y, corner[1].y, corner[2].y),
                pick(corner[0].z, corner[1].z, corner[2].z)};
    }
};

/// Loads the triangle of *record(lane) into each lane, by four loads of blocks and a transpose. A gather would fetch
/// each number by itself.
template <class D, class RecordOf>
HWY_INLINE Triangles<D> load_triangles(D d, RecordOf record) {
    using V = hn::Vec<D>;
    V X[4], Y[4], Z[4], I[4];
    for (int r = 0; r < 4; ++r) {
        const auto of_block = [&](int b) { return record(4 * b + r); };
        load_records(d, of_block, X[r], Y[r], Z[r], I[r]);
    }
    Triangles<D> t;
    V id[3], plane;
    transpose_rows(d, I, id[0], id[1], id[2], plane);
    for (int k = 0; k < 3; ++k) t.id[k] = hn::BitCast(hn::RebindToSigned<D>(), id[k]);
    transpose_rows(d, X, t.corner[0].x, t.corner[1].x, t.corner[2].x, t.normal.x);
    transpose_rows(d, Y, t.corner[0].y, t.corner[1].y, t.corner[2].y, t.normal.y);
    transpose_rows(d, Z, t.corner[0].z, t.corner[1].z, t.corner[2].z, t.normal.z);
    return t;
}

/// Loads triangles like load_triangles(), but with corners from normalised float32 rows, which are exact.
template <class D, class RecordOf>
HWY_INLINE Triangles<D> load_exact_triangles(D d, RecordOf record, const float* points) {
    using V = hn::Vec<D>;
    Triangles<D> t = load_triangles(d, record);  // provides normals and ids
    for (int k = 0; k < 3; ++k) {
        V row[4], unused;
        for (int r = 0; r < 4; ++r)
            row[r] = gather_blocks(d, [&](int b) HWY_ATTR {
                return hn::Load(Four(), points + 4 * static_cast<std::int64_t>(record(4 * b + r)->id[k]));
            });
        transpose_rows(d, row, t.corner[k].x, t.corner[k].y, t.corner[k].z, unused);
    }
    return t;
}

/// Calls test(difference_error, triangles_of), where triangles_of(record_of) loads a vector of triangles, that of lane
/// i from *record_of(i), with the best corners available: from the normalised rows if these are float32, and so exact,
/// otherwise from the records. Each coordinate of a difference of two corners errs by at most `difference_error` beyond
/// its own rounding. `reach`: the largest |coordinate| of a corner in the leaf, the set of triangles that one sweep
/// searches.
template <class Test>
HWY_INLINE void with_triangles(const PointRows& points, float reach, Test test) {
    const hn::ScalableTag<float> d;
    if (points.f)
        test(0.0f, [&](auto record) HWY_ATTR { return load_exact_triangles(d, record, points.f); });
    else
        test(corner_error(reach), [&](auto record) HWY_ATTR { return load_triangles(d, record); });
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::intersect
HWY_AFTER_NAMESPACE();

#endif
