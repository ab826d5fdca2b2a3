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

template <class T>
void balls(const Scene& scene, Workers& workers, const Array<T>& points, Primitives& out) {
    const std::int64_t n = scene.triangle_count();
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * chunk, end = std::min(n, begin + chunk);
        for (std::int64_t t = begin; t < end; ++t) {
            Vec3f p[3];
            for (int k = 0; k < 3; ++k) {
                const T* row = points.data() + 4 * static_cast<std::int64_t>(scene.corners[3 * t + k]);
                p[k] = {static_cast<float>(row[0]), static_cast<float>(row[1]), static_cast<float>(row[2])};
            }
            const Vec3f c = (1.0f / 3.0f) * (p[0] + p[1] + p[2]);
            float r2 = 0;
            for (const Vec3f& corner : p) r2 = max(r2, dot(corner - c, corner - c));
            out.x[t] = c.x;
            out.y[t] = c.y;
            out.z[t] = c.z;
            // Coordinates are at most 1: differences and the corners of float64 input err by at most 2 u each.
            out.r[t] = std::sqrt(r2) * 1.000002f + 4e-7f;
        }
    });
}

}  // namespace

void compute_bounds(const Scene& scene, Workers& workers, Points& points, Primitives& primitives) {
    primitives.resize(static_cast<std::size_t>(scene.triangle_count()));
    if (scene.float32) {
        normalise(scene, workers, points.f);
        balls(scene, workers, points.f, primitives);
    } else {
        normalise(scene, workers, points.d);
        balls(scene, workers, points.d, primitives);
    }
}

}  // namespace crumple::cpu
