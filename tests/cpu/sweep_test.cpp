// Tests of sort and sweep: every pair of overlapping boxes that the leaf owns is a candidate exactly once.

#include <gtest/gtest.h>

#include <random>
#include <set>

#include "backends/cpu/stages/sort.h"

namespace crumple::cpu {
namespace {

LeafMembers make_members(int n, float size, std::mt19937& engine) {
    const auto number = [&] { return static_cast<float>(static_cast<double>(engine()) * 0x1p-31 - 1); };
    LeafMembers members(nullptr);
    constexpr float most = 3e38f;
    members.bounds = {{most, most, most}, {-most, -most, -most}, 1, 0};
    for (int i = 0; i < n; ++i) {
        Vec3f low, high;
        for (int axis = 0; axis < 3; ++axis) {
            const float centre = number(), half = size * std::abs(number());
            low[axis] = centre - half;
            high[axis] = centre + half;
        }
        members.bounds.low = min(members.bounds.low, low);
        members.bounds.high = max(members.bounds.high, high);
        members.boxes.low.push_back({low.x, low.y, low.z, 0});
        members.boxes.high.push_back({high.x, high.y, high.z, 0});
        members.triangle.push_back(i);
        members.member.push_back(i);
        members.lower.push_back(static_cast<std::uint16_t>(1u << (engine() % 16) & (engine() % 2 ? 0xffff : 0)));
    }
    members.boxes.low.resize(static_cast<std::size_t>(n + padding));
    members.boxes.high.resize(static_cast<std::size_t>(n + padding));
    return members;
}

/// True if the leaf owns the pair of members i and j, so that the sweep must report it.
bool is_owned(const LeafMembers& members, std::int64_t i, std::int64_t j) {
    if (members.between && (i < members.first_side) == (j < members.first_side)) return false;
    return !(members.lower[static_cast<std::size_t>(i)] & members.lower[static_cast<std::size_t>(j)]);
}

bool overlap(const Boxes& boxes, std::size_t i, std::size_t j) {
    const auto starts_before_end = [&](std::size_t s, std::size_t e) {
        const BoxCorner low = boxes.low[s], high = boxes.high[e];
        return low.x <= high.x && low.y <= high.y && low.z <= high.z;
    };
    return starts_before_end(i, j) && starts_before_end(j, i);
}

std::multiset<std::pair<int, int>> candidates_of(const StageKernels& kernels, const SortedLeaf& leaf,
                                                 std::int64_t capacity, int group = 4) {
    std::multiset<std::pair<int, int>> found;
    CandidateChunk out(nullptr);
    out.group = group;
    out.column.resize(static_cast<std::size_t>(capacity + block_stride + 4 * padding));
    out.row.resize(out.column.size());
    for (std::int64_t block = 0; block < leaf.rows; block += block_stride) {
        const std::int64_t block_end = std::min<std::int64_t>(block + block_stride, leaf.rows) - 1;
        const std::int64_t last = leaf.begin.empty() ? block_end : leaf.rows;
        for (std::int64_t row = 0; row < last;) {
            out.rows = row;
            out.columns = block;
            out.count = out.pairs = 0;
            row = kernels.sweep(leaf, row, std::min(last, row + 65535), block_end,
                                static_cast<std::uint16_t>(block_end - block), capacity, out);
            EXPECT_EQ(out.count % 16, 0);
            std::int64_t pairs = 0;
            for (std::size_t i = 0; i < static_cast<std::size_t>(out.count); ++i) {
                EXPECT_EQ(out.row[i], out.row[i - i % static_cast<std::size_t>(group)]);
                const int a = leaf.link[static_cast<std::size_t>(out.rows + out.row[i])].triangle;
                const int b = leaf.link[static_cast<std::size_t>(block + out.column[i])].triangle;
                if (b < 0) continue;
                ++pairs;
                found.insert({std::min(a, b), std::max(a, b)});
            }
            EXPECT_EQ(pairs, out.pairs);
            EXPECT_LE(out.count - pairs, (group - 1) * (row - out.rows) + 15) << kernels.name;
        }
    }
    return found;
}

TEST(Sweep, each_overlap_that_the_leaf_owns_is_found_once) {
    std::mt19937 engine(6);
    for (const StageKernels* kernels : all_stage_kernels()) {
        for (const int n : {1, 2, 31, 32, 33, 64, 700}) {
            for (const float size : {0.0f, 0.05f, 0.5f, 3.0f, -0.05f, -0.5f}) {
                LeafMembers members = make_members(n, std::abs(size), engine);
                members.between = size < 0;
                members.first_side = n / 3;
                SortScratch scratch(nullptr);
                SortedLeaf leaf(nullptr);
                sort_leaf(members, *kernels, scratch, leaf);
                for (const auto& [capacity, group] : {std::pair{1, 4}, {1 << 15, 4}, {1 << 15, 2}, {1 << 15, 1}}) {
                    const auto found = candidates_of(*kernels, leaf, capacity, group);
                    for (const auto& pair : found) {
                        EXPECT_EQ(found.count(pair), 1u) << kernels->name << ": " << pair.first << ' ' << pair.second;
                        EXPECT_TRUE(is_owned(members, pair.first, pair.second))
                            << kernels->name << ": " << pair.first << ' ' << pair.second;
                    }
                    std::int64_t overlaps = 0;
                    for (int a = 0; a < n; ++a)
                        for (int b = a + 1; b < n; ++b) {
                            const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
                            if (!is_owned(members, a, b) || !overlap(members.boxes, i, j)) continue;
                            ++overlaps;
                            ASSERT_EQ(found.count({a, b}), 1u) << kernels->name << ": " << a << ' ' << b << " of " << n;
                        }
                    EXPECT_LE(static_cast<std::int64_t>(found.size()), overlaps + overlaps / 50 + 40 * n)
                        << kernels->name << ": quantisation may let a few through";
                }
                EXPECT_GE(leaf.work, 0);
            }
        }
    }
}

TEST(Sweep, overlaps_of_300_members_of_a_leaf_too_large_for_16_bit_rows_are_found_once) {
    std::mt19937 engine(8);
    LeafMembers members = make_members(150000, 0.01f, engine);
    members.first_side = 70000;
    for (const bool between : {false, true}) {
        members.between = between;
        std::multiset<std::pair<int, int>> first;
        for (const StageKernels* kernels : all_stage_kernels()) {
            SortScratch scratch(nullptr);
            SortedLeaf leaf(nullptr);
            sort_leaf(members, *kernels, scratch, leaf);
            ASSERT_GT(leaf.rows, 2 * block_stride);
            const auto found = candidates_of(*kernels, leaf, 1 << 15);
            ASSERT_GT(found.size(), 500u);
            if (first.empty()) {
                first = found;
                // Checks the overlaps of the first members only: all pairs would take too long.
                for (int a = 0; a < 300; ++a)
                    for (int b = a + 1; b < 150000; ++b) {
                        const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
                        if (is_owned(members, a, b) && overlap(members.boxes, i, j)) {
                            ASSERT_EQ(found.count({a, b}), 1u) << a << ' ' << b;
                        }
                    }
            }
            EXPECT_TRUE(found == first) << kernels->name;
        }
    }
}

}  // namespace
}  // namespace crumple::cpu
