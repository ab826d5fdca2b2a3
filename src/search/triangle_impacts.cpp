#include "search/triangle_impacts.h"

#include <algorithm>

#include "results/intersection_output.h"

namespace crumple {
namespace {

constexpr std::int64_t chunk = 4096;  // triangles

bool names(const std::int32_t* corners, std::int32_t vertex) {
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
}

// Runs a search, and then restores the peak of the memory meter if it was higher before the search: a search that frees
// its memory and starts again resets the peak.
template <class Search>
void keeping_peak(MemoryMeter& meter, Search search) {
    const std::int64_t before = meter.peak;
    search();
    if (meter.peak < before) meter.peak = before;
}

}  // namespace

TriangleImpacts::TriangleImpacts(MemoryMeter& meter)
    : meter_(meter),
      corners_(&meter),
      intersecting_(&meter),
      first_use_(&meter),
      uses_(&meter),
      first_(&meter),
      kept_(&meter),
      entries_(&meter),
      rows_(&meter) {}

void TriangleImpacts::release() {
    corners_.release();
    intersecting_.release();
    first_use_.release();
    uses_.release();
    first_.release();
    kept_.release();
    entries_.release();
    rows_ = FeatureRows(&meter_);
}

// Returns the scene at the start of the step, without the proxy triangles of lone or repeated edges and points
// (scene/scene_features.h). If vertices are welded, corners are replaced by their representatives
// (SceneFeatures::name).
PreparedScene TriangleImpacts::at_start(const PreparedScene& scene, const SceneFeatures& features) {
    PreparedScene start = scene;
    start.moving = false;
    start.end = {};
    start.triangles[0] = features.faces();
    if (features.is_welded()) {
        corners_.resize_discard(static_cast<std::size_t>(3 * features.faces()));
        std::transform(scene.corners, scene.corners + 3 * features.faces(), corners_.begin(),
                       [&](std::int32_t vertex) { return features.name(vertex); });
        start.corners = corners_.data();
    }
    return start;
}

bool TriangleImpacts::any_at_start(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features) {
    bool any = false;
    keeping_peak(meter_, [&] { any = backend.any(at_start(scene, features), IntersectionQuery()); });
    return any;
}

void TriangleImpacts::find(BackendBase& backend, const PreparedScene& scene, const SceneFeatures& features,
                           const SceneFilter& rule, const RowLists& found, Statistics& statistics) {
    intersecting_.clear();
    const auto take = [&](const Array<Pair>& some) {
        intersecting_.grow_by(some.size());
        for (const Pair& pair : some) intersecting_.push_back(pair);
    };
    Statistics of_search;
    keeping_peak(meter_, [&] { backend.visit(at_start(scene, features), IntersectionQuery(), take, of_search); });
    add_pass(of_search, statistics);

    list_triangles_of_vertices(scene, features.faces());
    const auto faces = static_cast<std::size_t>(features.faces());
    first_.assign(faces + 2, 0);
    std::int64_t* next = first_.data() + 1;
    for_each_pair(scene, features, rule, found, [&](Pair pair, double, std::uint8_t) { ++next[pair.a + 1]; });
    for (std::size_t i = 0; i < faces; ++i) next[i + 1] += next[i];
    entries_.resize_discard(static_cast<std::size_t>(next[faces]));
    for_each_pair(scene, features, rule, found, [&](Pair pair, double toi, std::uint8_t start) {
        entries_[next[pair.a]++] = {pair.b, start, toi};
    });
    write_rows(backend);
}

void TriangleImpacts::list_triangles_of_vertices(const PreparedScene& scene, std::int64_t triangles) {
    const std::int64_t vertices = scene.vertex_count();
    first_use_.assign(static_cast<std::size_t>(vertices) + 2, 0);
    std::int64_t* next = first_use_.data() + 1;
    const auto for_each_use = [&](auto visit) {
        for (std::int64_t t = 0; t < triangles; ++t) {
            const std::int32_t* c = scene.corners + 3 * t;
            for (int k = 0; k < 3; ++k) visit(c[k], static_cast<std::int32_t>(t));
        }
    };
    for_each_use([&](std::int32_t vertex, std::int32_t) { ++next[vertex + 1]; });
    for (std::int64_t v = 0; v < vertices; ++v) next[v + 1] += next[v];
    uses_.resize_discard(static_cast<std::size_t>(next[vertices]));
    for_each_use([&](std::int32_t vertex, std::int32_t t) { uses_[next[vertex]++] = t; });
}

std::span<const std::int32_t> TriangleImpacts::triangles_of(std::int32_t vertex) const {
    return uses_.span().subspan(static_cast<std::size_t>(first_use_[vertex]),
                                static_cast<std::size_t>(first_use_[vertex + 1] - first_use_[vertex]));
}

/// Calls visit(pair, toi, start) for each pair of triangles that meets, for some pairs more than once.
template <class Visit>
void TriangleImpacts::for_each_pair(const PreparedScene& scene, const SceneFeatures& features, const SceneFilter& rule,
                                    const RowLists& found, Visit visit) const {
    for (const Pair& pair : intersecting_) visit(pair, 0, 1);
    const auto tell = [&](std::int32_t s, std::int32_t t, double toi, std::uint8_t start) {
        if (rule.trivial() || rule(scene.group(s), scene.group(t)))
            visit(Pair{std::min(s, t), std::max(s, t)}, toi, start);
    };
    const auto for_each_of_edge = [&](const Edge& e, auto visit_triangle) {
        for (const std::int32_t t : triangles_of(e.a))
            if (names(scene.corners + 3 * t, e.b)) visit_triangle(t);
    };
    const auto rows = [&](FeatureKind kind, auto visit_row) {
        const FeatureRows& of_kind = found[kind];
        for (std::size_t i = 0; i < of_kind.size(); ++i) visit_row(of_kind.pairs[i], of_kind.value[i], of_kind.flag[i]);
    };
    rows(FeatureKind::vertex_face, [&](Pair pair, double toi, std::uint8_t start) {
        for (const std::int32_t t : triangles_of(features.vertex_of(pair.a))) tell(t, pair.b, toi, start);
    });
    rows(FeatureKind::edge_edge, [&](Pair pair, double toi, std::uint8_t start) {
        for_each_of_edge(features.edges()[pair.a], [&](std::int32_t s) {
            for_each_of_edge(features.edges()[pair.b], [&](std::int32_t t) { tell(s, t, toi, start); });
        });
    });
}

// Sorts the entries of each first triangle by the second triangle, and keeps the entry with the first time for each
// pair. Then writes the rows, one first triangle after another.
void TriangleImpacts::write_rows(ParallelFor& workers) {
    const auto firsts = static_cast<std::int64_t>(first_.size()) - 2;
    kept_.resize_discard(static_cast<std::size_t>(firsts) + 1);
    const auto in_chunks = [&](auto visit) {
        workers.parallel_for(static_cast<std::size_t>((firsts + chunk - 1) / chunk), [&](std::size_t c) {
            const std::int64_t begin = static_cast<std::int64_t>(c) * chunk, end = std::min(firsts, begin + chunk);
            for (std::int64_t i = begin; i < end; ++i) visit(i);
        });
    };
    in_chunks([&](std::int64_t i) {
        Entry *begin = entries_.data() + first_[i], *end = entries_.data() + first_[i + 1];
        std::sort(begin, end, [](const Entry& a, const Entry& b) {
            if (a.second != b.second) return a.second < b.second;
            return a.toi != b.toi ? a.toi < b.toi : a.start > b.start;
        });
        const auto same = [](const Entry& a, const Entry& b) { return a.second == b.second; };
        kept_[i + 1] = std::unique(begin, end, same) - begin;
    });
    kept_[0] = 0;
    for (std::int64_t i = 0; i < firsts; ++i) kept_[i + 1] += kept_[i];
    const auto all = static_cast<std::size_t>(kept_[firsts]);
    rows_.resize_discard(all);
    in_chunks([&](std::int64_t i) {
        const Entry* entry = entries_.data() + first_[i];
        for (auto row = static_cast<std::size_t>(kept_[i]); row < static_cast<std::size_t>(kept_[i + 1]);
             ++row, ++entry)
            rows_.set(row, {{static_cast<std::int32_t>(i), entry->second}, entry->toi, entry->start});
    });
}

}  // namespace crumple
