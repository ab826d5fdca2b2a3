#include "backends/cuda/stages/bounds.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "backends/cuda/device/memory.h"
#include "backends/cuda/stages/positions.h"
#include "backends/cuda/stages/scene_box.h"

namespace crumple::cuda {
namespace {

constexpr double most = 1.7976931348623157e308;

// NaN and infinities fail these comparisons.
__device__ bool is_finite(const Vec3d& p) {
    return std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most;
}

template <bool aligned>
__global__ void check_kernel(PreparedScene scene, SceneBox* box, Counters* counters) {
    auto& shared = dynamic_shared<BoxShared>();
    Vec3d low{most, most, most}, high{-most, -most, -most};
    const auto n = static_cast<std::size_t>(scene.vertex_count());
    for (std::size_t v = grid_thread(); v < n; v += grid_stride()) {
        const Vec3d p = position<aligned>(scene, v);
        if (!is_finite(p)) {
            const auto first = static_cast<std::size_t>(scene.vertices[0]);
            const int side = v >= first;
            atomicMin(&counters->bad_vertex[side], static_cast<unsigned long long>(side ? v - first : v));
            continue;
        }
        low = min(low, p);
        high = max(high, p);
        if (!scene.moving) continue;
        const Vec3d end = end_position<aligned>(scene, v);
        if (!is_finite(end)) {
            atomicMin(&counters->bad_end, static_cast<unsigned long long>(v));
            continue;
        }
        low = min(low, end);
        high = max(high, end);
    }
    widen(box, low, high, shared);
}

template <class T>
__device__ Vec3f in_float(const Row<T>& row) {
    return {static_cast<float>(row.x), static_cast<float>(row.y), static_cast<float>(row.z)};
}

// Computes rows and balls. Each triangle normalises its corners again, because reading their rows would take another
// kernel.
template <bool aligned, class T>
__global__ void bounds_kernel(PreparedScene scene, const SceneBox* box, Row<T>* rows, Ball* balls, Counters* counters) {
    auto& normaliser = dynamic_shared<Normaliser>();
    if (threadIdx.x == 0) normaliser = normaliser_of(*box);
    __syncthreads();
    const auto row = [&](std::size_t v) {
        const Vec3d p = normaliser(position<aligned>(scene, v));
        return Row<T>{static_cast<T>(p.x), static_cast<T>(p.y), static_cast<T>(p.z), 0};
    };
    const auto corner = [&](std::int32_t v) { return in_float(row(static_cast<std::size_t>(v))); };
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    for (std::size_t v = grid_thread(); v < vertices; v += grid_stride()) rows[v] = row(v);
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    for (std::size_t t = grid_thread(); t < triangles; t += grid_stride()) {
        const std::int32_t* id = scene.corners + 3 * t;
        balls[t] = corners_exist(scene, t, counters) ? ball_of(corner(id[0]), corner(id[1]), corner(id[2]))
                                                     : Ball{0, 0, 0, NAN};
    }
}

// Computes rows and inflated balls for queries about features; if the scene moves, rows at the start and at the end.
template <bool aligned, class T>
__global__ void widened_bounds_kernel(PreparedScene scene, Primitives primitives, const SceneBox* box, Row<T>* rows,
                                      Ball* balls, Counters* counters) {
    auto& normaliser = dynamic_shared<Normaliser>();
    if (threadIdx.x == 0) normaliser = normaliser_of(*box);
    __syncthreads();
    const auto normalised = [&](const Vec3d& at) {
        const Vec3d p = normaliser(at);
        return Row<T>{static_cast<T>(p.x), static_cast<T>(p.y), static_cast<T>(p.z), 0};
    };
    const auto start = [&](std::size_t v) { return normalised(position<aligned>(scene, v)); };
    const auto end = [&](std::size_t v) { return normalised(end_position<aligned>(scene, v)); };
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    for (std::size_t v = grid_thread(); v < vertices; v += grid_stride()) {
        rows[v] = start(v);
        if (primitives.moving) rows[vertices + v] = end(v);
    }
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const Inflation inflation = *primitives.inflation;
    for (std::size_t t = grid_thread(); t < triangles; t += grid_stride()) {
        balls[t] = {0, 0, 0, NAN};
        if (!corners_exist(scene, t, counters)) continue;
        Vec3f from[3], to[3];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto v = static_cast<std::size_t>(scene.corners[3 * t + k]);
            from[k] = in_float(start(v));
            to[k] = primitives.moving ? in_float(end(v)) : from[k];
        }
        balls[t] = primitives.along_axes ? ball_of_box(from, to, inflation)
                                         : swept_ball(from, to, inflation.of(static_cast<std::int64_t>(t)));
    }
}

}  // namespace

void clear(BatchedClear& batch, Counters* counters) {
    // The counters of the lowest bad or changed element begin with all bits set, which means that there is none.
    constexpr std::size_t noted = offsetof(Counters, places);
    static_assert(noted == 8 * sizeof(unsigned long long));
    batch.add(counters, noted, ~0u);
    batch.add(counters->places, sizeof *counters - noted);
}

void clear(BatchedClear& batch, SceneBox* box) {
    batch.add(box->low, sizeof box->low, ~0u);
    batch.add(box->high, sizeof box->high);
}

void check_vertices(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, SceneBox* box,
                    Counters* counters) {
    const auto n = static_cast<std::size_t>(scene.vertex_count());
    Launch{stream, geometry.blocks(n), geometry.threads, sizeof(BoxShared)}(
        is_aligned(scene) ? check_kernel<true> : check_kernel<false>, scene, box, counters);
}

void compute_bounds(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                    const Primitives& primitives, const SceneBox* box, const Points& points, Ball* balls,
                    Counters* counters) {
    const auto elements = static_cast<std::size_t>(std::max(scene.vertex_count(), scene.triangle_count()));
    const Launch launch{stream, geometry.blocks(elements), geometry.threads, sizeof(Normaliser)};
    const auto run = [&]<bool aligned>(auto* rows) {
        using T = std::remove_reference_t<decltype(rows->x)>;
        if (primitives.widened)
            launch(widened_bounds_kernel<aligned, T>, scene, primitives, box, rows, balls, counters);
        else
            launch(bounds_kernel<aligned, T>, scene, box, rows, balls, counters);
    };
    const auto run_aligned = [&](auto* rows) {
        is_aligned(scene) ? run.template operator()<true>(rows) : run.template operator()<false>(rows);
    };
    points.f ? run_aligned(points.f) : run_aligned(points.d);
}

}  // namespace crumple::cuda
