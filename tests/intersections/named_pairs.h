#pragma once

// Pairs of triangles whose result follows from the contract by inspection.

#include <vector>

#include "geometry/random_pairs.h"

namespace crumple {

struct NamedPair {
    const char* claim;
    TrianglePair pair;
    bool collides, proper;
    int shared;
    std::vector<Vec3d> points;  ///< extreme points of the intersection, in the order of the contract
};

inline NamedPair named(const char* claim, const TrianglePair& pair, bool collides, bool proper, int shared,
                       const std::vector<Vec3d>& points) {
    return {claim, pair, collides, proper, shared, points};
}

inline std::vector<NamedPair> named_pairs() {
    const Vec3d o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0}, z{0, 0, 4};
    const auto triangle = [](Vec3d a, Vec3d b, Vec3d c, int i, int j, int k) { return Triangle{{a, b, c}, {i, j, k}}; };
    const Triangle floor = triangle(o, x, y, 0, 1, 2);
    const auto other = [&](Vec3d a, Vec3d b, Vec3d c, int i = 3, int j = 4, int k = 5) {
        return TrianglePair{floor, triangle(a, b, c, i, j, k)};
    };
    return {
        named("triangles apart do not collide", other({0, 0, 1}, {4, 0, 1}, {0, 4, 1}), false, false, 0, {}),
        named("an edge through the inside is a proper crossing", other({1, 1, -1}, {1, 1, 1}, {9, 9, 1}), true, true, 0,
              {{1, 1, 0}, {2, 2, 0}}),
        named("touching at one point counts", other({1, 1, 0}, {1, 1, 2}, {2, 1, 2}), true, false, 0, {{1, 1, 0}}),
        named("touching corner to corner counts", other(x, {8, 0, 0}, {8, 0, 4}), true, false, 0, {x}),
        named("an edge on the inside counts", other({1, 1, 0}, {2, 1, 0}, {1, 1, 3}), true, false, 0,
              {{1, 1, 0}, {2, 1, 0}}),
        named("an edge on an edge counts", other({1, 0, 0}, {9, 0, 0}, {1, 0, 3}), true, false, 0, {{1, 0, 0}, x}),
        named("crossing only at an edge is not proper", other({2, 0, -1}, {2, 0, 1}, {2, -5, 0}), true, false, 0,
              {{2, 0, 0}}),
        named("crossing only at a corner is not proper", other({0, 0, -1}, {0, 0, 1}, {-5, -5, 0}), true, false, 0,
              {o}),
        named("coplanar triangles overlap in an area", other({1, 1, 0}, {5, 1, 0}, {1, 5, 0}), true, false, 0,
              {{1, 1, 0}, {3, 1, 0}, {1, 3, 0}}),
        named("areas go around the first triangle's normal",
              {triangle(o, y, x, 0, 1, 2), triangle({1, 1, 0}, {5, 1, 0}, {1, 5, 0}, 3, 4, 5)}, true, false, 0,
              {{1, 1, 0}, {1, 3, 0}, {3, 1, 0}}),
        named("an area may have six corners",
              {triangle({0, 0, 0}, {6, 0, 0}, {3, 6, 0}, 0, 1, 2), triangle({0, 4, 0}, {3, -2, 0}, {6, 4, 0}, 3, 4, 5)},
              true, false, 0, {{1, 2, 0}, {2, 0, 0}, {4, 0, 0}, {5, 2, 0}, {4, 4, 0}, {2, 4, 0}}),
        named("a triangle inside another one in its plane counts", other({1, 1, 0}, {2, 1, 0}, {1, 2, 0}), true, false,
              0, {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}),
        named("coplanar triangles apart do not collide", other({3, 3, 0}, {5, 1, 0}, {5, 5, 0}), false, false, 0, {}),
        named("a hinge does not collide", other(o, x, z, 0, 1, 5), false, false, 2, {o, x}),
        named("a flat hinge does not collide", other(o, x, {4, -4, 0}, 0, 1, 5), false, false, 2, {o, x}),
        named("a fold counts", other(o, x, {1, 1, 0}, 0, 1, 5), true, false, 2, {o, x, {1, 1, 0}}),
        named("neighbours at a corner do not collide", other(o, {-4, 0, 1}, {0, -4, 1}, 0, 4, 5), false, false, 1, {o}),
        named("flat neighbours at a corner do not collide", other(o, {-4, 0, 0}, {0, -4, 0}, 0, 4, 5), false, false, 1,
              {o}),
        named("neighbours at a corner that lie on each other count", other(o, {2, 2, 0}, {0, 8, 0}, 0, 4, 5), true,
              false, 1, {o, {2, 2, 0}, y}),
        named("neighbours at a corner along a common edge count", other(o, {2, 0, 0}, {0, -4, 0}, 0, 4, 5), true, false,
              1, {o, {2, 0, 0}}),
        named("neighbours at a corner that cross count", other(o, {1, 1, -1}, {1, 1, 1}, 0, 4, 5), true, true, 1,
              {o, {1, 1, 0}}),
        named("neighbours at a corner that cross away from each other do not collide",
              other(o, {-2, -2, -2}, {-2, -2, 2}, 0, 4, 5), false, false, 1, {o}),
        named("a duplicated face counts", other(x, y, o, 1, 2, 0), true, false, 3, {o, x, y}),
        named("a copy under other ids counts", other(o, x, y), true, false, 0, {o, x, y}),
        named("[a, a, b] names two vertices", other(o, o, x, 0, 0, 1), false, false, 2, {o, x}),
        named("[a, a, d] that leaves the shared vertex counts", other(o, o, {2, 1, 0}, 0, 0, 5), true, false, 1,
              {o, {2, 1, 0}}),
        named("a segment through the inside is a proper crossing", other({1, 1, -1}, {1, 1, 0}, {1, 1, 1}), true, true,
              0, {{1, 1, 0}}),
        named("a point on a triangle counts", other({1, 1, 0}, {1, 1, 0}, {1, 1, 0}), true, false, 0, {{1, 1, 0}}),
        named("a point beside a triangle does not collide", other({3, 3, 0}, {3, 3, 0}, {3, 3, 0}), false, false, 0,
              {}),
        named("crossing segments collide",
              {triangle(o, x, x, 0, 1, 2), triangle({1, -1, 0}, {1, 1, 0}, {1, 0, 0}, 3, 4, 5)}, true, false, 0,
              {{1, 0, 0}}),
        named("segments on one line overlap in a segment",
              {triangle(x, o, {1, 0, 0}, 0, 1, 2), triangle({3, 0, 0}, {9, 0, 0}, {5, 0, 0}, 3, 4, 5)}, true, false, 0,
              {{3, 0, 0}, x}),
        named("equal points collide", {triangle(x, x, x, 0, 0, 0), triangle(x, x, x, 3, 3, 3)}, true, false, 0, {x}),
        named("a point meets itself in what it shares", {triangle(x, x, x, 0, 0, 0), triangle(x, x, x, 0, 0, 0)}, false,
              false, 1, {x}),
    };
}

}  // namespace crumple
