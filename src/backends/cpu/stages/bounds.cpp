#include "backends/cpu/stages/bounds.h"

#include <algorithm>
#include <atomic>

#include "geometry/normaliser.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t items_at_once = 2048;

std::size_t chunks(std::int64_t n) { return static_cast<std::size_t>((n + items_at_once - 1) / items_at_once); }

template <class T>
void normalise(const PreparedScene& scene, Workers& workers, Array<T>& points) {
    const Normaliser normaliser(scene.low, scene.high);
    const std::int64_t n = scene.vertex_count(), moments = scene.moving ? 2 : 1;
    points.resize_discard(static_cast<std::size_t>(4 * moments * n + padding));
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * items_at_once,
                           end = std::min(n, begin + items_at_once);
        const auto write = [&](Vec3d at, std::int64_t row) {
            const Vec3d p = normaliser(at);
            T* out = points.data() + 4 * row;
            out[0] = static_cast<T>(p.x), out[1] = static_cast<T>(p.y), out[2] = static_cast<T>(p.z), out[3] = 0;
        };
        for (std::int64_t v = begin; v < end; ++v) write(scene.position(v), v);
        if (scene.moving)
            for (std::int64_t v = begin; v < end; ++v) write(scene.end(v), n + v);
    });
}

// Computes balls that contain the swept volumes of triangles [begin, end), each inflated as its triangle requires; for
// candidates (Inflation::of_box), balls that contain their inflated boxes.
void swept_balls(const PreparedScene& scene, const PointRows& rows, const Inflation& inflation, std::int64_t begin,
                 std::int64_t end, Ball* ball) {
    const std::int64_t ends = scene.moving ? scene.vertex_count() : 0;
    for (std::int64_t t = begin; t < end; ++t) {
        Vec3f start[3], stop[3];
        for (int k = 0; k < 3; ++k) {
            const std::int32_t v = scene.corners[3 * t + k];
            start[k] = to_float(rows[v]);
            stop[k] = to_float(rows[static_cast<std::int32_t>(v + ends)]);
        }
        ball[t] = inflation.of_box ? ball_of_box(start, stop, inflation) : swept_ball(start, stop, inflation.of(t));
    }
}

}  // namespace

bool compute_bounds(const PreparedScene& scene, const Inflation& inflation, const StageKernels& kernels,
                    Workers& workers, Points& points, Array<Ball>& balls) {
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
    std::atomic<bool> repeats_corner{false};
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * items_at_once,
                           end = std::min(n, begin + items_at_once);
        if (inflation.of_box || inflation.radius || inflation.path_share > 0)
            swept_balls(scene, rows, inflation, begin, end, balls.data());
        else
            kernels.balls(rows, scene.corners, begin, end, scene.moving ? scene.vertex_count() : 0, inflation(0),
                          balls.data());
        if (kernels.repeats_corner(scene.corners, begin, end)) repeats_corner.store(true, std::memory_order_relaxed);
    });
    return repeats_corner;
}

void exclude_far(const PreparedScene& scene, Workers& workers, const Array<Ball>& balls,
                 Array<std::uint8_t>& included) {
    const Normaliser normaliser(scene.low, scene.high);
    // Coordinates are at most 1, so rounding to float32 and the distance below err by less than the margin.
    constexpr float margin = 2e-6f;
    Vec3f low[2], high[2];
    for (std::size_t side = 0; side < 2; ++side)
        for (int axis = 0; axis < 3; ++axis) {
            // A mesh without vertices has infinite bounds with low > high. Bounds of +-4 exclude every ball, too.
            const auto bound = [&](Vec3d corner) {
                return static_cast<float>(std::clamp(normaliser(corner)[axis], -4.0, 4.0));
            };
            low[side][axis] = bound(scene.side_low[side]) - margin;
            high[side][axis] = bound(scene.side_high[side]) + margin;
        }
    const std::int64_t n = scene.triangle_count();
    included.resize_discard(static_cast<std::size_t>(n));
    workers.parallel_for(chunks(n), [&](std::size_t part, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(part) * items_at_once,
                           end = std::min(n, begin + items_at_once);
        for (std::int64_t t = begin; t < end; ++t) {
            const Ball& ball = balls[static_cast<std::size_t>(t)];
            const std::size_t other = scene.second(t) ? 0 : 1;
            const Vec3f c{ball.x, ball.y, ball.z};
            const Vec3f out = max(Vec3f{}, max(low[other] - c, c - high[other]));
            included[t] = !(dot(out, out) > ball.r * ball.r);
        }
    });
}

}  // namespace crumple::cpu
