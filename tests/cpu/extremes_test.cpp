// Tests of scenes at the limits of the number range, and of triangles far larger or smaller than those around them.

#include <gtest/gtest.h>

#include <random>

#include "error_of.h"
#include "memory_limit.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::pairs_of;
using test::Soup;

template <class Scalar>
void add(Soup<Scalar>& soup, std::array<Scalar, 3> a, std::array<Scalar, 3> b, std::array<Scalar, 3> c) {
    const auto v = static_cast<std::int32_t>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {a, b, c});
    soup.triangles.push_back({v, v + 1, v + 2});
}

template <class Scalar>
void expect_reference(const Soup<Scalar>& soup, const std::string& what) {
    Detector reference({.backend = Backend::reference});
    const auto expected = pairs_of(reference.find(soup.view()));
    for (const Simd simd : {Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon}) {
        try {
            Detector detector({.backend = Backend::cpu, .threads = 1, .simd = simd});
            EXPECT_EQ(difference(expected, pairs_of(detector.find(soup.view()))), "")
                << what << ", instruction set " << static_cast<int>(simd);
        } catch (const Error& error) {
            EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
        }
    }
}

TEST(Extremes, huge_triangle_in_the_plane_of_a_fine_floor_matches_brute_force) {
    for (const bool bent : {false, true})
        for (int more = 0; more < 4; ++more) {  // the last SIMD vector has different numbers of used lanes
            Soup<float> soup;
            for (int i = 0; i < 20; ++i)
                for (int j = 0; j < 20; ++j) {
                    const float x = static_cast<float>(i - 10), y = static_cast<float>(j - 10);
                    const float z = bent ? 0.1f * static_cast<float>((i + j) % 2 * 2 - 1) : 0.0f;
                    add<float>(soup, {x, y, 0}, {x + .9f, y, 0}, {x, y + .9f, z});
                    if (soup.triangles.size() == 2) add<float>(soup, {-3000, -3000, 0}, {3000, -3000, 0}, {0, 3000, 0});
                }
            for (int e = 0; e < more; ++e) {
                const auto x = static_cast<float>(e);
                add<float>(soup, {x, 0, 0}, {x + .5f, 0, 0}, {x, .5f, 0});
            }
            expect_reference(soup, bent ? "bent" : "flat");
        }
}

// Tests 1 to 17 points, so that the last SIMD vector has every number of unused lanes; these must not give pairs.
TEST(Extremes, long_degenerate_triangle_meets_each_of_1_to_17_points_once) {
    Soup<float> a, b;
    add<float>(a, {1, 1, 1}, {0, 0, 0}, {0, 0, 0});
    std::vector<Pair> expected;
    for (std::int32_t t = 0; t < 17; ++t) {
        add<float>(b, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
        expected.push_back({0, t});
        Detector detector({.backend = Backend::cpu});
        EXPECT_EQ(difference(expected, pairs_of(detector.find({a.view(), b.view()}))), "") << t + 1 << " points";
    }
}

template <class Scalar>
void tiny_around_a_huge_one(double size) {
    std::mt19937 engine(5);
    const auto number = [&] { return static_cast<double>(engine()) * 0x1p-31 - 1; };
    Soup<Scalar> soup;
    for (int t = 0; t < 500; ++t) {
        if (t == 2) {
            const auto x = static_cast<Scalar>(0.61234567), y = static_cast<Scalar>(-0.323456789),
                       z = static_cast<Scalar>(0.77123456);
            add<Scalar>(
                soup, {x, y, z}, {-x, -y, -z},
                {static_cast<Scalar>(0.345678912), static_cast<Scalar>(0.67123478), static_cast<Scalar>(-0.43)});
            continue;
        }
        const double centre[3] = {size * number(), size * number(), size * number()};
        std::array<std::array<Scalar, 3>, 3> p;
        for (auto& corner : p)
            for (std::size_t axis = 0; axis < 3; ++axis)
                corner[axis] = static_cast<Scalar>(centre[axis] + 0.3 * size * number());
        add<Scalar>(soup, p[0], p[1], p[2]);
    }
    expect_reference(soup, "size " + std::to_string(-std::log10(size)));
}

TEST(Extremes, tiny_triangles_around_a_huge_one_match_brute_force) {
    for (const double size : {1e-6, 1e-9, 1e-10, 1e-12, 1e-15, 1e-20}) {
        tiny_around_a_huge_one<float>(size);
        tiny_around_a_huge_one<double>(size);
    }
}

TEST(Extremes, triangles_far_smaller_than_the_scene_match_brute_force) {
    std::mt19937 engine(3);
    for (const float far : {1e20f, 1e25f, 1e30f})
        for (const float unit : {1e-16f, 1e-14f, 1e-12f}) {
            Soup<float> soup;
            const auto number = [&] { return unit * static_cast<float>(static_cast<int>(engine() % 9) - 4) * 0.37f; };
            const auto point = [&] { return std::array{number(), number(), number()}; };
            for (int t = 0; t < 80; ++t) add<float>(soup, point(), point(), point());
            add<float>(soup, {far, 0, 0}, {far, far, 0}, {far, 0, far});
            expect_reference(soup, "far " + std::to_string(far));
        }
}

// Heights of corners are subnormal, or products of them underflow. Filters treat subnormal numbers as zero, so only the
// exact decision can separate triangles that overlap in the projection along y.
TEST(Extremes, sheets_with_tiny_or_subnormal_heights_match_brute_force) {
    std::mt19937 engine(5);
    for (const float height : {1e-45f, 1e-42f, 1e-38f, 1e-36f, 1e-30f}) {
        Soup<float> soup;
        for (int sheet = 0; sheet < 3; ++sheet) {
            for (int i = 0; i < 8; ++i) {
                for (int j = 0; j < 8; ++j) {
                    const auto corner = [&](int di, int dj) {
                        const auto steps = static_cast<float>(static_cast<int>(engine() % 7) - 3);
                        return std::array{static_cast<float>(i + di) + 0.125f * static_cast<float>(sheet),
                                          height * steps, static_cast<float>(j + dj)};
                    };
                    add<float>(soup, corner(0, 0), corner(1, 0), corner(0, 1));
                }
            }
        }
        expect_reference(soup, "height " + std::to_string(std::log10(height)));
    }
}

TEST(Extremes, triangles_of_tiny_or_subnormal_extent_at_x_equal_1_match_brute_force) {
    std::mt19937 engine(3);
    for (const double unit : {5e-324, 1e-310, 1e-307, 1e-305}) {
        Soup<double> soup;
        const auto point = [&] {
            return std::array{1.0, unit * static_cast<double>(engine() % 5), unit * static_cast<double>(engine() % 5)};
        };
        for (int t = 0; t < 40; ++t) add<double>(soup, point(), point(), point());
        expect_reference(soup, "flat in x");
    }
}

TEST(Extremes, any_throws_a_memory_limit_error_until_the_limit_suffices) {
    const auto soup = test::random_soup(20000, 1e-4);
    Detector free;
    ASSERT_EQ(free.find(soup.view()).pairs.size(), 0u);
    Detector tiny({.memory_limit = 100000});
    ASSERT_EQ(test::error_of([&] { tiny.any(soup.view()); }).code, ErrorCode::memory_limit);
    test::sufficient_limit({.memory_limit = 100000}, [&](Detector& enough) { EXPECT_FALSE(enough.any(soup.view())); });
}

}  // namespace
}  // namespace crumple
