#pragma once

// Small soups on integer grids with exact special cases: triangles that touch, are coplanar, doubled, folded,
// degenerate or collinear. Integers are exact in both precisions.

#include <string>
#include <utility>
#include <vector>

#include "crumple/io.h"
#include "scenes/random.h"

namespace crumple::test {

struct NamedMesh {
    std::string name;
    io::TriangleMesh mesh;
};

/// Builds one soup; coordinates are multiplied by `unit` at the end.
class SoupBuilder {
   public:
    explicit SoupBuilder(std::uint64_t seed) : random(seed) {}

    std::int32_t vertex(double x, double y, double z) {
        for (const double value : {x, y, z}) xyz_.push_back(value);
        return static_cast<std::int32_t>(xyz_.size() / 3) - 1;
    }
    void triangle(std::int32_t a, std::int32_t b, std::int32_t c) {
        for (const std::int32_t corner : {a, b, c}) corners_.push_back(corner);
    }
    /// Adds two triangles on four corners given in circular order.
    void quad(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }

    /// Returns a copy whose vertices are each moved by at most one unit along each axis.
    SoupBuilder moved() const {
        SoupBuilder copy(*this);
        scenes::Random steps(13);
        for (double& x : copy.xyz_) x += steps.integer(3) - 1;
        return copy;
    }

    template <class Scalar>
    io::TriangleMesh mesh(double unit = 1) const {
        io::TriangleMesh mesh;
        std::vector<Scalar> scaled;
        for (const double x : xyz_) scaled.push_back(static_cast<Scalar>(unit * x));
        mesh.vertices = std::move(scaled);
        mesh.triangles = corners_;
        // Assigns each triangle to one of three groups at random, so that groups are unrelated to positions.
        scenes::Random groups(7);
        for (std::size_t t = 0; t < corners_.size() / 3; ++t) mesh.groups.push_back(groups.integer(3) - 1);
        return mesh;
    }

    scenes::Random random;

   private:
    std::vector<double> xyz_;
    std::vector<std::int32_t> corners_;
};

/// Random triangles among a few vertices of a small grid: adjacent triangles of every kind, coincident positions,
/// degenerate triangles.
inline SoupBuilder grid_soup(int width, int vertices, int triangles, std::uint64_t seed) {
    SoupBuilder soup(seed);
    for (int i = 0; i < vertices; ++i) {
        const int x = soup.random.integer(width), y = soup.random.integer(width);
        soup.vertex(x, y, soup.random.integer(width));
    }
    for (int i = 0; i < triangles; ++i) {
        const int a = soup.random.integer(vertices), b = soup.random.integer(vertices);
        soup.triangle(a, b, soup.random.integer(vertices));
    }
    return soup;
}

/// Flat sheets of n x n quads; sheets at equal heights coincide, and each has its own vertices, so that they touch.
inline SoupBuilder stacked_sheets(int n, const std::vector<std::array<double, 3>>& offsets) {
    SoupBuilder soup(1);
    for (const auto& [x, y, z] : offsets) {
        std::vector<std::int32_t> id;
        for (int i = 0; i <= n; ++i) {
            for (int j = 0; j <= n; ++j) id.push_back(soup.vertex(x + 2 * i, y + 2 * j, z));
        }
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
                const auto at = [&](int k, int l) { return id[static_cast<std::size_t>((i + k) * (n + 1) + j + l)]; };
                soup.quad(at(0, 0), at(1, 0), at(1, 1), at(0, 1));
            }
        }
    }
    return soup;
}

/// A strip of quads with creases between them, folded back at every crease, so that all quads lie in one plane.
inline SoupBuilder folded_strip(int folds) {
    SoupBuilder soup(1);
    std::int32_t a = soup.vertex(0, 0, 0), b = soup.vertex(0, 4, 0);
    for (int i = 1; i <= folds; ++i) {
        const double x = i % 2 ? 4 + i % 3 : 0;
        const std::int32_t c = soup.vertex(x, 0, 0), d = soup.vertex(x, 4, 0);
        soup.quad(a, b, d, c);
        a = c;
        b = d;
    }
    return soup;
}

/// Boxes on a grid whose sides touch.
inline SoupBuilder touching_boxes(int n) {
    SoupBuilder soup(1);
    for (int cell = 0; cell < n * n * n; ++cell) {
        std::array<std::int32_t, 8> v{};
        for (int k = 0; k < 8; ++k) {
            v[static_cast<std::size_t>(k)] =
                soup.vertex(cell % n + (k & 1), cell / n % n + (k >> 1 & 1), cell / n / n + (k >> 2));
        }
        soup.quad(v[0], v[2], v[3], v[1]);
        soup.quad(v[4], v[5], v[7], v[6]);
        soup.quad(v[0], v[1], v[5], v[4]);
        soup.quad(v[2], v[6], v[7], v[3]);
        soup.quad(v[0], v[4], v[6], v[2]);
        soup.quad(v[1], v[3], v[7], v[5]);
    }
    return soup;
}

/// Segments and points, some with corners in common.
inline SoupBuilder degenerate_soup(int triangles) {
    SoupBuilder soup(5);
    const auto coordinate = [&] { return static_cast<double>(soup.random.integer(5)); };
    std::int32_t last = soup.vertex(0, 0, 0);
    for (int i = 0; i < triangles; ++i) {
        const double x = coordinate(), y = coordinate(), z = coordinate();
        const double u = coordinate() - 2, v = coordinate() - 2, w = coordinate() - 2;
        const std::int32_t a = soup.vertex(x, y, z), b = soup.vertex(x + u, y + v, z + w);
        const std::int32_t c = soup.vertex(x + 2 * u, y + 2 * v, z + 2 * w), e = soup.vertex(coordinate(), y, z);
        switch (soup.random.integer(6)) {
            case 0:
                soup.triangle(a, a, a);
                break;
            case 1:
                soup.triangle(a, b, a);
                break;
            case 2:
                soup.triangle(b, c, a);
                break;
            case 3:
                soup.triangle(last, b, b);
                break;
            case 4:
                soup.triangle(a, c, e);
                break;
            case 5:
                soup.triangle(last, a, e);
                break;
        }
        last = b;
    }
    return soup;
}

/// Degenerate triangles that all lie on one line.
inline SoupBuilder collinear_soup(int triangles) {
    SoupBuilder soup(9);
    for (int i = 0; i < triangles; ++i) {
        const auto on_line = [&] {
            const double t = soup.random.integer(4 * triangles);
            return soup.vertex(3 * t, -t, 2 * t);
        };
        const std::int32_t a = on_line(), b = on_line();
        soup.triangle(a, b, on_line());
    }
    return soup;
}

/// Triangles up to 1,700 units long and a few units wide, which pass close to the origin.
inline SoupBuilder needle_soup(int triangles) {
    SoupBuilder soup(17);
    for (int i = 0; i < triangles; ++i) {
        const auto anywhere = [&] { return soup.random.integer(1001) - 500; };
        const double x = anywhere(), y = anywhere(), z = anywhere();
        const std::int32_t a = soup.vertex(x, y, z), b = soup.vertex(x + soup.random.integer(2), y + 1, z);
        soup.triangle(a, b, soup.vertex(soup.random.integer(5) - x, soup.random.integer(5) - y, -z));
    }
    return soup;
}

/// Copies of one face: some use the same vertices, others have vertices of their own at the same positions. The order
/// of corners is random.
inline SoupBuilder duplicates(int copies) {
    SoupBuilder soup(11);
    std::array<std::int32_t, 3> id{};
    for (int i = 0; i < copies; ++i) {
        if (i % 3 == 0) id = {soup.vertex(0, 0, 1), soup.vertex(5, 1, 0), soup.vertex(2, 7, 3)};
        std::swap(id[0], id[static_cast<std::size_t>(soup.random.integer(3))]);
        soup.triangle(id[0], id[1], id[2]);
    }
    return soup;
}

/// A grid soup and, after its triangles, six times `copies` degenerate triangles: three points and three segments,
/// whose corners are vertices of the grid soup, `copies` times each, with the corners in random order.
inline SoupBuilder padded_soup(int copies) {
    SoupBuilder soup = grid_soup(4, 40, 50, 6);
    const auto any_vertex = [&] { return soup.random.integer(40); };
    for (int place = 0; place < 6; ++place) {
        const std::int32_t a = any_vertex(), b = place % 2 ? any_vertex() : a;
        for (int i = 0; i < copies; ++i) {
            switch (soup.random.integer(6)) {
                case 0:
                    soup.triangle(a, a, b);
                    break;
                case 1:
                    soup.triangle(a, b, a);
                    break;
                case 2:
                    soup.triangle(b, a, a);
                    break;
                case 3:
                    soup.triangle(a, b, b);
                    break;
                case 4:
                    soup.triangle(b, a, b);
                    break;
                default:
                    soup.triangle(b, b, a);
                    break;
            }
        }
    }
    return soup;
}

inline std::vector<NamedMesh> hard_soups() {
    std::vector<NamedMesh> soups;
    const auto add = [&](const std::string& name, const SoupBuilder& soup) {
        soups.push_back({name, soup.mesh<float>()});
        soups.push_back({name + ", float64", soup.mesh<double>()});
    };
    add("grid of 3", grid_soup(3, 20, 80, 1));
    add("grid of 8", grid_soup(8, 100, 120, 2));
    add("sheets on each other", stacked_sheets(3, {{0, 0, 0}, {1, 1, 0}, {0, 0, 0}, {0, 0, 1}}));
    add("sheets in a pile", stacked_sheets(4, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {8, 0, 0}, {8, 0, 1}, {0, 8, 2}}));
    add("folded strip", folded_strip(40));
    add("touching boxes", touching_boxes(2));
    add("degenerate", degenerate_soup(100));
    add("one line", collinear_soup(60));
    add("duplicates", duplicates(40));
    add("padded", padded_soup(12));
    const SoupBuilder grid = grid_soup(5, 60, 60, 3);
    soups.push_back({"huge, float32", grid.mesh<float>(0x1p125)});
    soups.push_back({"huge, float64", grid.mesh<double>(0x1p1021)});
    soups.push_back({"subnormal, float32", grid.mesh<float>(0x1p-149)});
    soups.push_back({"subnormal, float64", grid.mesh<double>(0x1p-1074)});
    soups.push_back({"one triangle", grid_soup(9, 3, 1, 4).mesh<float>()});
    soups.push_back({"no triangle", SoupBuilder(1).mesh<float>()});
    return soups;
}

}  // namespace crumple::test
