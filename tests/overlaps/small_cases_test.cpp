// Compares many small bodies on grids, where most signs are ties, with brute force in rational arithmetic: all numbers,
// derivatives, curves, regions and winding numbers, bit by bit.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "overlaps/closed_bodies.h"
#include "rounds.h"

namespace crumple {
namespace {

using Soup = test::Soup<double>;
using test::Dice;

double coordinate(Dice& dice, int grid) { return dice.below(grid); }

/// Adds a triangle in both orientations: a closed surface without inside.
void add_membrane(Dice& dice, int grid, Soup& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (int v = 0; v < 3; ++v)
        soup.vertices.push_back({coordinate(dice, grid), coordinate(dice, grid), coordinate(dice, grid)});
    soup.triangles.push_back({first, first + 1, first + 2});
    soup.triangles.push_back({first, first + 2, first + 1});
}
/// Adds a closed surface of six triangles: the sides of two tetrahedra that have a common base, without the base.
void add_bipyramid(Dice& dice, int grid, Soup& soup) {
    const auto first = static_cast<std::int32_t>(soup.vertices.size());
    for (int v = 0; v < 5; ++v)
        soup.vertices.push_back({coordinate(dice, grid), coordinate(dice, grid), coordinate(dice, grid)});
    for (std::int32_t v = 0; v < 3; ++v) {
        soup.triangles.push_back({first + v, first + (v + 1) % 3, first + 3});
        soup.triangles.push_back({first + (v + 1) % 3, first + v, first + 4});
    }
}

/// Returns a body of one or two boxes, membranes, bipyramids or tetrahedra with vertices on a grid; some are inside
/// out. Half of the bodies are cut off at a coordinate from 1 to 3, so that many vertices have equal coordinates.
Soup small_body(Dice& dice) {
    const int grid = 2 + dice.below(3);
    Soup soup;
    for (int part = dice.chance(0.2) ? 2 : 1; part > 0; --part) switch (dice.below(8)) {
            case 0:
                test::add_box(dice, true, 0, soup);
                break;
            case 1:
                add_membrane(dice, grid, soup);
                break;
            case 2:
            case 3:
                add_bipyramid(dice, grid, soup);
                break;
            default:
                test::add_tetrahedron(dice, true, 0, soup);
        }
    if (dice.chance(0.1)) test::add_t_junction(soup);
    if (dice.chance(0.5))
        for (auto& p : soup.vertices)
            for (double& x : p) x = std::min(x, grid - 1.0);
    return soup;
}

/// Counts of rows by kind.
struct Figures {
    std::int64_t rows = 0, with_curves = 0, with_contact_area = 0;
    std::array<std::int64_t, 6> relations{};

    void add(const Overlaps& found) {
        rows += found.count;
        for (std::size_t i = 0; i < found.relation.size(); ++i) {
            ++relations[static_cast<std::size_t>(found.relation[i])];
            with_curves += found.curve_offsets[i] < found.curve_offsets[i + 1];
            with_contact_area += found.contact_area[i] > 0;
        }
    }
};

TEST(OverlapSmallCases, results_match_rational_arithmetic_byte_by_byte) {
    Detector cpu(Options{.backend = Backend::cpu, .threads = 1}), reference(Options{.backend = Backend::reference});
    OverlapQuery query{.weld = true,
                       .gradient = true,
                       .curves = true,
                       .windings = true,
                       .extents = true,
                       .depths = true,
                       .directions = {{0, 0, 1}, {1, -2, 0.5}},
                       .translation = true,
                       .solids = true,
                       .unions = true,
                       .regions = true};
    Figures figures;
    const int cases = std::max(200, scaled_rounds(250));
    for (int seed = 0; seed < cases; ++seed) {
        Dice dice(static_cast<unsigned>(seed));
        const Soup a = small_body(dice), b = small_body(dice);
        query.depth_tolerance = seed % 16 == 0 ? 0.1 : 0;  // many steps
        query.first_free = seed % 4 == 0;
        const Overlaps& found = cpu.find({a.view(), b.view()}, query);
        ASSERT_EQ(test::difference(found, reference.find({a.view(), b.view()}, query)), "") << "case " << seed;
        for (const std::uint8_t closed : found.curve_closed) ASSERT_EQ(closed, 1) << "case " << seed;
        figures.add(found);
    }
    std::printf("%d cases, %lld rows, %lld with curves, %lld with contact area; touching, overlapping, inside, equal:",
                cases, static_cast<long long>(figures.rows), static_cast<long long>(figures.with_curves),
                static_cast<long long>(figures.with_contact_area));
    const auto& of = figures.relations;
    std::printf(" %lld, %lld, %lld, %lld\n", static_cast<long long>(of[0]), static_cast<long long>(of[1]),
                static_cast<long long>(of[2] + of[3]), static_cast<long long>(of[4]));
    EXPECT_GT(figures.with_curves, cases / 20);
    EXPECT_GT(figures.with_contact_area, cases / 100);
}

}  // namespace
}  // namespace crumple
