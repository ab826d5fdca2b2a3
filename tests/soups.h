#pragma once

// Small soups for tests, and comparison of lists of pairs as sets.

#include <algorithm>
#include <array>
#include <cstdint>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "crumple/crumple.h"

namespace crumple {

inline void PrintTo(const Pair& pair, std::ostream* out) { *out << pair.a << ' ' << pair.b; }

namespace test {

template <class Scalar = float>
struct Soup {
    std::vector<std::array<Scalar, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::int32_t> groups;

    MeshView view() const { return {vertices, triangles, groups}; }
};

/// `count` triangles, each with vertices of its own: at most size / 2 along each axis from a random centre in the unit
/// cube.
template <class Scalar = float>
Soup<Scalar> random_soup(int count, double size, unsigned seed = 1) {
    std::mt19937 engine(seed);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-32; };
    Soup<Scalar> soup;
    for (std::int32_t t = 0; t < count; ++t) {
        const std::array<double, 3> centre{number(), number(), number()};
        for (int k = 0; k < 3; ++k) {
            std::array<Scalar, 3> p;
            for (std::size_t axis = 0; axis < 3; ++axis)
                p[axis] = static_cast<Scalar>(centre[axis] + size * (number() - 0.5));
            soup.vertices.push_back(p);
        }
        soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return soup;
}

/// A sheet of n x n quads (2 n^2 triangles) in waves so steep that it crosses itself.
template <class Scalar = float>
Soup<Scalar> wavy_sheet(int n, double amplitude = 0.3) {
    Soup<Scalar> soup;
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n; ++j) {
            const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
            // Triangle waves, one of them sideways, so that folds run into each other.
            const auto wave = [](double x) { return std::abs(x - std::floor(x) - 0.5) - 0.25; };
            soup.vertices.push_back({static_cast<Scalar>(u + amplitude * wave(5 * v)),
                                     static_cast<Scalar>(v + amplitude * wave(7 * u)),
                                     static_cast<Scalar>(amplitude * wave(11 * u) * wave(3 * v + u))});
        }
    for (std::int32_t i = 0; i < n; ++i)
        for (std::int32_t j = 0; j < n; ++j) {
            const std::int32_t a = i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
            soup.triangles.push_back({a, b, d});
            soup.triangles.push_back({a, d, c});
        }
    return soup;
}

inline std::vector<Pair> pairs_of(const Intersections& collisions) {
    return {collisions.pairs.begin(), collisions.pairs.end()};
}

/// Returns "" if both are the same; otherwise the first few pairs that only one of them has.
inline std::string difference(const std::vector<Pair>& expected, const std::vector<Pair>& found) {
    std::string text;
    const auto list = [&](const char* what, const std::vector<Pair>& a, const std::vector<Pair>& b) {
        std::vector<Pair> only;
        std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(only));
        if (only.empty()) return;
        text += std::to_string(only.size()) + what;
        for (std::size_t i = 0; i < std::min<std::size_t>(only.size(), 5); ++i)
            text += " (" + std::to_string(only[i].a) + ", " + std::to_string(only[i].b) + ")";
        text += "; ";
    };
    list(" missing:", expected, found);
    list(" extra:", found, expected);
    if (text.empty() && expected != found) text = "the same set, but repeated or out of order";
    return text;
}

}  // namespace test
}  // namespace crumple
