#include "scenes/soup.h"

#include <map>
#include <tuple>
#include <vector>

#include "scenes/arithmetic.h"

namespace crumple::scenes {

void Soup::reserve(std::int64_t vertices, std::int64_t triangles) {
    std::get<std::vector<float>>(mesh_.vertices).reserve(static_cast<std::size_t>(3 * vertices));
    mesh_.triangles.reserve(static_cast<std::size_t>(3 * triangles));
}

std::int32_t Soup::vertex(Vec3d p) {
    auto& vertices = std::get<std::vector<float>>(mesh_.vertices);
    const auto index = static_cast<std::int32_t>(vertices.size() / 3);
    vertices.insert(vertices.end(), {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    return index;
}

void Soup::triangle(std::array<std::int32_t, 3> corners) {
    mesh_.triangles.insert(mesh_.triangles.end(), corners.begin(), corners.end());
}

void Soup::triangle(Vec3d a, Vec3d b, Vec3d c) {
    const std::int32_t first = vertex(a);
    vertex(b);
    vertex(c);
    triangle({first, first + 1, first + 2});
}

void add_uv_sphere(Soup& soup, int slices, int stacks, const ScaledPose& pose) {
    const std::int32_t north = soup.vertex(pose({0, 0, 1})), south = soup.vertex(pose({0, 0, -1}));
    const std::int32_t first = south + 1;
    for (int j = 1; j < stacks; ++j) {
        for (int i = 0; i < slices; ++i) {
            const double down = 0.5 * j / stacks, along = static_cast<double>(i) / slices;
            soup.vertex(pose({sine(down) * cosine(along), sine(down) * sine(along), cosine(down)}));
        }
    }
    for (int i = 0; i < slices; ++i) {
        const int next = (i + 1) % slices, last = first + (stacks - 2) * slices;
        soup.triangle({north, first + i, first + next});
        for (std::int32_t row = first; row < last; row += slices) {
            soup.triangle({row + i, row + slices + i, row + slices + next});
            soup.triangle({row + i, row + slices + next, row + next});
        }
        soup.triangle({south, last + next, last + i});
    }
}

namespace {

/// Map of vertices by integer keys, so that adjacent faces share the vertices at their common edges.
class Lattice {
   public:
    template <class Place>
    std::int32_t operator()(Soup& soup, int x, int y, int z, Place place) {
        const auto [entry, fresh] = vertices_.try_emplace({x, y, z}, 0);
        if (fresh) entry->second = soup.vertex(place());
        return entry->second;
    }

   private:
    std::map<std::tuple<int, int, int>, std::int32_t> vertices_;
};

}  // namespace

void add_icosphere(Soup& soup, int cuts, const ScaledPose& pose) {
    // Corners are (0, ±1, ±g) and their cyclic permutations, g being the golden ratio. The key of a vertex is the sum
    // of the face's corners times the vertex's integer weights, with 2 in place of g.
    const double golden = (1 + std::sqrt(5.0)) / 2;
    constexpr std::array<std::array<int, 3>, 12> corners{{{0, 1, 2},
                                                          {0, -1, 2},
                                                          {0, 1, -2},
                                                          {0, -1, -2},
                                                          {1, 2, 0},
                                                          {-1, 2, 0},
                                                          {1, -2, 0},
                                                          {-1, -2, 0},
                                                          {2, 0, 1},
                                                          {2, 0, -1},
                                                          {-2, 0, 1},
                                                          {-2, 0, -1}}};
    constexpr std::array<std::array<int, 3>, 20> faces{{{0, 1, 8},  {0, 10, 1}, {0, 4, 5},  {0, 8, 4},   {0, 5, 10},
                                                        {1, 6, 8},  {1, 7, 6},  {1, 10, 7}, {2, 5, 4},   {2, 3, 11},
                                                        {2, 9, 3},  {2, 4, 9},  {2, 11, 5}, {3, 6, 7},   {3, 9, 6},
                                                        {3, 7, 11}, {4, 8, 9},  {6, 9, 8},  {5, 11, 10}, {7, 10, 11}}};
    Lattice lattice;
    for (const auto& face : faces) {
        const auto vertex = [&](int i, int j) {
            const std::array<int, 3> weights{cuts - i - j, i, j};
            std::array<int, 3> key{};
            Vec3d p;
            for (std::size_t k = 0; k < 3; ++k) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    const int c = corners[static_cast<std::size_t>(face[k])][axis];
                    key[axis] += weights[k] * c;
                    p[static_cast<int>(axis)] += weights[k] * (c == 2 ? golden : c == -2 ? -golden : c);
                }
            }
            return lattice(soup, key[0], key[1], key[2], [&] { return pose(normalised(p)); });
        };
        for (int i = 0; i < cuts; ++i) {
            for (int j = 0; j < cuts - i; ++j) {
                soup.triangle({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
                if (j + 1 < cuts - i) soup.triangle({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
            }
        }
    }
}

void add_box(Soup& soup, int cuts, Vec3d half, const ScaledPose& pose) {
    Lattice lattice;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (int side = 0; side <= cuts; side += cuts) {
            const std::size_t u = (axis + (side ? 1 : 2)) % 3, v = 3 - axis - u;  // so that faces look outwards
            const auto vertex = [&](int i, int j) {
                std::array<int, 3> key{};
                key[axis] = side, key[u] = i, key[v] = j;
                return lattice(soup, key[0], key[1], key[2], [&] {
                    const auto at = [&](int k) { return (2.0 * key.data()[k] / cuts - 1) * half[k]; };
                    return pose({at(0), at(1), at(2)});
                });
            };
            for (int i = 0; i < cuts; ++i) {
                for (int j = 0; j < cuts; ++j) {
                    soup.triangle({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
                    soup.triangle({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
                }
            }
        }
    }
}

void add_torus(Soup& soup, int around, int across, double tube, const ScaledPose& pose) {
    std::vector<std::int32_t> vertices;
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            const double u = static_cast<double>(i) / around, v = static_cast<double>(j) / across;
            const double radius = 1 + tube * cosine(v);
            vertices.push_back(soup.vertex(pose({radius * cosine(u), radius * sine(u), tube * sine(v)})));
        }
    }
    const auto vertex = [&, first = vertices.data()](int i, int j) { return first[i % around * across + j % across]; };
    for (int i = 0; i < around; ++i) {
        for (int j = 0; j < across; ++j) {
            soup.triangle({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
            soup.triangle({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
        }
    }
}

}  // namespace crumple::scenes
