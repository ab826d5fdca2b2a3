// Corners of a triangle as vectors of four, (x, y, z, -): what kernels that visit one triangle at a time share.

#if defined(CRUMPLE_CPU_SIMD_CORNERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#undef CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#else
#define CRUMPLE_CPU_SIMD_CORNERS_INL_H_
#endif

#include "cpu/simd/common-inl.h"
#include "hwy/cache_control.h"

HWY_BEFORE_NAMESPACE();
namespace crumple::cpu {
namespace HWY_NAMESPACE {

using Four = hn::FixedTag<float, 4>;
using V4 = hn::Vec<Four>;

/// (x, y, z, w) -> (y, z, x, w).
HWY_INLINE V4 rotate_axes(V4 v) {
    alignas(16) static constexpr std::uint8_t order[16] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
    const hn::Repartition<std::uint8_t, Four> bytes;
    return hn::BitCast(Four(), hn::TableLookupBytes(hn::BitCast(bytes, v), hn::Load(bytes, order)));
}
/// The sum of all four lanes, in all lanes.
HWY_INLINE V4 sum_of(V4 v) {
    const V4 pairs = hn::Add(v, hn::Shuffle2301(v));
    return hn::Add(pairs, hn::Shuffle1032(pairs));
}

/// The rows of a triangle's corners, relative to each other and to an origin. float32 rows are exact; float64 rows are
/// subtracted in float64 and rounded once, so that both err by at most u of the result.
struct Points32 {
    const float* rows;
    void prefetch(std::int32_t vertex) const { hwy::Prefetch(rows + 4 * static_cast<std::int64_t>(vertex)); }
    using Row = V4;
    Row load(std::int32_t vertex) const { return hn::Load(Four(), rows + 4 * static_cast<std::int64_t>(vertex)); }
    V4 load_float(std::int32_t vertex) const { return load(vertex); }
    static V4 difference(Row a, Row b) { return hn::Sub(a, b); }
    static Row origin(Vec3f p) {
        const float lanes[4] = {p.x, p.y, p.z, 0};
        return hn::LoadU(Four(), lanes);
    }
};
struct Points64 {
    const double* rows;
    void prefetch(std::int32_t vertex) const { hwy::Prefetch(rows + 4 * static_cast<std::int64_t>(vertex)); }
    struct Row {
        const double* p;
    };
    Row load(std::int32_t vertex) const { return {rows + 4 * static_cast<std::int64_t>(vertex)}; }
#if HWY_MAX_BYTES >= 32
    using D = hn::Rebind<double, Four>;
    V4 load_float(std::int32_t vertex) const { return hn::DemoteTo(Four(), hn::LoadU(D(), load(vertex).p)); }
    static V4 difference(Row a, Row b) {
        return hn::DemoteTo(Four(), hn::Sub(hn::LoadU(D(), a.p), hn::LoadU(D(), b.p)));
    }
#else
    V4 load_float(std::int32_t vertex) const { return difference(load(vertex), {origin_row}); }
    static V4 difference(Row a, Row b) {
        float lanes[4];
        for (int k = 0; k < 4; ++k) lanes[k] = static_cast<float>(a.p[k] - b.p[k]);
        return hn::LoadU(Four(), lanes);
    }
    static constexpr double origin_row[4] = {0, 0, 0, 0};
#endif
};

}  // namespace HWY_NAMESPACE
}  // namespace crumple::cpu
HWY_AFTER_NAMESPACE();

#endif
