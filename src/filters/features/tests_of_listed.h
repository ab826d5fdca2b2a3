#pragma once

// The tests that a pair of triangles or carriers stands for where a caller lists edges and points (SceneFeatures):
// those of tests_of_pair.h, without the faces that carriers are not, points by their place in the list; and tests of
// what carriers own against each other. Compiled for host and device.

#include <array>

#include "filters/features/tests_of_pair.h"
#include "scene/feature_table.h"

namespace crumple {

/// A vertex that `of` owns, against the edge of no triangle that `carrier` owns, unless an edge of the vertex is tested
/// against it. At most 3.
template <int moments>
CRUMPLE_HD void list_vertex_edges(const FeatureRecord<moments>& of, const FeatureRecord<moments>& carrier,
                                  const FeatureTable& features, FeatureTest*& next) {
    if (!(carrier.owned & lone_edge)) return;
    const Edge edge{carrier.vertex[0], carrier.vertex[1]};
    for (int k = 0; k < 3; ++k) {
        const std::int32_t v = of.vertex[k];
        if (!(of.owned >> k & 1) || features.incident(v, edge) || features.has_edge_apart(v, edge)) continue;
        *next++ = {{features.point_of(of.triangle, k), carrier.edge[0]}, {v, edge.a, edge.b, edge.b}};
    }
}

/// Two vertices of no triangle and no edge. At most 1.
template <int moments>
CRUMPLE_HD void list_vertex_vertices(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b,
                                     const FeatureTable& features, FeatureTest*& next) {
    const std::int32_t v = a.vertex[0], w = b.vertex[0];
    if (!(a.owned & b.owned & lone_point) || features.name(v) == features.name(w)) return;
    const std::int32_t p = features.point_of(a.triangle, 0), q = features.point_of(b.triangle, 0);
    *next++ = {{min(p, q), max(p, q)}, {v, w, w, w}};
}

/// Drops tests with faces that are carriers, and calls vertices points. `next`: behind the last test of the pair.
template <int moments>
CRUMPLE_HD void keep_faces(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b,
                           const FeatureTable& features, FeatureTest* test, FeatureTest*& next) {
    const auto point = [&](const FeatureRecord<moments>& of, std::int32_t v) {
        int k = 0;
        while (!(of.owned >> k & 1) || of.vertex[k] != v) ++k;
        return features.point_of(of.triangle, k);
    };
    FeatureTest* kept = test;
    for (; test != next; ++test) {
        if (test->pair.b >= features.faces) continue;
        *kept = *test;
        kept->pair.a = point(test->pair.b == b.triangle ? a : b, test->pair.a);
        ++kept;
    }
    next = kept;
}

/// Writes all tests of a pair of triangles or carriers, by kind, and moves behind them: at most 6, 9, 4, and 1.
template <int moments, class Name>
CRUMPLE_HD void list_tests_of_listed(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b,
                                     const FeatureTable& features, Name name,
                                     std::array<FeatureTest*, feature_kinds>& next) {
    FeatureTest* vertex_face = next[0];
    list_tests_of_pair(a, b, name, next[0], next[1]);
    keep_faces(a, b, features, vertex_face, next[0]);
    list_vertex_edges(a, b, features, next[2]);
    list_vertex_edges(b, a, features, next[2]);
    list_vertex_vertices(a, b, features, next[3]);
}

}  // namespace crumple
