#pragma once

// Handmade results of feature queries, of one mesh or of two bodies.

#include <cmath>

#include "crumple/io_features.h"

namespace crumple::io::test {

template <class T>
Array<T> array(std::initializer_list<T> values) {
    Array<T> result;
    for (const T& value : values) result.push_back(value);
    return result;
}

template <class List>
void add(List& list, Pair pair, BodyPair bodies, bool has_bodies) {
    list.pairs.push_back(pair);
    if (has_bodies) list.bodies.push_back(bodies);
}

template <class Result>
Result lists(bool has_bodies) {
    Result a;
    auto &faces = a[FeatureKind::vertex_face], &edges = a[FeatureKind::edge_edge];
    add(faces, {7, 1}, {0, 1}, has_bodies);
    add(faces, {9, 0}, {has_bodies ? 1 : 0, 0}, has_bodies);
    add(edges, {1, 2}, {0, has_bodies ? 1 : 0}, has_bodies);
    a.edges = array<Edge>({{0, 1}, {0, 7}, {2, 9}});
    a.first_edge = array<std::int64_t>({0, 3});
    if (has_bodies) {  // body 1 has an edge more than body 0
        a.edges = array<Edge>({{0, 1}, {0, 7}, {2, 3}, {2, 4}, {2, 9}});
        a.first_edge = array<std::int64_t>({0, 2, 5});
    }
    a.any = true;
    a.count = 3;
    a.statistics.pairs = 3;
    a.statistics.backend = "cpu";
    return a;
}

inline Impacts example_impacts(bool has_bodies = false) {
    Impacts a = lists<Impacts>(has_bodies);
    a[FeatureKind::vertex_face].toi = array({0.1, 1.0});
    a[FeatureKind::vertex_face].start = array<std::uint8_t>({0, 0});
    a[FeatureKind::edge_edge].toi = array({0.0});
    a[FeatureKind::edge_edge].start = array<std::uint8_t>({1});
    a.first = {true, FeatureKind::edge_edge, {1, 2}, {0, has_bodies ? 1 : 0}, 0.0, true};
    return a;
}

inline Proximities example_near(bool has_bodies = false) {
    Proximities a = lists<Proximities>(has_bodies);
    a[FeatureKind::vertex_face].squared_distance = array({5e-324, HUGE_VAL});
    a[FeatureKind::vertex_face].touching = array<std::uint8_t>({0, 0});
    a[FeatureKind::edge_edge].squared_distance = array({0.0});
    a[FeatureKind::edge_edge].touching = array<std::uint8_t>({1});
    return a;
}

}  // namespace crumple::io::test
