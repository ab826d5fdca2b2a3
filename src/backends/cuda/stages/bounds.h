#pragma once

// Stage `bounds`: computes normalised vertices, and a ball around each triangle ([MZ] sec. 5). See docs/bounds.md.

#include <bit>

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "geometry/normaliser.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Box of all vertices. Its coordinates are stored as integers of the same order (`ordered`), so that integer atomics
/// can widen it.
struct SceneBox {
    unsigned long long low[3], high[3];
};

/// Maps a finite number to an integer; the integers have the order of the numbers. from_ordered() is the inverse.
CRUMPLE_HD inline unsigned long long ordered(double x) {
    const auto bits = std::bit_cast<unsigned long long>(x);
    return bits >> 63 ? ~bits : bits | 1ull << 63;
}
CRUMPLE_HD inline double from_ordered(unsigned long long key) {
    return std::bit_cast<double>(key >> 63 ? key & ~(1ull << 63) : ~key);
}

CRUMPLE_HD inline Normaliser normaliser_of(const SceneBox& box) {
    Vec3d low, high;
    for (int axis = 0; axis < 3; ++axis) {
        low[axis] = from_ordered(box.low[axis]);
        high[axis] = from_ordered(box.high[axis]);
    }
    return low.x <= high.x ? Normaliser(low, high) : Normaliser();
}

void clear(BatchedClear& batch, Counters* counters);
/// Adds the box to `batch`, to be set to empty, as check_vertices() requires.
void clear(BatchedClear& batch, SceneBox* box);

/// Widens the box by all vertices, at the start and at the end, and records in the counters the lowest one that is not
/// finite. Needed for scenes on the device only; the host has validated all others.
void check_vertices(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, SceneBox* box,
                    Counters* counters);

/// Returns true if the triangle's corners exist. If not, records the triangle in the counters, which keep the lowest.
__device__ inline bool corners_exist(const PreparedScene& scene, std::size_t t, Counters* counters) {
    const std::int32_t* corner = scene.corners + 3 * t;
    const auto vertices = static_cast<std::uint32_t>(scene.vertex_count());
    if (static_cast<std::uint32_t>(corner[0]) < vertices && static_cast<std::uint32_t>(corner[1]) < vertices &&
        static_cast<std::uint32_t>(corner[2]) < vertices)
        return true;
    const int side = scene.second(static_cast<std::int64_t>(t));
    atomicMin(&counters->bad_triangle[side],
              static_cast<unsigned long long>(t) - static_cast<unsigned long long>(side ? scene.triangles[0] : 0));
    return false;
}

/// Computes the rows of normalised vertices, and the balls. In a moving scene a ball contains the triangle's swept
/// volume, and the rows of end positions follow those of start positions.
void compute_bounds(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                    const Primitives& primitives, const SceneBox* box, const Points& points, Ball* balls,
                    Counters* counters);

}  // namespace crumple::cuda
