// Corners of triangles as rows of four, (x, y, z, -), one triangle in each block of 128 bits: shared by the kernels
// that visit triangles in any order. Corners come from scattered rows, so no load can be wider than a row.

#if defined(CRUMPLE_CPU_SIMD_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#undef CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#endif

#include "backends/cpu/simd/common-inl.h"
#include "hwy/cache_control.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

using Four = hn::FixedTag<float, 4>;
using V4 = hn::Vec<Four>;

/// Returns the vector whose block b is f(b).
template <class D, class F>
HWY_INLINE hn::Vec<D> gather_blocks(D d, F f) {
    if constexpr (blocks == 1) {
        return f(0);
    } else if constexpr (blocks == 2) {
        return hn::Combine(d, f(1), f(0));
    } else {
        const hn::Half<D> half;
        return hn::Combine(d, hn::Combine(half, f(3), f(2)), hn::Combine(half, f(1), f(0)));
    }
}

template <class V>
struct Point {
    V x, y, z;
};

/// Transposes rows of four in each block: lane r of block b comes from block b of row[r].
template <class D, class V>
HWY_INLINE void transpose_rows(D d, const V (&row)[4], V& x, V& y, V& z, V& w) {
    const V low02 = hn::InterleaveLower(d, row[0], row[2]), low13 = hn::InterleaveLower(d, row[1], row[3]);
    const V high02 = hn::InterleaveUpper(d, row[0], row[2]), high13 = hn::InterleaveUpper(d, row[1], row[3]);
    x = hn::InterleaveLower(d, low02, low13);
    y = hn::InterleaveUpper(d, low02, low13);
    z = hn::InterleaveLower(d, high02, high13);
    w = hn::InterleaveUpper(d, high02, high13);
}

/// Permutes (x, y, z, w) to (y, z, x, w) in each block.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V rotate_axes(D d, V v) {
    alignas(16) static constexpr std::uint8_t order[16] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
    const hn::Repartition<std::uint8_t, D> bytes;
    return hn::BitCast(d, hn::TableLookupBytes(hn::BitCast(bytes, v), hn::LoadDup128(bytes, order)));
}

/// Returns the sum of each block's lanes, in all of its lanes.
template <class V>
HWY_INLINE V sum_of(V v) {
    const V pairs = hn::Add(v, hn::Shuffle2301(v));
    return hn::Add(pairs, hn::Shuffle1032(pairs));
}

/// Returns the largest of each block's lanes, in all of its lanes.
template <class V>
HWY_INLINE V largest_of(V v) {
    const V pairs = hn::Max(v, hn::Shuffle2301(v));
    return hn::Max(pairs, hn::Shuffle1032(pairs));
}

/// Stores four rows of each block, one after the other, from out[block] on.
template <class D, class V>
HWY_INLINE void store_rows(D d, V r0, V r1, V r2, V r3, float* const (&out)[blocks]) {
    constexpr std::size_t lanes = hn::MaxLanes(d);
    if constexpr (blocks == 4) {
        transpose_blocks(d, r0, r1, r2, r3);
        hn::StoreU(r0, d, out[0]);
        hn::StoreU(r1, d, out[1]);
        hn::StoreU(r2, d, out[2]);
        hn::StoreU(r3, d, out[3]);
    } else if constexpr (blocks == 2) {
        hn::StoreU(hn::ConcatLowerLower(d, r1, r0), d, out[0]);
        hn::StoreU(hn::ConcatLowerLower(d, r3, r2), d, out[0] + lanes);
        hn::StoreU(hn::ConcatUpperUpper(d, r1, r0), d, out[1]);
        hn::StoreU(hn::ConcatUpperUpper(d, r3, r2), d, out[1] + lanes);
    } else {
        hn::StoreU(r0, d, out[0]);
        hn::StoreU(r1, d, out[0] + lanes);
        hn::StoreU(r2, d, out[0] + 2 * lanes);
        hn::StoreU(r3, d, out[0] + 3 * lanes);
    }
}

/// Corners relative to the origin of the leaf (geometry/leaf_frame.h), and the edges from the first one.
template <class V>
struct LocalCorners {
    V q0, q1, q2, a, b;
};

/// Reads float32 rows, which are exact. A difference is exact if its operands are within a factor of two, and else errs
/// by at most u of the result. `corner[b]` points to the three indices of block b's triangle. `origin` is in memory,
/// ready to be loaded: loading it right after it was stored in pieces would stall.
struct Points32 {
    const float* rows;
    HWY_ALIGN float origin[4] = {};

    explicit Points32(const float* points, Vec3f o = {}) : rows(points), origin{o.x, o.y, o.z, 0} {}

    const float* row(std::int32_t vertex) const { return rows + 4 * static_cast<std::int64_t>(vertex); }
    template <class D>
    HWY_INLINE hn::Vec<D> position(D d, const std::int32_t* const* corner, int k) const {
        return gather_blocks(d, [&](int b) HWY_ATTR { return hn::Load(Four(), row(corner[b][k])); });
    }
    template <class D, class V = hn::Vec<D>>
    HWY_INLINE LocalCorners<V> corners(D d, const std::int32_t* const* corner) const {
        const V o = hn::LoadDup128(d, origin);
        const V p0 = position(d, corner, 0), p1 = position(d, corner, 1), p2 = position(d, corner, 2);
        return {hn::Sub(p0, o), hn::Sub(p1, o), hn::Sub(p2, o), hn::Sub(p1, p0), hn::Sub(p2, p0)};
    }
};

/// Reads float64 rows: subtracts in float64 and rounds once, so differences err by at most u of the result, too.
struct Points64 {
    const double* rows;
    double origin[4] = {};

    explicit Points64(const double* points, Vec3f o = {}) : rows(points), origin{o.x, o.y, o.z, 0} {}

    const double* row(std::int32_t vertex) const { return rows + 4 * static_cast<std::int64_t>(vertex); }
#if HWY_MAX_BYTES >= 32
    static HWY_INLINE V4 difference(const double* p, const double* q) {
        const hn::Rebind<double, Four> d;
        return hn::DemoteTo(Four(), hn::Sub(hn::LoadU(d, p), hn::LoadU(d, q)));
    }
#else
    static HWY_INLINE V4 difference(const double* p, const double* q) {
        float lanes[4];
        for (int k = 0; k < 4; ++k) lanes[k] = static_cast<float>(p[k] - q[k]);
        return hn::LoadU(Four(), lanes);
    }
#endif
    template <class D>
    HWY_INLINE hn::Vec<D> position(D d, const std::int32_t* const* corner, int k) const {
        static constexpr double zero[4] = {0, 0, 0, 0};
        return gather_blocks(d, [&](int b) HWY_ATTR { return difference(row(corner[b][k]), zero); });
    }
    template <class D, class V = hn::Vec<D>>
    HWY_INLINE LocalCorners<V> corners(D d, const std::int32_t* const* corner) const {
        const auto from_origin = [&](int k) HWY_ATTR {
            return gather_blocks(d, [&](int b) HWY_ATTR { return difference(row(corner[b][k]), origin); });
        };
        const auto from_first = [&](int k) HWY_ATTR {
            return gather_blocks(d, [&](int b) HWY_ATTR { return difference(row(corner[b][k]), row(corner[b][0])); });
        };
        return {from_origin(0), from_origin(1), from_origin(2), from_first(1), from_first(2)};
    }
};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
