#pragma once

// Tests of pairs of features that a pair of triangles stands for: each vertex that one triangle owns against the face
// of the other, and each edge that one owns against each edge that the other owns, except for features with a common
// vertex. Each vertex and edge has one owner (scene/scene_features.h). Compiled for host and device.

#include "crumple/features.h"
#include "crumple/intersections.h"
#include "filters/features/feature_record.h"

namespace crumple {

/// Test of two features: their indices in the scene, and their four vertices in the order of FeaturePoints.
struct FeatureTest {
    Pair pair;
    std::int32_t vertex[4];
};

/// Tests of a pair of triangles, as bits. vertex_face: bit k for the vertex at corner k of the first triangle against
/// the second, bit 3 + k the other way round. edge_edge: bit 4 i + j for edge i of the first and edge j of the second.
struct TestsOfPair {
    unsigned vertex_face = 0, edge_edge = 0;
};

/// Returns the tests of a pair. `name(vertex)` returns the vertex's representative: vertices that welding merges have
/// the same one, and count as one vertex.
template <int moments, class Name>
CRUMPLE_HD TestsOfPair tests_of_pair(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, Name name) {
    unsigned shared_a = 0, shared_b = 0;  // corners that the other triangle has, too
    unsigned same[3];                     // by corner of a: corners of b that are equal, as bits
    const std::int32_t name_b[3] = {name(b.vertex[0]), name(b.vertex[1]), name(b.vertex[2])};
    for (int i = 0; i < 3; ++i) {
        const std::int32_t v = name(a.vertex[i]);
        same[i] = unsigned{v == name_b[0]} | unsigned{v == name_b[1]} << 1 | unsigned{v == name_b[2]} << 2;
        shared_b |= same[i];
        shared_a |= unsigned{same[i] != 0} << i;
    }
    TestsOfPair tests;
    tests.vertex_face = (a.owned & ~shared_a & 7) | (b.owned & ~shared_b & 7) << 3;
    for (int i = 0; i < 3; ++i) {
        const unsigned of_edge = same[i] | same[(i + 1) % 3];
        const unsigned touched = of_edge | (of_edge >> 1) | (of_edge << 2);  // edges of b with such a corner
        if (a.owned >> (3 + i) & 1) tests.edge_edge |= (b.owned >> 3 & ~touched & 7) << 4 * i;
    }
    return tests;
}

/// Writes the vertices of the test that a bit of TestsOfPair stands for: the vertex and then the face's vertices, or
/// the vertices of an edge of a and then of one of b.
template <FeatureKind kind, int moments>
CRUMPLE_HD void vertices_of_test(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, unsigned bit,
                                 std::int32_t (&vertex)[4]) {
    if constexpr (kind == FeatureKind::vertex_face) {
        const bool swapped = bit >= 3;
        const FeatureRecord<moments>&of = swapped ? b : a, &face = swapped ? a : b;
        vertex[0] = of.vertex[swapped ? bit - 3 : bit];
        for (int k = 0; k < 3; ++k) vertex[1 + k] = face.vertex[k];
    } else {
        const unsigned i = bit >> 2, j = bit & 3;
        vertex[0] = a.vertex[i], vertex[1] = a.vertex[i == 2 ? 0 : i + 1];
        vertex[2] = b.vertex[j], vertex[3] = b.vertex[j == 2 ? 0 : j + 1];
    }
}

/// Writes the test that a bit of TestsOfPair stands for, in the order that the exact decision expects: the lower edge
/// first, and each edge's lower vertex first.
template <FeatureKind kind, int moments>
CRUMPLE_HD void write_test(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, unsigned bit,
                           FeatureTest& test) {
    if constexpr (kind == FeatureKind::vertex_face) {
        vertices_of_test<kind>(a, b, bit, test.vertex);
        test.pair = {test.vertex[0], bit >= 3 ? a.triangle : b.triangle};
    } else {
        std::int32_t v[4];
        vertices_of_test<kind>(a, b, bit, v);
        const std::int32_t e = a.edge[bit >> 2], f = b.edge[bit & 3];
        const int first = e < f ? 0 : 2, second = 2 - first;
        test.pair = {min(e, f), max(e, f)};
        test.vertex[first] = min(v[0], v[1]), test.vertex[first + 1] = max(v[0], v[1]);
        test.vertex[second] = min(v[2], v[3]), test.vertex[second + 1] = max(v[2], v[3]);
    }
}

/// Writes the tests of a pair of triangles and advances both pointers: at most 6 tests of a vertex and a face, 9 of two
/// edges.
template <int moments, class Name>
CRUMPLE_HD void list_tests_of_pair(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, Name name,
                                   FeatureTest*& vertex_face, FeatureTest*& edge_edge) {
    const TestsOfPair tests = tests_of_pair(a, b, name);
    for (unsigned bit = 0; bit < 6; ++bit)
        if (tests.vertex_face >> bit & 1) write_test<FeatureKind::vertex_face>(a, b, bit, *vertex_face++);
    for (unsigned bit = 0; bit < 11; ++bit)
        if (tests.edge_edge >> bit & 1) write_test<FeatureKind::edge_edge>(a, b, bit, *edge_edge++);
}

}  // namespace crumple
