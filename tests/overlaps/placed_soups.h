#pragma once

// Surfaces of soups with their trees, and soups for tests of depths.

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "search/walks/point_walk.h"
#include "soups.h"

namespace crumple::test {

/// Runs tasks in reverse order.
struct Backwards : ParallelFor {
    void parallel_for(std::size_t n, Task task) override {
        while (n > 0) task(--n);
    }
};

/// Surface of a soup, and its tree.
struct Placed {
    std::vector<Vec3d> points;
    ClosedSurface closed{nullptr};
    PlacedSurface surface;
    std::unique_ptr<SurfaceTree> tree;

    explicit Placed(const Soup<double>& soup) {
        ParallelFor workers;
        SceneBuffers buffers;
        closed.prepare(prepare_scene(soup.view(), nullptr, false, workers, buffers), workers);
        for (const auto& [x, y, z] : soup.vertices) points.push_back({x, y, z});
        surface.surface = &closed;
        surface.points = points.data();
        surface.vertex_count = static_cast<std::int64_t>(points.size());
        for (const Vec3d& p : points) {
            surface.box.widen(p);
            surface.in_range = surface.in_range && in_double_word_range(p);
        }
        tree = std::make_unique<SurfaceTree>(surface, nullptr);
    }
    std::int32_t faces() const { return closed.face_count(); }
};

inline Soup<double> scaled(Soup<double> soup, double factor) {
    for (auto& p : soup.vertices)
        for (double& x : p) x *= factor;
    return soup;
}

/// Returns the soup with each face split into four, at the middles of its edges.
inline Soup<double> subdivided(const Soup<double>& soup) {
    Soup<double> fine;
    fine.vertices = soup.vertices;
    const auto size = soup.vertices.size();
    std::vector<std::int32_t> middles(size * size, -1);
    const auto middle = [&](std::int32_t a, std::int32_t b) {
        const auto i = static_cast<std::size_t>(std::min(a, b)), j = static_cast<std::size_t>(std::max(a, b));
        std::int32_t& known = middles[i * size + j];
        if (known >= 0) return known;
        known = static_cast<std::int32_t>(fine.vertices.size());
        auto& p = fine.vertices.emplace_back();
        for (std::size_t axis = 0; axis < 3; ++axis)
            p[axis] = 0.5 * soup.vertices[i][axis] + 0.5 * soup.vertices[j][axis];
        return known;
    };
    for (const auto& [a, b, c] : soup.triangles) {
        const std::int32_t x = middle(a, b), y = middle(b, c), z = middle(c, a);
        for (const auto& [p, q, r] :
             {std::array{a, x, z}, std::array{b, y, x}, std::array{c, z, y}, std::array{x, y, z}})
            fine.triangles.push_back({p, q, r});
    }
    return fine;
}

inline Soup<double> box(double low, double high, double height = 0) {
    Soup<double> soup;
    for (int v = 0; v < 8; ++v)
        soup.vertices.push_back({v & 1 ? high : low, v & 2 ? high : low, (v & 4 ? high : low) + height});
    soup.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return soup;
}

}  // namespace crumple::test
