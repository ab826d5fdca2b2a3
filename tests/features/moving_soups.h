#pragma once

// Small moving soups with exact special cases: on integer grids, in one plane, on one line; contact at the start, at
// the end, or throughout; triangles that collapse, repeat, or use a vertex twice.

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soups.h"

namespace crumple::test {

template <class Scalar>
using PointOf = std::array<Scalar, 3>;

/// A mesh at the start of a step, and the positions of its vertices at the end.
template <class Scalar = double>
struct MovingSoup {
    std::vector<PointOf<Scalar>> start, end;
    std::vector<std::array<std::int32_t, 3>> triangles;
    std::vector<std::int32_t> groups;
    std::optional<std::vector<Edge>> edges = {};
    std::optional<std::vector<std::int32_t>> points = {};

    MeshView view() const {
        MeshView view(start, triangles, groups);
        if (edges) view.edges = *edges;
        if (points) view.points = *points;
        return view;
    }
    MeshView view_at_end() const { return {end, triangles, groups}; }
    VertexView end_view() const { return view_at_end().vertices; }

    std::int32_t vertex(const PointOf<Scalar>& from, const PointOf<Scalar>& to) {
        start.push_back(from);
        end.push_back(to);
        return static_cast<std::int32_t>(start.size()) - 1;
    }
    void append(const MovingSoup& other) {
        const auto first = static_cast<std::int32_t>(start.size());
        start.insert(start.end(), other.start.begin(), other.start.end());
        end.insert(end.end(), other.end.begin(), other.end.end());
        for (const auto& [a, b, c] : other.triangles) triangles.push_back({first + a, first + b, first + c});
    }
};

/// Returns the soup with every coordinate changed and then rounded to another precision.
template <class To, class From, class Change>
MovingSoup<To> changed(const MovingSoup<From>& soup, Change change) {
    MovingSoup<To> out{{}, {}, soup.triangles, soup.groups, soup.edges, soup.points};
    const auto all = [&](const auto& points, auto& into) {
        for (const auto& p : points) {
            PointOf<To> q;
            for (std::size_t axis = 0; axis < 3; ++axis) q[axis] = static_cast<To>(change(p[axis]));
            into.push_back(q);
        }
    };
    all(soup.start, out.start);
    all(soup.end, out.end);
    return out;
}
template <class To, class From>
MovingSoup<To> rounded(const MovingSoup<From>& soup) {
    return changed<To>(soup, [](From x) { return x; });
}

/// Random integers, the same on every machine.
class Draw {
   public:
    explicit Draw(unsigned seed) : engine_(seed) {}
    int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
    double integer(int low, int high) { return low + below(high - low + 1); }
    double number() { return static_cast<double>(engine_()) * 0x1p-32; }
    PointOf<double> grid(int width) { return {integer(0, width - 1), integer(0, width - 1), integer(0, width - 1)}; }

   private:
    std::mt19937 engine_;
};

/// Adds random triangles among the soup's vertices: adjacent ones of every kind, vertices used twice, repeated faces.
inline void connect(Draw& draw, int triangles, MovingSoup<>& soup) {
    const auto n = static_cast<int>(soup.start.size());
    for (int i = 0; i < triangles; ++i) {
        const int a = draw.below(n), b = draw.below(n);
        soup.triangles.push_back({a, b, draw.below(n)});
        if (draw.below(10) == 0) soup.triangles.push_back(soup.triangles[static_cast<std::size_t>(draw.below(i + 1))]);
    }
}
/// Returns a soup in which each vertex moves from one random point to another.
template <class Point>
MovingSoup<> any_soup(unsigned seed, int vertices, int triangles, Point point) {
    Draw draw(seed);
    MovingSoup<> soup;
    for (int i = 0; i < vertices; ++i) {
        const auto from = point(draw);
        soup.vertex(from, point(draw));
    }
    connect(draw, triangles, soup);
    return soup;
}

inline MovingSoup<> moving_grid(int width, int vertices, int triangles, unsigned seed) {
    return any_soup(seed, vertices, triangles, [&](Draw& draw) { return draw.grid(width); });
}
/// All vertices stay in the plane x + y + z = 0.
inline MovingSoup<> moving_in_a_plane(int vertices, int triangles, unsigned seed) {
    return any_soup(seed, vertices, triangles, [](Draw& draw) {
        const double x = draw.integer(-3, 3), y = draw.integer(-3, 3);
        return PointOf<double>{x, y, -x - y};
    });
}
inline MovingSoup<> moving_in_a_line(int vertices, int triangles, unsigned seed) {
    return any_soup(seed, vertices, triangles, [](Draw& draw) {
        const double t = draw.integer(-6, 6);
        return PointOf<double>{t, -t, 2 * t};
    });
}
/// All vertices are on one line at time 1/2, where normals vanish and roots are double and triple.
inline MovingSoup<> moving_through_a_line(int vertices, int triangles, unsigned seed) {
    Draw draw(seed);
    MovingSoup<> soup;
    for (int i = 0; i < vertices; ++i) {
        const double t = draw.integer(-4, 4);
        const PointOf<double> way = draw.grid(5);
        soup.vertex({t - way[0], -t - way[1], 2 * t - way[2]}, {t + way[0], -t + way[1], 2 * t + way[2]});
    }
    connect(draw, triangles, soup);
    return soup;
}
/// Vertices on a grid, half of which stay; the others move along z or by (1, -1, 0). Triangles touch at the start, at
/// the end, or throughout.
inline MovingSoup<> mostly_static(int width, int vertices, int triangles, unsigned seed) {
    Draw draw(seed);
    MovingSoup<> soup;
    for (int i = 0; i < vertices; ++i) {
        const PointOf<double> from = draw.grid(width);
        PointOf<double> to = from;
        const int kind = draw.below(4);
        if (kind == 1) to[2] += draw.integer(-2, 2);
        if (kind == 2) to[0] += 1, to[1] -= 1;
        soup.vertex(from, to);
    }
    connect(draw, triangles, soup);
    return soup;
}
/// Triangles that shrink to segments and points, some of which coincide.
inline MovingSoup<> collapsing(int triangles, unsigned seed) {
    Draw draw(seed);
    MovingSoup<> soup;
    for (int i = 0; i < triangles; ++i) {
        const PointOf<double> end = draw.grid(4), other = draw.grid(4);
        std::array<std::int32_t, 3> id{};
        for (std::size_t k = 0; k < 3; ++k) id[k] = soup.vertex(draw.grid(4), k == 0 && i % 2 ? other : end);
        soup.triangles.push_back(id);
    }
    return soup;
}
/// Flat sheets of n x n quads; sheet s moves from its first height to its second.
inline MovingSoup<> moving_sheets(int n, const std::vector<std::array<double, 2>>& heights) {
    MovingSoup<> soup;
    for (std::size_t s = 0; s < heights.size(); ++s) {
        const auto first = static_cast<std::int32_t>(soup.start.size());
        const double shift = static_cast<double>(s % 2);
        for (int i = 0; i <= n; ++i)
            for (int j = 0; j <= n; ++j)
                soup.vertex({2.0 * i + shift, 2.0 * j + shift, heights[s][0]},
                            {2.0 * i + shift, 2.0 * j + shift, heights[s][1]});
        for (std::int32_t i = 0; i < n; ++i)
            for (std::int32_t j = 0; j < n; ++j) {
                const std::int32_t a = first + i * (n + 1) + j, b = a + 1, c = a + n + 1, d = c + 1;
                soup.triangles.push_back({a, b, d});
                soup.triangles.push_back({a, d, c});
            }
    }
    return soup;
}
/// Triangles 8,192 units long and 2^-10 units wide, along the axes, which pass each other within a few units.
inline MovingSoup<> needles(int triangles, unsigned seed) {
    Draw draw(seed);
    MovingSoup<> soup;
    for (int i = 0; i < triangles; ++i) {
        const double x = draw.integer(-2, 2), y = draw.integer(-2, 2), z = draw.integer(-2, 2);
        const auto axis = static_cast<std::size_t>(draw.below(3));
        std::array<std::int32_t, 3> id{};
        for (std::size_t k = 0; k < 3; ++k) {
            PointOf<double> from{x, y, z};
            from[axis] += k == 0 ? -4096 : 4096;
            from[(axis + 1) % 3] += k == 2 ? 0.0009765625 : 0;
            PointOf<double> to = from;
            to[(axis + 2) % 3] += draw.integer(-2, 2);
            id[k] = soup.vertex(from, to);
        }
        soup.triangles.push_back(id);
    }
    return soup;
}
/// One triangle as large as the scene, which moves through many small ones.
inline MovingSoup<> giant_under_many(int small, unsigned seed, double size = 1000) {
    Draw draw(seed);
    MovingSoup<> soup;
    const std::int32_t a = soup.vertex({-size, -size, 0}, {-size, -size, 3});
    const std::int32_t b = soup.vertex({size, -size, 0}, {size, -size, 2}), c = soup.vertex({0, size, 0}, {0, size, 1});
    soup.triangles.push_back({a, b, c});
    for (int i = 0; i < small; ++i) {
        const PointOf<double> at{draw.integer(-8, 8), draw.integer(-8, 8), draw.integer(0, 4)};
        std::array<std::int32_t, 3> id{};
        for (std::size_t k = 0; k < 3; ++k) {
            PointOf<double> from = draw.grid(3), to = draw.grid(3);
            for (std::size_t axis = 0; axis < 3; ++axis) from[axis] += at[axis], to[axis] += at[axis];
            id[k] = soup.vertex(from, to);
        }
        soup.triangles.push_back(id);
    }
    return soup;
}
/// Random coordinates in general position: triangles of about `size` in the unit cube, whose vertices move by at most
/// way / 2 along each axis.
inline MovingSoup<> in_general(int triangles, double size, double way, unsigned seed) {
    Draw draw(seed);
    const Soup<double> at_start = random_soup<double>(triangles, size, seed);
    MovingSoup<> soup{at_start.vertices, at_start.vertices, at_start.triangles, {}};
    for (auto& p : soup.end)
        for (double& x : p) x += way * (draw.number() - 0.5);
    return soup;
}
/// Two thirds of the vertices stay near each other; the others move up to `far` times as far along one axis.
inline MovingSoup<> far_travellers(int vertices, int triangles, double far, unsigned seed) {
    MovingSoup<> soup = moving_grid(4, vertices, triangles, seed);
    Draw draw(seed + 1);
    for (auto& p : soup.end)
        if (draw.below(3) == 0) p[static_cast<std::size_t>(draw.below(3))] *= draw.below(2) ? far : -far;
    return soup;
}
/// Returns the soup with some coordinates moved to an adjacent floating-point number.
template <class Scalar>
MovingSoup<Scalar> nudged(MovingSoup<Scalar> soup, unsigned seed) {
    Draw draw(seed);
    constexpr Scalar most = std::numeric_limits<Scalar>::max();
    for (auto* points : {&soup.start, &soup.end})
        for (auto& p : *points)
            for (Scalar& x : p)
                if (const int kind = draw.below(12); kind < 2) x = std::nextafter(x, kind ? most : -most);
    return soup;
}

template <class Scalar>
struct NamedMove {
    std::string name;
    MovingSoup<Scalar> soup;
    double unit = 1;  ///< typical size of the coordinates
};

/// Returns soups of every kind, with few triangles each. `part` scales the numbers of triangles, for example 0.25 for
/// queries that take longer.
template <class Scalar>
std::vector<NamedMove<Scalar>> moving_soups(double part = 1) {
    std::vector<NamedMove<Scalar>> all;
    const auto n = [&](int count) { return static_cast<int>(std::ceil(part * count)); };
    const auto add = [&](const std::string& name, const MovingSoup<>& soup, double unit = 1) {
        all.push_back({name, changed<Scalar>(soup, [&](double x) { return unit * x; }), unit});
    };
    add("nothing", {});
    MovingSoup<> soup;
    soup.vertex({0, 0, 0}, {1, 0, 0});
    add("a vertex without a face", soup);
    soup.triangles = {{0, 0, 0}};
    add("a point", soup);
    soup.triangles = {{0, 0, 0}, {0, 0, 0}};
    add("a point twice", soup);
    add("a grid of 2", moving_grid(2, n(12), n(20), 1));
    add("a grid of 3", moving_grid(3, n(20), n(24), 2));
    add("a grid of 6", moving_grid(6, n(40), n(30), 3));
    add("a grid of 30", moving_grid(30, n(60), n(40), 4));
    add("in a plane", moving_in_a_plane(n(24), n(15), 5));
    add("in a line", moving_in_a_line(n(24), n(12), 6));
    add("through a line", moving_through_a_line(n(24), n(16), 7));
    add("mostly resting", mostly_static(4, n(40), n(40), 8));
    add("collapsing", collapsing(n(16), 9));
    add("sheets that land", moving_sheets(n(3), {{0, 0}, {5, 0}, {2, 1}, {1, 3}}));
    add("sheets that lie", moving_sheets(n(2), {{0, 3}, {0, 3}, {3, 0}, {4, 0}}));
    add("needles", needles(n(24), 10));
    add("a giant", giant_under_many(n(60), 11));
    add("a larger giant", giant_under_many(n(60), 12, 0x1p20));
    add("in general", in_general(n(60), 0.4, 0.3, 13));
    add("in general, fine", in_general(n(300), 0.05, 0.1, 14));
    add("at rest in general", in_general(n(80), 0.4, 0, 15));
    const MovingSoup<> grid = moving_grid(4, n(20), n(14), 16);
    constexpr bool wide = sizeof(Scalar) == 8;
    add("subnormal", grid, wide ? 0x1p-1074 : 0x1p-149);
    add("small", grid, wide ? 0x1p-1000 : 0x1p-120);
    add("1e-30", grid, 1e-30);
    add("1e30", grid, 1e30);
    add("large", grid, wide ? 0x1p1020 : 0x1p125);
    add("travellers to 1e30", far_travellers(n(16), n(9), 1e30, 17));
    add("travellers from 1e-30", far_travellers(n(16), n(9), wide ? 1e60 : 1e35, 18), 1e-30);
    const double away = wide ? 0x1p50 : 0x1p21;
    const auto add_moved = [&](const std::string& name, unsigned seed, auto move) {
        all.push_back({name, changed<Scalar>(moving_grid(4, n(24), n(18), seed), move)});
    };
    add_moved("far away", 19, [&](double x) { return x + away; });
    add_moved("far away on both sides", 20, [&](double x) { return x > 1 ? x + away : x - away; });
    const auto add_nudged = [&](const std::string& name, const MovingSoup<>& from, unsigned seed) {
        all.push_back({name, nudged(rounded<Scalar>(from), seed)});
    };
    add_nudged("a number beside", moving_grid(3, n(14), n(8), 21), 1);
    add_nudged("a number beside resting", mostly_static(3, n(16), n(12), 22), 2);
    add_nudged("a number beside sheets", moving_sheets(1, {{0, 0}, {3, 0}, {1, 1}}), 3);
    return all;
}

}  // namespace crumple::test
