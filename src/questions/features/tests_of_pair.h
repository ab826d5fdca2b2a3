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

/// Calls vertex_face(test) and edge_edge(test). `name(vertex)`: what it is called where two are compared.
template <int moments, class Name, class VertexFace, class EdgeEdge>
CRUMPLE_HD void for_each_test(const FeatureRecord<moments>& a, const FeatureRecord<moments>& b, Name name,
                              VertexFace vertex_face, EdgeEdge edge_edge) {
    std::int32_t name_a[3], name_b[3];
    unsigned shared_a = 0, shared_b = 0;  // corners that the other triangle has as well
    unsigned same[3] = {0, 0, 0};         // of each corner of a: which of b's it is
    for (int k = 0; k < 3; ++k) name_a[k] = name(a.vertex[k]), name_b[k] = name(b.vertex[k]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (name_a[i] == name_b[j]) same[i] |= 1u << j, shared_a |= 1u << i, shared_b |= 1u << j;
    const auto against = [&](std::int32_t v, const FeatureRecord<moments>& face) {
        vertex_face(FeatureTest{{v, face.triangle}, {v, face.vertex[0], face.vertex[1], face.vertex[2]}});
    };
    for (int k = 0; k < 3; ++k) {
        if ((a.owned & ~shared_a) >> k & 1) against(a.vertex[k], b);
        if ((b.owned & ~shared_b) >> k & 1) against(b.vertex[k], a);
    }
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
            edge_edge(FeatureTest{{min(a.edge[i], b.edge[j]), max(a.edge[i], b.edge[j])},
                                  {min(first[0], first[1]), max(first[0], first[1]), min(second[0], second[1]),
                                   max(second[0], second[1])}});
        }
    }
}

}  // namespace crumple
