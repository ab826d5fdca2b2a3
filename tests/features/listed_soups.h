#pragma once

// Soups with codimensional edges and points of many kinds: of all triangles or of none, in any order, some twice.

#include <algorithm>
#include <numeric>
#include <set>

#include "features/moving_soups.h"

namespace crumple::test {

inline std::vector<Edge> edges_of(const MovingSoup<>& soup) {
    std::set<Edge> all;
    for (const auto& t : soup.triangles)
        for (std::size_t k = 0; k < 3; ++k)
            if (t[k] != t[(k + 1) % 3]) all.insert({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    return {all.begin(), all.end()};
}

template <class T>
void shuffle(Draw& draw, std::vector<T>& list) {
    for (std::size_t i = list.size(); i > 1; --i)
        std::swap(list[i - 1], list[static_cast<std::size_t>(draw.below(static_cast<int>(i)))]);
}

/// Returns some edges of triangles and some others, in either direction, some of them twice.
inline std::vector<Edge> some_edges(Draw& draw, const MovingSoup<>& soup, double of_triangles) {
    const auto n = static_cast<int>(soup.start.size());
    std::vector<Edge> list;
    for (const Edge& e : edges_of(soup))
        if (draw.number() < of_triangles) list.push_back(draw.below(2) ? e : Edge{e.b, e.a});
    for (int i = 0; i < n / 2; ++i) {
        const int a = draw.below(n), b = draw.below(n);
        if (a != b) list.push_back({a, b});
    }
    for (int i = 0; i < n / 8 && !list.empty(); ++i) {
        const Edge e = list[static_cast<std::size_t>(draw.below(static_cast<int>(list.size())))];
        list.push_back({e.b, e.a});
    }
    shuffle(draw, list);
    return list;
}
inline std::vector<std::int32_t> some_points(Draw& draw, const MovingSoup<>& soup) {
    const auto n = static_cast<int>(soup.start.size());
    std::vector<std::int32_t> list;
    for (std::int32_t v = 0; v < n; ++v)
        for (int times = draw.below(10); times >= 3; times -= 6) list.push_back(v);
    shuffle(draw, list);
    return list;
}

/// Returns the soup with none, a third or two thirds of its triangles and, for most seeds, with codimensional edges and
/// points of many kinds.
template <class Scalar>
MovingSoup<Scalar> with_lists(const MovingSoup<Scalar>& from, unsigned seed) {
    Draw draw(seed);
    MovingSoup<> soup{{}, {}, from.triangles, {}};
    soup.start.resize(from.start.size());
    shuffle(draw, soup.triangles);
    soup.triangles.resize(soup.triangles.size() * (seed % 3) / 3);
    const auto n = static_cast<std::int32_t>(from.start.size());
    if (seed % 5 > 0 && n > 0) soup.edges = some_edges(draw, soup, seed % 5 == 4 ? 1 : 0.5);
    if (seed % 5 == 2 && soup.edges) soup.edges->resize(soup.edges->size() / 4);
    const unsigned kind = seed / 3 % 4;
    if (kind == 1) soup.points = some_points(draw, soup);
    if (kind == 2) {
        soup.points.emplace(static_cast<std::size_t>(n));
        std::iota(soup.points->begin(), soup.points->end(), 0);
    }
    if (kind == 3) soup.points.emplace();
    return {from.start, from.end, soup.triangles, {}, soup.edges, soup.points};
}

}  // namespace crumple::test
