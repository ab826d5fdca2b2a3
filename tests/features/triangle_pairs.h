#pragma once

// Definition of the triangle pairs of a step (ImpactQuery::triangle_pairs): those that intersect at the start, found by
// brute force, and, for each impact, every two triangles that have its features.

#include <map>

#include "features/tested_detectors.h"

namespace crumple::test {

struct TrianglePair {
    double toi;
    bool start;
    friend bool operator==(const TrianglePair&, const TrianglePair&) = default;
};
using TrianglePairs = std::map<Pair, TrianglePair>;

/// Returns the triangle pairs of a step. `impacts`: the impacts to consider, and the edges of the soup.
template <class Scalar>
TrianglePairs triangle_pairs_of(const MovingSoup<Scalar>& soup, const Impacts& impacts, bool weld) {
    TrianglePairs all;
    const auto add = [&](std::int32_t s, std::int32_t t, double toi, bool start) {
        if (s == t) return;
        const auto [at, fresh] = all.insert({{std::min(s, t), std::max(s, t)}, {toi, start}});
        if (!fresh && toi <= at->second.toi) at->second = {toi, start || (toi == at->second.toi && at->second.start)};
    };
    // With welding, replaces vertices that have the same positions at both times by one of them.
    std::map<std::pair<PointOf<Scalar>, PointOf<Scalar>>, std::int32_t> lowest;
    MovingSoup<Scalar> named = soup;
    if (weld)
        for (auto& triangle : named.triangles)
            for (std::int32_t& v : triangle) {
                auto key = std::pair(soup.start[static_cast<std::size_t>(v)], soup.end[static_cast<std::size_t>(v)]);
                for (auto* point : {&key.first, &key.second})
                    for (Scalar& x : *point) x += 0;  // -0 becomes +0
                v = lowest.emplace(key, v).first->second;
            }
    named.groups.clear();
    for (const Pair& pair : reference().find(named.view()).pairs) add(pair.a, pair.b, 0, true);

    const auto names = [&](std::size_t t, std::int32_t v) {
        return std::find(soup.triangles[t].begin(), soup.triangles[t].end(), v) != soup.triangles[t].end();
    };
    const auto for_each_with = [&](std::initializer_list<std::int32_t> vertices, auto visit) {
        for (std::size_t t = 0; t < soup.triangles.size(); ++t)
            if (std::all_of(vertices.begin(), vertices.end(), [&](std::int32_t v) { return names(t, v); }))
                visit(static_cast<std::int32_t>(t));
    };
    const ImpactList& faces = impacts.vertex_faces();
    for (std::size_t i = 0; i < faces.pairs.size(); ++i) {
        const std::int32_t p = faces.pairs[i].a, v = soup.points ? (*soup.points)[static_cast<std::size_t>(p)] : p;
        for_each_with({v}, [&](std::int32_t t) { add(t, faces.pairs[i].b, faces.toi[i], faces.start[i]); });
    }
    const ImpactList& edges = impacts.edge_edges();
    for (std::size_t i = 0; i < edges.pairs.size(); ++i) {
        const Edge e = impacts.edges[edges.pairs[i].a], f = impacts.edges[edges.pairs[i].b];
        for_each_with({e.a, e.b}, [&](std::int32_t s) {
            for_each_with({f.a, f.b}, [&](std::int32_t t) { add(s, t, edges.toi[i], edges.start[i]); });
        });
    }
    return all;
}

inline TrianglePairs listed(const ImpactList& list) {
    TrianglePairs all;
    for (std::size_t i = 0; i < list.pairs.size(); ++i) all[list.pairs[i]] = {list.toi[i], list.start[i] != 0};
    EXPECT_EQ(all.size(), list.pairs.size()) << "each once";
    EXPECT_TRUE(std::is_sorted(list.pairs.begin(), list.pairs.end()));
    return all;
}

}  // namespace crumple::test
