// Tests that the filters of `narrow` never decide wrongly: on hard pairs, each instruction set gives the results of
// brute force.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;
using test::Soup;

const char* name_of(Simd simd) {
    constexpr const char* names[] = {"automatic", "scalar", "sse4", "avx2", "avx512", "neon"};
    return names[static_cast<std::size_t>(simd)];
}

template <class Scalar>
void compare_all(const Soup<Scalar>& soup, const std::string& what) {
    for (const auto& [neighbours, intersections] : {std::pair{Neighbours::geometric, IntersectionKind::all},
                                                    {Neighbours::skip, IntersectionKind::all},
                                                    {Neighbours::geometric, IntersectionKind::proper}}) {
        IntersectionQuery query;
        query.neighbours = neighbours;
        query.kind = intersections;
        Detector reference({.backend = Backend::reference});
        const auto expected = pairs_of(reference.find(soup.view(), query));
        for (const Simd simd : {Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon}) {
            try {
                Detector detector({.backend = Backend::cpu, .threads = 1, .simd = simd});
                EXPECT_EQ(difference(expected, pairs_of(detector.find(soup.view(), query))), "")
                    << what << ", " << name_of(simd) << ", neighbours " << static_cast<int>(neighbours)
                    << ", intersections " << static_cast<int>(intersections);
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
            }
        }
    }
}

TEST(Filter, random_triangles_match_brute_force) { compare_all(test::random_soup(400, 0.4), "random"); }
TEST(Filter, random_float64_triangles_match_brute_force) { compare_all(test::random_soup<double>(400, 0.4), "random"); }

TEST(Filter, folded_sheets_match_brute_force) {
    compare_all(test::wavy_sheet(14), "sheet");
    compare_all(test::wavy_sheet<double>(14), "sheet");
}

// Corners moved off exact contact by single units in the last place, in both directions.
TEST(Filter, near_ties_match_brute_force) {
    std::mt19937 engine(21);
    for (const double offset : {0.0, 1.0, 1000.0}) {
        Soup<float> soup;
        for (std::int32_t t = 0; t < 120; ++t) {
            for (int k = 0; k < 3; ++k) {
                std::array<float, 3> p;
                for (float& value : p) {
                    value = static_cast<float>(offset + static_cast<double>(engine() % 5) / 4);
                    const auto step = engine() % 6;
                    if (step == 1) value = std::nextafter(value, 1e9f);
                    if (step == 2) value = std::nextafter(value, -1e9f);
                }
                soup.vertices.push_back(p);
            }
            soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
        }
        compare_all(soup, "near ties at " + std::to_string(offset));
    }
}

// Adjacent triangles of every kind: random triangles over few vertices, nearly flat and exactly flat.
TEST(Filter, adjacent_triangles_match_brute_force) {
    std::mt19937 engine(22);
    for (const double thickness : {0.3, 1e-6, 0.0}) {
        Soup<double> soup;
        for (int v = 0; v < 24; ++v)
            soup.vertices.push_back({static_cast<double>(engine() % 9), static_cast<double>(engine() % 9),
                                     thickness * static_cast<double>(engine() % 9)});
        for (int t = 0; t < 100; ++t) {
            const auto corner = [&] { return static_cast<std::int32_t>(engine() % 24); };
            soup.triangles.push_back({corner(), corner(), corner()});
        }
        compare_all(soup, "thickness " + std::to_string(thickness));
    }
}

// Filters cannot use the corners of a "big" triangle, one that extends far beyond the other triangles of its leaf.
TEST(Filter, ground_under_fine_triangles_matches_brute_force) {
    Soup<float> soup = test::random_soup(300, 0.05, 12);
    for (auto& p : soup.vertices) p[2] = (p[2] - 0.5f) * 0.05f;
    const auto v = static_cast<std::int32_t>(soup.vertices.size());
    for (const std::array<float, 3>& p :
         {std::array{-1000.f, -1000.f, 0.001f}, {1000.f, -1000.f, 0.f}, {0.f, 3000.f, -0.001f}, {3.f, 0.5f, 40.f}})
        soup.vertices.push_back(p);
    soup.triangles.push_back({v, v + 1, v + 2});
    soup.triangles.push_back({v, v + 2, v + 3});
    compare_all(soup, "ground");
}

}  // namespace
}  // namespace crumple
