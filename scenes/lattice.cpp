// Exact contacts and degeneracies: triangles with integer corners, in the cells of a grid, which touch. Five kinds of
// cells alternate: triangles with random corners (which touch at points, cross at edges, or lie in one plane), stacks
// of triangles in one plane, duplicates by index and by position, strips that fold back on themselves, and degenerate
// triangles (points, segments, repeated indices, collinear corners).
//
// The grid starts at 2^28, where float32 holds only every 32nd integer: rounding to float32 would change the result.

#include <algorithm>
#include <array>
#include <vector>

#include "scenes/list.h"
#include "scenes/random.h"

namespace crumple::scenes {
namespace {

constexpr double origin = 0x1p28;
constexpr int cell_width = 4, cell_triangles = 10;

class Cell {
   public:
    Cell(io::TriangleMesh& mesh, std::array<int, 3> corner, Random& random)
        : mesh_(mesh), corner_(corner), random_(random) {}

    void random_corners() {
        std::array<std::int32_t, 9> points{};
        for (auto& point : points) point = random_point();
        for (int i = 0; i < cell_triangles; ++i) triangle({pick(points), pick(points), random_point()});
    }
    void stack() {
        const auto axis = static_cast<std::size_t>(random_.integer(3));
        const int height = random_.integer(cell_width + 1);
        for (int i = 0; i < cell_triangles; ++i) {
            const auto in_plane = [&] {
                std::array<int, 3> p{coordinate(), coordinate(), coordinate()};
                p[axis] = height;
                return vertex(p);
            };
            triangle({in_plane(), in_plane(), in_plane()});
        }
    }
    void duplicates() {
        const std::array<int, 3> p{0, coordinate(), 1}, q{4, 3, coordinate()}, r{2, 0, 4};
        const std::int32_t a = vertex(p), b = vertex(q), c = vertex(r);
        for (int i = 0; i < cell_triangles / 2; ++i) {
            triangle(i % 2 ? std::array{a, b, c} : std::array{b, a, c});  // both orientations
            triangle({vertex(p), i % 2 ? b : vertex(q), vertex(r)});
        }
    }
    /// Adds a strip in one plane: each triangle shares an edge with the previous one, and lies on top of it or beside
    /// it.
    void folded_strip() {
        const int height = random_.integer(cell_width + 1);
        const auto in_plane = [&] { return vertex({coordinate(), coordinate(), height}); };
        std::int32_t a = in_plane(), b = in_plane();
        for (int i = 0; i < cell_triangles; ++i) {
            const std::int32_t c = in_plane();
            triangle({a, b, c});
            a = b;
            b = c;
        }
    }
    void degenerate() {
        const std::int32_t a = random_point(), b = random_point();
        triangle({a, a, a});
        triangle({a, a, b});
        triangle({a, b, a});
        const std::array<int, 3> here{coordinate(), coordinate(), coordinate()};
        triangle({vertex(here), vertex(here), vertex(here)});
        for (int i = 4; i < cell_triangles; i += 2) {
            const int y = coordinate(), z = coordinate();
            triangle({vertex({0, y, z}), vertex({4, y, z}), vertex({coordinate(), y, z})});
            triangle({a, random_point(), random_point()});
        }
    }

   private:
    int coordinate() { return random_.integer(cell_width + 1); }
    std::int32_t random_point() {
        const int x = coordinate(), y = coordinate();
        return vertex({x, y, coordinate()});
    }
    std::int32_t pick(const std::array<std::int32_t, 9>& points) {
        return points[static_cast<std::size_t>(random_.integer(9))];
    }
    std::int32_t vertex(std::array<int, 3> p) {
        auto& vertices = std::get<std::vector<double>>(mesh_.vertices);
        const auto index = static_cast<std::int32_t>(vertices.size() / 3);
        for (std::size_t k = 0; k < 3; ++k) vertices.push_back(origin + cell_width * corner_[k] + p[k]);
        return index;
    }
    void triangle(std::array<std::int32_t, 3> corners) {
        mesh_.triangles.insert(mesh_.triangles.end(), corners.begin(), corners.end());
    }

    io::TriangleMesh& mesh_;
    std::array<int, 3> corner_;
    Random& random_;
};

}  // namespace

io::TriangleMesh make_lattice(const Parameters& parameters) {
    const std::int64_t cells = std::max<std::int64_t>(5, (parameters.triangles + cell_triangles / 2) / cell_triangles);
    int side = 1;
    while (static_cast<std::int64_t>(side) * side * side < cells) ++side;

    io::TriangleMesh mesh{std::vector<double>{}, {}, {}};
    Random random(parameters.seed);
    for (std::int64_t i = 0; i < cells; ++i) {
        Cell cell(mesh,
                  {static_cast<int>(i % side), static_cast<int>(i / side % side), static_cast<int>(i / side / side)},
                  random);
        switch (i % 5) {
            case 0:
                cell.random_corners();
                break;
            case 1:
                cell.stack();
                break;
            case 2:
                cell.duplicates();
                break;
            case 3:
                cell.folded_strip();
                break;
            default:
                cell.degenerate();
                break;
        }
    }
    return mesh;
}

}  // namespace crumple::scenes
