#pragma once

// Blocks of a feature result, joined and compared with the whole result.

#include <functional>
#include <numeric>
#include <tuple>
#include <vector>

#include "candidates/compare_candidates.h"
#include "features/compare_features.h"

namespace crumple::test {

// Returns the arrays of a list that have one element per row; blocks have only these.
inline auto rows_of(ImpactList& l) { return std::tie(l.pairs, l.bodies, l.toi, l.start); }
inline auto rows_of(ProximityList& l) {
    return std::tie(l.pairs, l.bodies, l.squared_distance, l.touching, l.type, l.at);
}
inline auto rows_of(CandidateList& l) { return std::tie(l.pairs, l.bodies); }

/// Calls visit(array, array) for each array of two lists.
template <class List, class Visit>
void for_each_array(List& a, List& b, Visit visit) {
    auto of_a = rows_of(a);
    std::apply([&](auto&... in_b) { std::apply([&](auto&... in_a) { (visit(in_a, in_b), ...); }, of_a); }, rows_of(b));
}

/// Sorts rows by their features; lists of the same rows get the same order.
template <class List>
void sort_rows(List& list) {
    std::vector<std::size_t> order(list.pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [&](std::size_t i) {
        return std::tuple(list.bodies.empty() ? BodyPair{} : list.bodies[i], list.pairs[i]);
    };
    std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return key(i) < key(j); });
    List sorted = list;
    for_each_array(list, sorted, [&](auto& from, auto& to) {
        if (from.empty()) return;
        for (std::size_t i = 0; i < order.size(); ++i) to[i] = from[order[i]];
    });
    list = std::move(sorted);
}

/// All blocks, concatenated.
template <class Result>
struct Joined {
    std::int64_t most;
    Result all = {};
    std::int64_t blocks = 0;

    void add(const Result& given) {
        Result block = given;
        std::int64_t rows = 0;
        for (std::size_t k = 0; k < block.lists.size(); ++k) {
            rows += static_cast<std::int64_t>(block.lists[k].pairs.size());
            for_each_array(all.lists[k], block.lists[k], [](auto& to, auto& from) {
                for (const auto& row : from) to.push_back(row);
            });
        }
        EXPECT_GE(rows, 1);
        EXPECT_LE(rows, most);
        EXPECT_EQ(block.count, all.count + rows);
        all.count = block.count;
        if (blocks++ > 0) {
            EXPECT_TRUE(same_bytes(block.edges, all.edges, "edges"));
            EXPECT_TRUE(same_bytes(block.first_edge, all.first_edge, "first edges"));
            EXPECT_TRUE(same_bytes(block.points, all.points, "points"));
            EXPECT_TRUE(same_bytes(block.first_point, all.first_point, "first points"));
        }
        all.edges = block.edges;
        all.first_edge = block.first_edge;
        all.points = block.points;
        all.first_point = block.first_point;
        merge(block);
    }

   private:
    void merge(const Candidates& block) { all.listed = block.listed; }
    void merge(const Proximities& block) {
        EXPECT_TRUE(block.any);
        EXPECT_TRUE(block.world_hit.empty());
        all.any = true;
    }
    void merge(const Impacts& block) {
        EXPECT_TRUE(block.any);
        EXPECT_TRUE(block.world_hit.empty());
        EXPECT_TRUE(block.world_first.empty());
        EXPECT_FALSE(block.first.found);
        all.any = true;
    }
};

/// Returns a whole result without the members that blocks do not have.
inline Candidates of_blocks(const Candidates& result) { return result; }
inline Proximities of_blocks(const Proximities& result) {
    Proximities all = result;
    all.world_hit.clear();
    return all;
}
inline Impacts of_blocks(const Impacts& result) {
    Impacts all = result;
    all.world_hit.clear();
    all.world_first.clear();
    all.first = {};
    return all;
}

inline testing::AssertionResult same_whole(const Candidates& found, const Candidates& expected) {
    return same_candidates(found, expected);
}
template <class Result>
testing::AssertionResult same_whole(const Result& found, const Result& expected) {
    testing::AssertionResult same = same_features(found, expected);
    if constexpr (std::is_same_v<Result, Proximities>)
        for (std::size_t k = 0; same && k < feature_kinds; ++k) {
            same = same_bytes(found.lists[k].type, expected.lists[k].type, "types");
            if (same) same = same_bytes(found.lists[k].at, expected.lists[k].at, "parameters");
        }
    return same;
}

/// One query as a find() call and as a stream() call.
template <class Result>
struct BothCalls {
    using Take = FunctionRef<void(const Result&)>;
    std::function<const Result&(Detector&)> find;
    std::function<Statistics(Detector&, Take, std::int64_t rows, std::stop_token)> stream;

    Statistics blocks(Detector& by, Take take, std::int64_t rows, std::stop_token stop = {}) const {
        return stream(by, take, rows, std::move(stop));
    }
};

/// Expects the detector to deliver blocks of `size` rows that together are the result.
template <class Result>
void expect_blocks(const BothCalls<Result>& calls, const Result& expected, Detector& by, std::int64_t size) {
    SCOPED_TRACE(testing::Message() << "blocks of " << size);
    Joined<Result> joined{size};
    const Statistics statistics = calls.blocks(
        by, [&](const Result& block) { joined.add(block); }, size);
    EXPECT_EQ(statistics.pairs, expected.count);
    EXPECT_EQ(joined.blocks, (expected.count + size - 1) / size) << "full blocks, but the last";
    if (expected.count == 0) return;
    Result whole = of_blocks(expected);
    for (Result* result : {&whole, &joined.all})
        for (auto& list : result->lists) sort_rows(list);
    EXPECT_TRUE(same_whole(joined.all, whole));
}

}  // namespace crumple::test
