#include "model/scene_features.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "crumple/error.h"

namespace crumple {
namespace {

constexpr std::int64_t chunk = 4096;

std::size_t chunks(std::int64_t n) { return static_cast<std::size_t>((n + chunk - 1) / chunk); }

}  // namespace

SceneFeatures::SceneFeatures(MemoryMeter* meter)
    : edges_(meter),
      edges_of_(meter),
      owned_(meter),
      names_(meter),
      corners_(meter),
      side_(meter),
      first_(meter),
      count_(meter),
      buffers_(meter) {}

void SceneFeatures::release() {
    edges_.release();
    edges_of_.release();
    owned_.release();
    names_.release();
    corners_.release();
    side_.release();
    first_.release();
    count_.release();
    buffers_.table.release();
    vertices_ = -1;
}

void SceneFeatures::prepare(const Scene& scene, bool weld, ParallelFor& workers) {
    if (scene.triangle_count() > std::numeric_limits<std::int32_t>::max() / 3)
        throw Error(ErrorCode::invalid_argument, "there are " + std::to_string(scene.triangle_count()) +
                                                     " triangles; features are found of 715827882 at most");
    if (!known(scene)) {
        vertices_ = -1;  // should memory end half-way
        find_edges(scene, workers);
        find_owned_vertices(scene);
        corners_.resize_discard(static_cast<std::size_t>(3 * scene.triangle_count()));
        std::copy_n(scene.corners, corners_.size(), corners_.data());
        vertices_ = scene.vertex_count();
    }
    names_.clear();
    if (weld) name_equal_positions(scene, buffers_.table, names_);
}

bool SceneFeatures::known(const Scene& scene) const {
    const auto n = static_cast<std::size_t>(3 * scene.triangle_count());
    return vertices_ == scene.vertex_count() && corners_.size() == n &&
           (n == 0 || std::memcmp(corners_.data(), scene.corners, n * sizeof(std::int32_t)) == 0);
}

// A counting sort of all sides by their lower vertex; then those of each by the other.
void SceneFeatures::find_edges(const Scene& scene, ParallelFor& workers) {
    const std::int64_t n = scene.triangle_count(), vertices = scene.vertex_count();
    const auto ends = [&](std::int64_t slot) {
        const std::int32_t *c = scene.corners + slot / 3 * 3, a = c[slot % 3], b = c[(slot + 1) % 3];
        return std::pair(std::min(a, b), std::max(a, b));
    };
    first_.assign(static_cast<std::size_t>(vertices) + 2, 0);
    std::int64_t* next = first_.data() + 1;  // counts, then places; at last first_[v] is where those of v begin
    for (std::int64_t slot = 0; slot < 3 * n; ++slot) {
        const auto [low, high] = ends(slot);
        if (low != high) ++next[low + 1];
    }
    for (std::int64_t v = 0; v < vertices; ++v) next[v + 1] += next[v];
    side_.resize_discard(static_cast<std::size_t>(next[vertices]));
    edges_of_.resize_discard(static_cast<std::size_t>(n));
    owned_.assign(static_cast<std::size_t>(n), 0);
    for (std::int64_t slot = 0; slot < 3 * n; ++slot) {
        const auto [low, high] = ends(slot);
        if (low == high)
            edges_of_[slot / 3][static_cast<std::size_t>(slot % 3)] = -1;
        else
            side_[next[low]++] = {high, static_cast<std::int32_t>(slot)};
    }

    const auto first_of = [&](std::int64_t c) { return std::min(vertices, static_cast<std::int64_t>(c) * chunk); };
    count_.resize_discard(chunks(vertices) + 1);
    workers.parallel_for(chunks(vertices), [&](std::size_t c) {
        std::int64_t edges = 0;
        for (std::int64_t v = first_of(static_cast<std::int64_t>(c)); v < first_of(static_cast<std::int64_t>(c) + 1);
             ++v) {
            Side *begin = side_.data() + first_[v], *end = side_.data() + first_[v + 1];
            std::sort(begin, end, [](const Side& s, const Side& t) {
                return std::pair(s.other, s.slot) < std::pair(t.other, t.slot);
            });
            for (const Side* s = begin; s != end; ++s) edges += s == begin || s->other != s[-1].other;
        }
        count_[c + 1] = edges;
    });
    count_[0] = 0;
    for (std::size_t c = 0; c < chunks(vertices); ++c) count_[c + 1] += count_[c];
    edges_.resize_discard(static_cast<std::size_t>(count_[chunks(vertices)]));
    workers.parallel_for(chunks(vertices), [&](std::size_t c) {
        std::int64_t edge = count_[c] - 1;
        for (std::int64_t v = first_of(static_cast<std::int64_t>(c)); v < first_of(static_cast<std::int64_t>(c) + 1);
             ++v) {
            for (std::int64_t i = first_[v]; i < first_[v + 1]; ++i) {
                const Side& s = side_[i];
                if (i == first_[v] || s.other != side_[i - 1].other) {
                    edges_[++edge] = {static_cast<std::int32_t>(v), s.other};
                    // Another chunk may own another side of this triangle.
                    std::atomic_ref(owned_[s.slot / 3])
                        .fetch_or(static_cast<std::uint8_t>(8 << s.slot % 3), std::memory_order_relaxed);
                }
                edges_of_[s.slot / 3][static_cast<std::size_t>(s.slot % 3)] = static_cast<std::int32_t>(edge);
            }
        }
    });
}

void SceneFeatures::find_owned_vertices(const Scene& scene) {
    Array<std::int64_t>& seen = first_;
    seen.assign(static_cast<std::size_t>(scene.vertex_count()), 0);
    for (std::int64_t t = 0; t < scene.triangle_count(); ++t)
        for (int k = 0; k < 3; ++k) {
            std::int64_t& known = seen[scene.corners[3 * t + k]];
            if (!known) owned_[t] = static_cast<std::uint8_t>(owned_[t] | 1 << k);
            known = 1;
        }
}

}  // namespace crumple
