#pragma once

// What a question searches of a triangle: where it is, or where it is at one moment or all along a step, its box
// widened by what is asked for (geometry/inflation.h). Kernels that look at corners are instantiated for each.

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

/// As intersections search it.
struct AtRest {
    static constexpr int corners = 3;

    /// The triangle in a leaf's frame; `p`: its normalised corners.
    template <class Rows>
    __device__ InFrame<3> in_frame(const Rows& rows, const std::int32_t* corner, std::int32_t, const LeafFrame& frame,
                                   Vec3d (&p)[3]) const {
        for (int k = 0; k < 3; ++k) p[k] = position(rows, corner[k]);
        return {p, frame};
    }
};

/// As questions about features do. The corners at the start come first, then those at the end.
template <int moments>
struct Widened {
    static constexpr int corners = 3 * moments;
    std::int32_t ends;           ///< row of the first vertex's end
    const Inflation* inflation;  ///< on the device, where the scene's box may be known alone

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

/// Which of these a pass searches.
struct Primitives {
    bool widened = false, moving = false;
    std::int32_t ends = 0;
    const Inflation* inflation = nullptr;
    bool along_axes = false;  ///< boxes have the axes of the coordinates: so do leaves' frames
    friend bool operator==(const Primitives&, const Primitives&) = default;

    /// Rows of points.
    std::size_t rows(std::int64_t vertices) const { return static_cast<std::size_t>(vertices) * (moving ? 2 : 1); }
};

/// Primitives of a query about features, which move if the scene does.
inline Primitives widened_primitives(const PreparedScene& scene, const Inflation* inflation, bool along_axes) {
    return {true, scene.moving, scene.moving ? static_cast<std::int32_t>(scene.vertex_count()) : 0, inflation,
            along_axes};
}

/// Calls work(primitive) with the one that is searched.
template <class Work>
void with_primitive(const Primitives& primitives, Work work) {
    if (!primitives.widened)
        work(AtRest{});
    else if (!primitives.moving)
        work(Widened<1>{0, primitives.inflation});
    else
        work(Widened<2>{primitives.ends, primitives.inflation});
}

}  // namespace crumple::cuda
