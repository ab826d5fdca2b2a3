#pragma once

// The tests that a pair of triangles stands for: a vertex that one owns against the other's face, and an edge that one
// owns against an edge that the other owns, less what has a vertex in common. Compiled for host and device.

#include "crumple/collisions.h"
#include "questions/features/record.h"

namespace crumple {

/// A test that has to be made: the features as they are listed, and their four vertices, in the order of FeaturePoints.
struct FeatureTest {
    Pair pair;
    std::int32_t vertex[4];
};

/// Writes the tests of a pair of triangles, and moves behind them: at most 6 of a vertex and a face, 9 of two edges.
/// `name(vertex)`: what it is called where two are compared.
template <int moments, class Name>
CRUMPLE_HD void list_tests_of_pair(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, Name name,
                                   FeatureTest*& vertex_face, FeatureTest*& edge_edge) {
    unsigned shared_a = 0, shared_b = 0;  // corners that the other triangle has as well
    unsigned same[3];                     // of each corner of a: which of b's it is
    const std::int32_t name_b[3] = {name(b.vertex[0]), name(b.vertex[1]), name(b.vertex[2])};
    for (int i = 0; i < 3; ++i) {
        const std::int32_t v = name(a.vertex[i]);
        same[i] = unsigned{v == name_b[0]} | unsigned{v == name_b[1]} << 1 | unsigned{v == name_b[2]} << 2;
        shared_b |= same[i];
        shared_a |= unsigned{same[i] != 0} << i;
    }
    const auto against = [&](unsigned vertices, const FeatureRecord<moments>& of, const FeatureRecord<moments>& face) {
        for (int k = 0; k < 3; ++k) {
            *vertex_face = {{of.vertex[k], face.triangle},
                            {of.vertex[k], face.vertex[0], face.vertex[1], face.vertex[2]}};
            vertex_face += vertices >> k & 1;
        }
    };
    against(a.owned & ~shared_a, a, b);
    against(b.owned & ~shared_b, b, a);
    for (int i = 0; i < 3; ++i) {
        if (!(a.owned >> (3 + i) & 1)) continue;
        const unsigned of_edge = same[i] | same[(i + 1) % 3];
        for (int j = 0; j < 3; ++j) {
            const unsigned ends = 1u << j | 1u << (j + 1) % 3;
            if (!(b.owned >> (3 + j) & 1) || (of_edge & ends)) continue;
            const std::int32_t e[2] = {a.vertex[i], a.vertex[(i + 1) % 3]}, f[2] = {b.vertex[j], b.vertex[(j + 1) % 3]};
            // The lesser edge first, and of an edge the lesser vertex.
            const bool in_order = a.edge[i] < b.edge[j];
            const std::int32_t(&first)[2] = in_order ? e : f, (&second)[2] = in_order ? f : e;
            *edge_edge++ = {{min(a.edge[i], b.edge[j]), max(a.edge[i], b.edge[j])},
                            {min(first[0], first[1]), max(first[0], first[1]), min(second[0], second[1]),
                             max(second[0], second[1])}};
        }
    }
}

}  // namespace crumple
