#pragma once

// Random closed bodies, and comparison of two results for such bodies.

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <vector>

#include "crumple/crumple.h"
#include "results/overlap_arrays.h"
#include "worlds/random_worlds.h"

namespace crumple::test {

/// Closed bodies, each of one or two tetrahedra and boxes, which may meet; on a grid or not, some inside out.
struct ClosedBodies {
    std::vector<Soup<double>> soups;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;

    World view() const { return {shapes, bodies, poses}; }
};

/// Query that computes everything.
inline const OverlapQuery everything{.self_overlaps = true,
                                     .gradient = true,
                                     .curves = true,
                                     .windings = true,
                                     .depths = true,
                                     .depth_tolerance = 0.5,
                                     .directions = {{1, 0, 0}, {-1, 2, 0.25}},
                                     .first_free = true,
                                     .translation = true,
                                     .unions = true,
                                     .regions = true};

/// The same without first free motions, which take most of the time.
inline const OverlapQuery all_but_first_free = [] {
    OverlapQuery query = everything;
    query.first_free = false;
    return query;
}();

inline void add_tetrahedron(Dice& dice, bool grid, double size, Soup<double>& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (int v = 0; v < 4; ++v) {
        auto& p = soup.vertices.emplace_back();
        for (double& x : p) x = grid ? dice.below(5) : dice.between(0, size);
    }
    const std::array<std::array<std::int32_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
    for (const auto& [a, b, c] : faces) soup.triangles.push_back({first + a, first + b, first + c});
}

inline void add_box(Dice& dice, bool grid, double size, Soup<double>& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    std::array<double, 3> low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] = grid ? dice.below(3) : dice.between(0, size);
        high[k] = grid ? low[k] + 1 + dice.below(2) : low[k] + dice.between(0, size);
    }
    for (int v = 0; v < 8; ++v) {
        auto& p = soup.vertices.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) p[k] = v >> k & 1 ? high[k] : low[k];
    }
    const std::array<std::array<std::int32_t, 3>, 12> faces{{{0, 2, 1},
                                                             {1, 2, 3},
                                                             {4, 5, 6},
                                                             {5, 7, 6},
                                                             {0, 1, 4},
                                                             {1, 5, 4},
                                                             {2, 6, 3},
                                                             {3, 6, 7},
                                                             {0, 4, 2},
                                                             {2, 4, 6},
                                                             {1, 3, 5},
                                                             {3, 7, 5}}};
    for (const auto& [a, b, c] : faces) soup.triangles.push_back({first + a, first + b, first + c});
}

inline ClosedBodies closed_bodies(unsigned seed, int bodies, bool grid, bool posed) {
    Dice dice(seed);
    ClosedBodies all;
    all.soups.resize(static_cast<std::size_t>(bodies));
    for (auto& soup : all.soups)
        for (int part = 1 + dice.below(2); part > 0; --part)
            dice.chance(0.5) ? add_box(dice, grid, 2, soup) : add_tetrahedron(dice, grid, 3, soup);
    if (dice.chance(0.2)) all.soups[1] = all.soups[0];
    for (int b = 0; b < bodies; ++b) {
        all.shapes.emplace_back(all.soups[static_cast<std::size_t>(b)].view());
        all.bodies.push_back({.shape = b, .group = dice.below(2), .self = true});
        all.poses.push_back(posed ? random_pose(dice, 0.5) : Pose{});
    }
    return all;
}

/// Makes a T-junction: a degenerate triangle between the first edge and its two halves.
inline void add_t_junction(Soup<double>& soup) {
    const auto [a, b, c] = soup.triangles[0];
    const auto middle = static_cast<std::int32_t>(soup.vertices.size());
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < 3; ++k)
        p[k] = (soup.vertices[static_cast<std::size_t>(a)][k] + soup.vertices[static_cast<std::size_t>(b)][k]) / 2;
    soup.vertices.push_back(p);
    soup.triangles[0] = {a, middle, c};
    soup.triangles.push_back({middle, b, c});
    soup.triangles.push_back({a, b, middle});
}

/// Returns both soups as one body.
inline Soup<double> joined(Soup<double> soup, const Soup<double>& other) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [x, y, z] : other.triangles) soup.triangles.push_back({first + x, first + y, first + z});
    return soup;
}

/// Returns the name of the first array in which two results differ by a byte, or an empty string.
inline std::string difference(const Overlaps& x, const Overlaps& y) {
    const auto differ = [](const auto& a, const auto& b) {
        return a.size() != b.size() || (!a.empty() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) != 0);
    };
    if (x.any != y.any) return "any";
    if (x.count != y.count) return "count";
    std::string different;
    for_each_overlap_array([&](const char* name, auto array, OverlapLevel) {
        if (different.empty() && differ(x.*array, y.*array)) different = name;
    });
    return different;
}

/// Returns the name of the first part in which two results with containment differ, or an empty string.
inline std::string difference(const Intersections& x, const Intersections& y) {
    const auto differ = [](const auto& a, const auto& b) {
        return !std::equal(a.begin(), a.end(), b.begin(), b.end());
    };
    if (x.any != y.any) return "any";
    if (x.count != y.count) return "count";
    if (differ(x.world_hit, y.world_hit)) return "world_hit";
    if (differ(x.bodies, y.bodies)) return "bodies";
    if (differ(x.inside, y.inside)) return "inside";
    if (differ(x.skipped, y.skipped)) return "skipped";
    return {};
}

}  // namespace crumple::test
