#include "cpu/bounds.h"

#include <algorithm>

#include "pipeline/normaliser.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t chunk = 8192;

std::size_t chunks(std::int64_t n) { return static_cast<std::size_t>((n + chunk - 1) / chunk); }

template <class T>
void normalise(const Scene& scene, Workers& workers, Array<T>& points) {
    const Normaliser normaliser(scene.low, scene.high);
    const std::int64_t n = scene.vertex_count();
    points.resize_discard(static_cast<std::size_t>(4 * n + padding));
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * chunk, end = std::min(n, begin + chunk);
        for (std::int64_t v = begin; v < end; ++v) {
            const Vec3d p = normaliser(scene.position(v));
            T* out = points.data() + 4 * v;
            out[0] = static_cast<T>(p.x), out[1] = static_cast<T>(p.y), out[2] = static_cast<T>(p.z), out[3] = 0;
        }
    });
}

}  // namespace

void compute_bounds(const Scene& scene, const Kernels& kernels, Workers& workers, Points& points, Array<Ball>& balls) {
    PointRows rows;
    if (scene.float32) {
        normalise(scene, workers, points.f);
        rows.f = points.f.data();
    } else {
        normalise(scene, workers, points.d);
        rows.d = points.d.data();
    }
    const std::int64_t n = scene.triangle_count();
    balls.resize_discard(static_cast<std::size_t>(n + padding));
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * chunk;
        kernels.balls(rows, scene.corners, begin, std::min(n, begin + chunk), balls.data());
    });
}

}  // namespace crumple::cpu
