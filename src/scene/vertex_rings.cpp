#include "scene/vertex_rings.h"

#include <atomic>

namespace crumple {
namespace {

constexpr std::int64_t chunk = 1024;

std::span<const std::int32_t> corners_of(const SceneFeatures& features) {
    return {features.corners(), static_cast<std::size_t>(3 * (features.faces() + features.proxies()))};
}

bool same(std::span<const std::int32_t> a, std::span<const std::int32_t> b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin());
}

std::uint64_t next_revision() {
    static std::atomic<std::uint64_t> last{0};
    return ++last;
}

}  // namespace

void VertexRings::release() {
    of_.release();
    first_.release();
    next_.release();
    first_next_.release();
    corners_.release();
    names_.release();
    vertices_ = -1;
}

void VertexRings::copy_from(const PartFeatures& part) {
    revision_ = next_revision();
    vertices_ = -1;
    rings_ = part.rings;
    first_.resize_discard(part.first_ring.size());
    std::copy(part.first_ring.begin(), part.first_ring.end(), first_.begin());
    of_.resize_discard(part.ring.size());
    std::copy(part.ring.begin(), part.ring.end(), of_.begin());
}

bool VertexRings::known(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings) const {
    return vertices_ == vertices && rings_ == rings && same(corners_.span(), corners_of(features)) &&
           same(names_.span(), features.names().span());
}

// Lists the adjacent vertices of each vertex: sorts both directions of each side by their first vertex (counting sort),
// then removes duplicates.
void VertexRings::find_next(const SceneFeatures& features, std::int64_t vertices) {
    first_next_.assign(static_cast<std::size_t>(vertices) + 2, 0);
    // Counts, then positions; finally v's entries begin at first_next_[v].
    std::int64_t* place = first_next_.data() + 1;
    const std::span<const std::int32_t> corners = corners_of(features);
    const auto for_each_direction = [&](auto visit) {
        for (std::size_t t = 0; t < corners.size(); t += 3)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = features.name(corners[t + k]), b = features.name(corners[t + (k + 1) % 3]);
                if (a == b) continue;
                visit(a, b);
                visit(b, a);
            }
    };
    for_each_direction([&](std::int32_t from, std::int32_t) { ++place[from + 1]; });
    for (std::int64_t v = 0; v < vertices; ++v) place[v + 1] += place[v];
    next_.resize_discard(static_cast<std::size_t>(place[vertices]));
    for_each_direction([&](std::int32_t from, std::int32_t to) { next_[place[from]++] = to; });

    std::int32_t* end = next_.begin();
    for (std::int64_t v = 0; v < vertices; ++v) {
        std::int32_t *const begin = next_.begin() + first_next_[v], *behind = next_.begin() + first_next_[v + 1];
        std::sort(begin, behind);
        behind = std::unique(begin, behind);
        first_next_[v] = end - next_.begin();
        if (end != begin) std::copy(begin, behind, end);
        end += behind - begin;
    }
    first_next_[vertices] = end - next_.begin();
}

// Searches breadth-first, ring by ring. Edges from one ring lead to the previous ring, the same ring, or the next one.
void VertexRings::walk(std::int32_t from, Array<std::int32_t>& reached) const {
    reached.clear();
    reached.push_back(from);
    std::size_t before = 0, begin = 0;  // starts of the previous and of the current ring
    for (std::int32_t ring = 0; ring < rings_ && begin < reached.size(); ++ring) {
        const std::size_t end = reached.size();
        for (std::size_t i = begin; i < end; ++i)
            for (std::int64_t k = first_next_[reached[i]]; k < first_next_[reached[i] + 1]; ++k)
                reached.push_back(next_[k]);
        std::int32_t *const first = reached.begin() + end, *last = reached.end();
        std::sort(first, last);
        last = std::unique(first, last);
        last = std::remove_if(first, last, [&](std::int32_t v) {
            return std::binary_search(reached.begin() + before, reached.begin() + begin, v) ||
                   std::binary_search(reached.begin() + begin, first, v);
        });
        reached.resize(static_cast<std::size_t>(last - reached.begin()));
        before = begin, begin = end;
    }
    std::copy(reached.begin() + 1, reached.end(), reached.begin());  // without the vertex itself
    reached.resize(reached.size() - 1);
    std::sort(reached.begin(), reached.end());
}

// Walks from each vertex twice, once to count and once to store, so that only the result needs metered memory.
void VertexRings::prepare(const SceneFeatures& features, std::int64_t vertices, std::int32_t rings,
                          ParallelFor& workers, Cancellation& cancellation) {
    if (known(features, vertices, rings)) return;
    vertices_ = -1;  // invalid if memory runs out half-way
    revision_ = next_revision();
    rings_ = rings;
    find_next(features, vertices);
    first_.resize_discard(static_cast<std::size_t>(vertices) + 1);
    first_[0] = 0;
    const auto visit = [&](auto take) {
        workers.parallel_for(static_cast<std::size_t>((vertices + chunk - 1) / chunk), [&](std::size_t c) {
            cancellation.check();
            const std::int64_t begin = static_cast<std::int64_t>(c) * chunk, end = std::min(vertices, begin + chunk);
            Array<std::int32_t> reached;
            for (std::int64_t v = begin; v < end; ++v) {
                walk(static_cast<std::int32_t>(v), reached);
                take(v, reached);
            }
        });
    };
    visit([&](std::int64_t v, const Array<std::int32_t>& reached) {
        first_[v + 1] = static_cast<std::int64_t>(reached.size());
    });
    for (std::int64_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
    of_.resize_discard(static_cast<std::size_t>(first_[vertices]));
    visit([&](std::int64_t v, const Array<std::int32_t>& reached) {
        std::copy(reached.begin(), reached.end(), of_.begin() + first_[v]);
    });
    const std::span<const std::int32_t> corners = corners_of(features);
    corners_.resize_discard(corners.size());
    std::copy(corners.begin(), corners.end(), corners_.begin());
    names_ = features.names();
    vertices_ = vertices;
}

}  // namespace crumple
