// Test of stage `output`, which sorts pairs in buckets, one for each range of first indices: with so many triangles
// that buckets are larger than usual, and so few pairs that most buckets are empty.

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "crumple/detector.h"

namespace crumple {
namespace {

TEST(Output, few_pairs_among_millions_of_triangles_are_sorted) {
    constexpr std::int32_t count = (1 << 21) + 4096, row = 1500;  // more than 2,048 buckets of 1,024 triangles hold
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
    vertices.reserve(3 * count);
    triangles.reserve(count);
    const auto add = [&](std::int32_t place) {
        const auto x = static_cast<float>(2 * (place % row)), y = static_cast<float>(2 * (place / row));
        const auto first = static_cast<std::int32_t>(vertices.size());
        vertices.insert(vertices.end(), {{x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0}});
        triangles.push_back({first, first + 1, first + 2});
    };
    const std::vector<std::int32_t> twice{0, 1023, 1024, 2047, 2048, 4095, 4096, 1 << 20, (1 << 21) - 1, 1 << 21};
    const auto apart = count - static_cast<std::int32_t>(twice.size());
    for (std::int32_t t = 0; t < apart; ++t) add(t);
    for (const std::int32_t t : twice) add(t);

    Detector detector({.backend = Backend::cpu});
    const Intersections& found = detector.find({vertices, triangles});
    ASSERT_EQ(found.pairs.size(), twice.size());
    ASSERT_EQ(found.offsets.size(), static_cast<std::size_t>(count) + 1);
    for (std::size_t i = 0; i < twice.size(); ++i) {
        EXPECT_EQ(found.pairs[i].a, twice[i]);
        EXPECT_EQ(found.pairs[i].b, apart + static_cast<std::int32_t>(i));
    }
    std::size_t before = 0;
    for (std::int32_t t = 0; t <= count; ++t) {
        ASSERT_EQ(found.offsets[static_cast<std::size_t>(t)], static_cast<std::int64_t>(before)) << t;
        if (before < twice.size() && twice[before] == t) ++before;
    }
}

}  // namespace
}  // namespace crumple
