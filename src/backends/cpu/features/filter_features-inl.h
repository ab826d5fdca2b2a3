// SIMD versions (counterparts) of the functions in filters/features/feature_filters.h, where the computations are
// explained: they drop tests of features that are certainly too far apart, one test per lane. Integer template
// arguments are the number of time samples: 1 for static scenes, 2 for motion.

#if defined(CRUMPLE_FEATURES_CPU_FILTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_FEATURES_CPU_FILTER_INL_H_
#undef CRUMPLE_FEATURES_CPU_FILTER_INL_H_
#else
#define CRUMPLE_FEATURES_CPU_FILTER_INL_H_
#endif

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/features/vectors-inl.h"
#include "filters/features/feature_filters.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu::features {
namespace HWY_NAMESPACE {

/// Counterpart of FeatureVectors for one test per lane.
template <class V, int moments>
struct Seen {
    Point<V> to[moments][3];

    /// Returns bounds on the |components| of vector i at all times.
    HWY_INLINE Point<V> reach(int i) const {
        if constexpr (moments == 1)
            return abs(to[0][i]);
        else
            return max(abs(to[0][i]), abs(to[1][i]));
    }
};

/// Return the difference of two rows, rounded once: float64 rows are rounded after the subtraction.
HWY_INLINE V4 row_difference(const Points32& points, std::int64_t to, std::int64_t from) {
    return hn::Sub(hn::Load(Four(), points.rows + 4 * to), hn::Load(Four(), points.rows + 4 * from));
}
HWY_INLINE V4 row_difference(const Points64& points, std::int64_t to, std::int64_t from) {
    return Points64::difference(points.rows + 4 * to, points.rows + 4 * from);
}

template <int moments, class D, class Points, class V = hn::Vec<D>>
HWY_INLINE void load_vectors(D d, const Points& points, std::int64_t ends, const std::int32_t* const* vertices,
                             Seen<V, moments>& seen) {
    for (int m = 0; m < moments; ++m)
        for (int k = 0; k < 3; ++k) {
            V row[4], unused;
            for (int r = 0; r < 4; ++r)
                row[r] = gather_blocks(d, [&](int b) HWY_ATTR {
                    const std::int32_t* vertex = vertices[4 * b + r];
                    return row_difference(points, vertex[k + 1] + m * ends, vertex[0] + m * ends);
                });
            transpose_rows(d, row, seen.to[m][k].x, seen.to[m][k].y, seen.to[m][k].z, unused);
        }
}

/// Computes in which lanes the second feature lies above, or below, the first one by more than `gap` along n, at one
/// time sample. `to`: vectors from the first point to the others.
template <FeatureKind kind, class V, class M = decltype(hn::Gt(V(), V()))>
HWY_INLINE void compare_places(const Point<V>& n, const Point<V> (&to)[3], V gap, M& above, M& below) {
    const V p0 = dot(n, to[0]), p1 = dot(n, to[1]), p2 = dot(n, to[2]);
    if constexpr (kind == FeatureKind::vertex_face) {
        above = hn::Gt(least(p0, p1, p2), gap);
        below = hn::Lt(greatest(p0, p1, p2), hn::Neg(gap));
    } else {
        const V zero = hn::Zero(hn::DFromV<V>());
        above = hn::Gt(hn::Min(p1, p2), hn::Add(hn::Max(p0, zero), gap));
        below = hn::Lt(hn::Max(p1, p2), hn::Sub(hn::Min(p0, zero), gap));
    }
}

/// Counterpart of separates() for one test per lane.
template <FeatureKind kind, int moments, class V>
HWY_INLINE auto separates(const Point<V>& n, const Seen<V, moments>& seen, const Point<V>& reach, V distance) {
    const hn::DFromV<V> d;
    const V gap = hn::Add(hn::MulAdd(hn::Set(d, place_error), dot(abs(n), reach), hn::Set(d, place_slack)),
                          hn::Mul(distance, length(n)));
    decltype(hn::Gt(gap, gap)) above, below;
    compare_places<kind>(n, seen.to[0], gap, above, below);
    if constexpr (moments == 2) {
        auto above_end = above, below_end = below;
        compare_places<kind>(n, seen.to[1], gap, above_end, below_end);
        above = hn::And(above, above_end);
        below = hn::And(below, below_end);
    }
    return hn::Or(above, below);
}

template <FeatureKind kind, class V>
HWY_INLINE Point<V> between_middles(const Point<V> (&to)[3]) {
    if constexpr (kind == FeatureKind::vertex_face)
        return add(add(to[0], to[1]), to[2]);
    else
        return subtract(add(to[1], to[2]), to[0]);
}

/// Counterpart of most_at_start() for one test per lane.
template <FeatureKind kind, class V, int moments>
HWY_INLINE V most_at_start(const Seen<V, moments>& seen) {
    const hn::DFromV<V> d;
    const Point<V>(&to)[3] = seen.to[0];
    const auto square = [](const Point<V>& v) HWY_ATTR { return dot(v, v); };
    V least = hn::Min(square(to[1]), square(to[2]));
    if constexpr (kind == FeatureKind::vertex_face)
        least = hn::Min(least, square(to[0]));
    else
        least = hn::Min(least, hn::Min(square(subtract(to[1], to[0])), square(subtract(to[2], to[0]))));
    const float share = kind == FeatureKind::vertex_face ? 1.0f / 3 : 0.5f;
    least = hn::Min(least, hn::Mul(hn::Set(d, share * share), square(between_middles<kind>(to))));
    const Point<V> all = add(add(abs(to[0]), abs(to[1])), abs(to[2]));
    const V errors = hn::Mul(hn::Set(d, 8 * unit_roundoff), hn::Add(hn::Add(all.x, all.y), all.z));
    return hn::MulAdd(hn::Sqrt(hn::Add(least, hn::Set(d, least_square))), hn::Set(d, up), errors);
}

/// Counterparts of first_edge() and second_edge() for one test per lane.
template <FeatureKind kind, class V>
HWY_INLINE Point<V> first_edge(const Point<V> (&to)[3]) {
    if constexpr (kind == FeatureKind::vertex_face)
        return subtract(to[1], to[0]);
    else
        return to[0];
}
template <FeatureKind kind, class V>
HWY_INLINE Point<V> second_edge(const Point<V> (&to)[3]) {
    return subtract(to[2], to[kind == FeatureKind::vertex_face ? 0 : 1]);
}

template <class V>
HWY_INLINE V volume_bound(V magnitude) {
    const hn::DFromV<V> d;
    return hn::MulAdd(hn::Set(d, volume_error), magnitude, hn::Set(d, volume_slack));
}

/// Counterpart of never_in_a_plane() for one test per lane.
template <class V>
HWY_INLINE auto never_in_a_plane(const Seen<V, 2>& seen, V magnitude) {
    const hn::DFromV<V> d;
    const Point<V>(&p)[3] = seen.to[0], (&q)[3] = seen.to[1];
    const Point<V> start = cross(p[0], p[1]), end = cross(q[0], q[1]);
    const Point<V> mixed = add(cross(p[0], q[1]), cross(q[0], p[1]));
    const V b0 = dot(start, p[2]), b3 = dot(end, q[2]), third = hn::Set(d, 1.0f / 3);
    const V b1 = hn::Add(dot(start, q[2]), dot(mixed, p[2])), b2 = hn::Add(dot(end, p[2]), dot(mixed, q[2]));
    const V bound = volume_bound(magnitude);
    const V low = hn::Min(hn::Min(b0, b3), hn::Mul(hn::Min(b1, b2), third));
    const V high = hn::Max(hn::Max(b0, b3), hn::Mul(hn::Max(b1, b2), third));
    return hn::Or(hn::Gt(low, bound), hn::Lt(high, hn::Neg(bound)));
}

/// Counterpart of plane_is_far() for one test per lane.
template <FeatureKind kind, class V>
HWY_INLINE auto plane_is_far(const Seen<V, 1>& seen, V magnitude, V distance) {
    constexpr bool face = kind == FeatureKind::vertex_face;
    const hn::DFromV<V> d;
    const Point<V>(&p)[3] = seen.to[0];
    const Point<V> a = first_edge<kind>(p), b = second_edge<kind>(p);
    const Point<V> extent_a = face ? add(abs(p[0]), abs(p[1])) : abs(p[0]);
    const Point<V> extent_b = face ? add(abs(p[0]), abs(p[2])) : add(abs(p[1]), abs(p[2]));
    const Point<V> n = cross(a, b), off = product_magnitudes(extent_a, extent_b);
    const V most = hn::Add(hn::MulAdd(hn::Set(d, up), length(n), hn::Set(d, volume_slack)),
                           hn::Mul(hn::Set(d, normal_error), hn::Add(hn::Add(off.x, off.y), off.z)));
    return hn::Gt(hn::Abs(dot(cross(p[0], p[1]), p[2])), hn::MulAdd(distance, most, volume_bound(magnitude)));
}

/// Input of the filters, one test per lane.
template <class V, int moments>
struct TestBatch {
    Seen<V, moments> seen;
    Point<V> reach;  ///< sum of seen.reach(i) over the three vectors
    V magnitude;     ///< bound on the sum of the magnitudes of the monomials of the vectors' determinant
    V asked;         ///< requested distance, times `up`, which covers roundings
};

/// Counterpart of surely_far_coarse() for one test per lane.
template <FeatureKind kind, int moments, class V>
HWY_INLINE auto surely_far_coarse(const TestBatch<V, moments>& tests, bool contact) {
    const auto& [seen, reach, magnitude, distance] = tests;
    const hn::DFromV<V> d;
    const V zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    auto far = hn::Gt(zero, zero);
    Point<V> way = between_middles<kind>(seen.to[0]);
    if constexpr (moments == 1) {
        far = plane_is_far<kind>(seen, magnitude, distance);
    } else {
        if (contact) far = never_in_a_plane(seen, magnitude);
        way = add(way, between_middles<kind>(seen.to[1]));
    }
    far = hn::Or(far, separates<kind>(way, seen, reach, distance));
    far = hn::Or(far, separates<kind>(Point<V>{one, zero, zero}, seen, reach, distance));
    far = hn::Or(far, separates<kind>(Point<V>{zero, one, zero}, seen, reach, distance));
    return hn::Or(far, separates<kind>(Point<V>{zero, zero, one}, seen, reach, distance));
}

/// Counterpart of beside() for one edge per lane.
template <class V>
HWY_INLINE Point<V> beside(const Point<V>& way, const Point<V>& edge) {
    const V square = dot(edge, edge), along = dot(way, edge);
    return {hn::MulSub(square, way.x, hn::Mul(along, edge.x)), hn::MulSub(square, way.y, hn::Mul(along, edge.y)),
            hn::MulSub(square, way.z, hn::Mul(along, edge.z))};
}

/// Counterpart of surely_far_fine() for one test per lane, limited to the directions of one time sample.
template <FeatureKind kind, int moments, class V>
HWY_INLINE auto surely_far_fine(const TestBatch<V, moments>& tests, int moment) {
    const auto& [seen, reach, magnitude, distance] = tests;
    const Point<V>(&to)[3] = seen.to[moment];
    const Point<V> way = between_middles<kind>(to), u = first_edge<kind>(to), v = second_edge<kind>(to);
    auto far = hn::Or(separates<kind>(beside(way, u), seen, reach, distance),
                      separates<kind>(beside(way, v), seen, reach, distance));
    if constexpr (kind == FeatureKind::vertex_face)
        far = hn::Or(far, separates<kind>(beside(way, subtract(to[2], to[1])), seen, reach, distance));
    if constexpr (moments == 2) {
        far = hn::Or(far, separates<kind>(way, seen, reach, distance));
        far = hn::Or(far, separates<kind>(cross(u, v), seen, reach, distance));
    }
    return far;
}
template <FeatureKind kind, int moments, class V>
HWY_INLINE auto surely_far_fine(const TestBatch<V, moments>& tests) {
    auto far = surely_far_fine<kind>(tests, 0);
    if constexpr (moments == 2) far = hn::Or(far, surely_far_fine<kind>(tests, 1));
    return far;
}

/// Calls keep(i, next) for each test i that is not `far`, in order; `next` counts these tests from 0. Returns their
/// number. `vertices_of(i, room)` returns the vertices of test i; `room` is memory for them, if they are not stored
/// elsewhere.
template <FeatureKind kind, int moments, class D, class Points, class VerticesOf, class Far, class Keep>
HWY_INLINE std::size_t keep_near(D d, const Points& points, std::int64_t ends, RequestedDistance distance,
                                 std::size_t count, VerticesOf vertices_of, Far far, Keep keep) {
    using V = hn::Vec<D>;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    const V of_all = hn::Set(d, distance.all * up);
    std::size_t left = 0;
    for (std::size_t first = 0; first < count; first += lanes) {
        std::int32_t room[lanes][4];
        const std::int32_t* vertices[lanes];
        for (std::size_t lane = 0; lane < lanes; ++lane)
            vertices[lane] = vertices_of(std::min(first + lane, count - 1), room[lane]);
        TestBatch<V, moments> tests;
        load_vectors<moments>(d, points, ends, vertices, tests.seen);
        const Point<V> reach[3] = {tests.seen.reach(0), tests.seen.reach(1), tests.seen.reach(2)};
        tests.reach = add(add(reach[0], reach[1]), reach[2]);
        tests.magnitude = dot(product_magnitudes(reach[0], reach[1]), reach[2]);
        tests.asked = distance.each ? hn::Mul(hn::LoadU(d, distance.each + first), hn::Set(d, up)) : of_all;
        if (distance.share > 0)
            tests.asked =
                hn::Max(tests.asked, hn::Mul(hn::Set(d, distance.share * up), most_at_start<kind>(tests.seen)));
        std::uint64_t near = ~bits_of(d, far(tests)) & ((std::uint64_t{1} << std::min(lanes, count - first)) - 1);
        for (; near; near &= near - 1) {
            const std::size_t from = first + static_cast<std::size_t>(__builtin_ctzll(near));
            if (distance.each) distance.each[left] = distance.each[from];
            keep(from, left++);
        }
    }
    return left;
}

/// Moves the tests that are not `far` to the front, and returns their number.
template <FeatureKind kind, int moments, class D, class Points, class Far>
HWY_INLINE std::size_t keep_near(D d, const Points& points, std::int64_t ends, RequestedDistance distance,
                                 FeatureTest* test, std::size_t count, Far far) {
    return keep_near<kind, moments>(
        d, points, ends, distance, count, [&](std::size_t i, std::int32_t*) { return test[i].vertex; }, far,
        [&](std::size_t from, std::size_t to) { test[to] = test[from]; });
}

/// Calls filter(d, points) with the rows that exist, as Points32 or Points64.
template <class Filter>
HWY_INLINE std::size_t with_points(const PointRows& points, Filter filter) {
    const hn::ScalableTag<float> d;
    if (points.f) return filter(d, Points32(points.f));
    return filter(d, Points64(points.d));
}

template <FeatureKind kind, int moments>
std::size_t filter(const PointRows& points, std::int64_t ends, RequestedDistance distance, FeatureTest* test,
                   std::size_t count) {
    using Tests = TestBatch<hn::Vec<hn::ScalableTag<float>>, moments>;
    const bool contact = distance.contact();
    return with_points(points, [&](auto d, const auto& rows) HWY_ATTR {
        count = keep_near<kind, moments>(d, rows, ends, distance, test, count, [&](const Tests& tests) HWY_ATTR {
            return surely_far_coarse<kind>(tests, contact);
        });
        return keep_near<kind, moments>(d, rows, ends, distance, test, count,
                                        [&](const Tests& tests) HWY_ATTR { return surely_far_fine<kind>(tests); });
    });
}

/// Writes out only the listed tests that pass the coarse filter, which are few; the fine filter then reads these.
template <FeatureKind kind, int moments>
std::size_t filter_list(const PointRows& points, std::int64_t ends, RequestedDistance distance,
                        const PairsLeft<moments>& pairs, TestList& listed, FeatureTest* test) {
    using Tests = TestBatch<hn::Vec<hn::ScalableTag<float>>, moments>;
    const auto vertices_of = [&](std::size_t i, std::int32_t(&room)[4]) -> const std::int32_t* {
        const std::size_t pair = listed.pair(i);
        vertices_of_test<kind>(pairs.row(pair), pairs.column(pair), listed.bit(i), room);
        return room;
    };
    return with_points(points, [&](auto d, const auto& rows) HWY_ATTR {
        const std::size_t left = keep_near<kind, moments>(
            d, rows, ends, distance, listed.count, vertices_of,
            [&](const Tests& tests) HWY_ATTR { return surely_far_coarse<kind>(tests, distance.contact()); },
            [&](std::size_t from, std::size_t to) { listed.test[to] = listed.test[from]; });
        for (std::size_t i = 0; i < left; ++i) write_test<kind>(pairs, listed, i, test[i]);
        return keep_near<kind, moments>(d, rows, ends, distance, test, left,
                                        [&](const Tests& tests) HWY_ATTR { return surely_far_fine<kind>(tests); });
    });
}

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu::features
HWY_AFTER_NAMESPACE();

#endif
