// The shortest useful program: finds all pairs of intersecting triangles in a soup of two tetrahedra, and prints where
// they intersect.

#include <array>
#include <cstdio>
#include <vector>

#include "crumple/crumple.h"

int main() {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    const auto add_tetrahedron = [&](double x) {
        const auto v = static_cast<std::int32_t>(vertices.size());
        for (const auto& p : {std::array{x, 0.0, 0.0}, {x + 1, 0.0, 0.0}, {x, 1.0, 0.0}, {x, 0.0, 1.0}})
            vertices.push_back(p);
        for (const auto& t : {std::array{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}})
            triangles.push_back({v + t[0], v + t[1], v + t[2]});
    };
    add_tetrahedron(0);
    add_tetrahedron(0.5);

    try {
        crumple::Detector detector;
        const crumple::Intersections& found =
            detector.find({vertices, triangles}, {.output = crumple::Output::contacts});
        for (std::size_t i = 0; i < found.pairs.size(); ++i) {
            std::printf("triangles %d and %d meet in", found.pairs[i].a, found.pairs[i].b);
            for (auto k = found.contacts.offsets[i]; k < found.contacts.offsets[i + 1]; ++k) {
                const auto& p = found.contacts.points[static_cast<std::size_t>(k)];
                std::printf(" (%g, %g, %g)", p[0], p[1], p[2]);
            }
            std::printf("\n");
        }
    } catch (const crumple::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
