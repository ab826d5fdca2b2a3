#pragma once

// Tests of a pair of triangles or proxy triangles (degenerate triangles that own edges or points which no triangle
// owns), for scenes that have proxy triangles or whose points have other indices than their vertices
// (SceneFeatures::plain() is false). These are the tests of tests_of_pair.h, without the faces of proxy triangles and
// with point indices instead of vertex indices; and tests of lone edges, which belong to no face, and of lone points,
// which belong to no face and no edge. Compiled for host and device.

#include <array>

#include "filters/features/tests_of_pair.h"
#include "scene/feature_table.h"

namespace crumple {

/// Lists tests of the vertices that `of` owns against the lone edge that `proxy` owns, if it owns one. Skips a vertex
/// if a test of one of its edges against the lone edge covers it. At most 3 tests.
template <int moments>
CRUMPLE_HD void list_vertex_edges(const FeatureRecord<moments>& of, const FeatureRecord<moments>& proxy,
                                  const FeatureTable& features, FeatureTest*& next) {
    if (!(proxy.owned & lone_edge)) return;
    const Edge edge{proxy.vertex[0], proxy.vertex[1]};
    for (int k = 0; k < 3; ++k) {
        const std::int32_t v = of.vertex[k];
        if (!(of.owned >> k & 1) || features.incident(v, edge) || features.has_edge_apart(v, edge)) continue;
        *next++ = {{features.point_of(of.triangle, k), proxy.edge[0]}, {v, edge.a, edge.b, edge.b}};
    }
}

/// Lists the test of two vertices of no triangle and no edge, if a and b own one each. At most 1 test.
template <int moments>
CRUMPLE_HD void list_vertex_vertices(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b,
                                     const FeatureTable& features, FeatureTest*& next) {
    const std::int32_t v = a.vertex[0], w = b.vertex[0];
    if (!(a.owned & b.owned & lone_point) || features.name(v) == features.name(w)) return;
    const std::int32_t p = features.point_of(a.triangle, 0), q = features.point_of(b.triangle, 0);
    *next++ = {{min(p, q), max(p, q)}, {v, w, w, w}};
}

/// Drops tests of a vertex and a face whose faces are proxy triangles, and replaces vertex indices by point indices.
/// `test`: first test of the pair; `next`: end of its tests.
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

/// Writes all tests of a pair of triangles or proxy triangles, and advances `next`, which has an element for each
/// FeatureKind: by at most 6, 9, 4, and 1. `name`: see tests_of_pair().
template <int moments, class Name>
CRUMPLE_HD void list_codimensional_tests(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b,
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
