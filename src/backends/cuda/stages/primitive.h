#pragma once

// Primitives that represent a triangle in the stages: the triangle itself, or, for feature queries, its corners at one
// or two time samples, with an inflated box (geometry/inflation.h). Kernels that read corners are instantiated for each
// primitive.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/layout.h"
#include "filters/features/length.h"
#include "geometry/inflation.h"
#include "geometry/leaf_frame.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

template <class T>
__device__ Vec3d position(const Row<T>* rows, std::int32_t v) {
    const Row<T> row = rows[v];
    return {row.x, row.y, row.z};
}
__device__ inline Vec3d position(const PointRows& rows, std::int32_t v) { return rows[v]; }

/// Primitive of intersection queries: the static triangle.
struct StaticTriangle {
    static constexpr int corners = 3;

    /// Returns the triangle in a leaf's frame. `p` receives its normalised corners.
    template <class Rows>
    __device__ InFrame<3> in_frame(const Rows& rows, const std::int32_t* corner, std::int32_t, const LeafFrame& frame,
                                   Vec3d (&p)[3]) const {
        for (int k = 0; k < 3; ++k) p[k] = position(rows, corner[k]);
        return {p, frame};
    }
};

/// Primitive of feature queries: a triangle with an inflated box, at one or two time samples (the template argument).
/// The corners at the start come first, then those at the end.
template <int moments>
struct Widened {
    static constexpr int corners = 3 * moments;
    std::int32_t ends;           ///< row of the first vertex's end position
    const Inflation* inflation;  ///< on the device, since the host may not know the scene's box

    template <class Rows>
    __device__ InFrame<corners> in_frame(const Rows& rows, const std::int32_t* corner, std::int32_t triangle,
                                         const LeafFrame& frame, Vec3d (&p)[corners]) const {
        float way = 0;
        for (int k = 0; k < 3; ++k) {
            p[k] = position(rows, corner[k]);
            if constexpr (moments == 1) continue;
            const int end = corners - 3 + k;
            p[end] = position(rows, corner[k] + ends);
            way = max(way, length(to_float(p[end] - p[k])));
        }
        InFrame<corners> member(p, frame);
        const float more = inflation->of(triangle)(way);
        member.low = member.low - Vec3f{more, more, more};
        member.high = member.high + Vec3f{more, more, more};
        member.reach += more;
        return member;
    }
};

/// Choice of the primitive for a pass. `ends` and `inflation`: see Widened.
struct Primitives {
    bool widened = false, moving = false;
    std::int32_t ends = 0;
    const Inflation* inflation = nullptr;
    bool along_axes = false;  ///< boxes, and so the frames of leaves, have the coordinate axes
    friend bool operator==(const Primitives&, const Primitives&) = default;

    /// Returns the number of rows of points.
    std::size_t rows(std::int64_t vertices) const { return static_cast<std::size_t>(vertices) * (moving ? 2 : 1); }
};

/// Returns the primitives of a feature query, which move if the scene does.
inline Primitives widened_primitives(const PreparedScene& scene, const Inflation* inflation, bool along_axes) {
    return {true, scene.moving, scene.moving ? static_cast<std::int32_t>(scene.vertex_count()) : 0, inflation,
            along_axes};
}

/// Calls work(primitive) with the chosen primitive.
template <class Work>
void with_primitive(const Primitives& primitives, Work work) {
    if (!primitives.widened)
        work(StaticTriangle{});
    else if (!primitives.moving)
        work(Widened<1>{0, primitives.inflation});
    else
        work(Widened<2>{primitives.ends, primitives.inflation});
}

}  // namespace crumple::cuda
