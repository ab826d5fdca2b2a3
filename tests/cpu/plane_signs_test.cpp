// Tests that the plane filter of each instruction set passes on the pairs, and the signs, that the filter for one pair
// computes. All numbers are small integers times one power of two, so no value is rounded, and many lie at the limits
// of certain signs.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "filters/intersection/pair_filters.h"
#include "tables.h"

namespace crumple::cpu {
namespace {

constexpr std::uint32_t triangles = 60;
constexpr unsigned vertices = 12;

/// Returns records of random triangles, and of a dummy after them. `big`: one in five has NaN corners.
std::vector<Record> make_records(float unit, bool big, std::mt19937& engine) {
    const auto integer = [&](int most) {
        return static_cast<float>(static_cast<int>(engine() % static_cast<unsigned>(2 * most + 1)) - most);
    };
    std::vector<Record> records(triangles + 1);
    for (std::size_t t = 0; t < triangles; ++t) {
        Record& record = records[t];
        const bool is_big = big && engine() % 5 == 0;
        for (float* coordinate : {record.x, record.y, record.z}) {
            for (int k = 0; k < 3; ++k)
                coordinate[k] = is_big ? std::numeric_limits<float>::quiet_NaN() : unit * integer(3);
            coordinate[3] = integer(1);
        }
        record.c = unit * integer(2);
        for (std::int32_t& id : record.id) id = static_cast<std::int32_t>(engine() % vertices);
    }
    records[triangles] = {{}, {}, {}, {-1, -1, -1}, -2};
    return records;
}

/// Lists half of all pairs.
void list_candidates(int group, std::mt19937& engine, CandidateChunk& out) {
    out.group = group;
    out.dummy = triangles;
    const auto add = [&](std::uint32_t row, std::uint32_t column) {
        out.row.push_back(static_cast<std::uint16_t>(row));
        out.column.push_back(static_cast<std::uint16_t>(column));
        ++out.count;
    };
    for (std::uint32_t row = 0; row < triangles; ++row) {
        for (std::uint32_t column = 0; column < triangles; ++column)
            if (row != column && engine() % 2) add(row, column);
        while (out.count % group) add(row, out.dummy);
    }
    while (out.count % 16) add(0, out.dummy);
    out.row.resize(out.row.size() + padding);
    out.column.resize(out.column.size() + padding);
}

using Numbers = std::vector<std::uint32_t>;

Numbers to_numbers(const Array<std::uint32_t>& list) { return {list.begin(), list.end()}; }

/// Pairs that the plane filter leaves, and data that it passes to the edge test and to the flat test.
struct Left {
    Numbers survivors, edges, edge_signs, flat, flat_shared;
};

Left filter_one_by_one(const std::vector<Record>& records, const CandidateChunk& candidates,
                       const NarrowPolicy& policy) {
    Left left;
    for (std::size_t i = 0; i < static_cast<std::size_t>(candidates.count); ++i) {
        if (candidates.column[i] == candidates.dummy) continue;
        const PairSigns signs = pair_signs(records[candidates.row[i]], records[candidates.column[i]]);
        const NextStep step = classify(signs, policy);
        if (step == NextStep::apart) continue;
        const std::uint32_t packed = std::uint32_t{candidates.column[i]} << 16 | candidates.row[i];
        left.survivors.push_back(packed);
        if (step == NextStep::edge) {
            left.edges.push_back(packed);
            left.edge_signs.push_back(signs.below_a | signs.below_b << 3);
        }
        if (step == NextStep::open && signs.shared_b) {
            left.flat.push_back(packed);
            left.flat_shared.push_back(signs.shared_b | signs.shared_a << 3);
        }
    }
    return left;
}

Left filter_by_simd(const IntersectKernels& kernels, const std::vector<Record>& records,
                    const CandidateChunk& candidates, const NarrowPolicy& policy) {
    const std::vector<float> points(4 * vertices + padding);
    Verdicts verdicts(nullptr);
    kernels.filter(records.data(), candidates, {points.data(), nullptr}, policy, 1, verdicts);
    Left left{{},
              to_numbers(verdicts.edges),
              to_numbers(verdicts.edge_signs),
              to_numbers(verdicts.flat),
              to_numbers(verdicts.flat_shared)};
    std::copy_if(verdicts.survivor.begin(), verdicts.survivor.begin() + verdicts.edge_tests,
                 std::back_inserter(left.survivors),
                 [&](std::uint32_t packed) { return packed >> 16 != candidates.dummy; });
    return left;
}

TEST(PlaneSigns, every_instruction_set_passes_on_the_signs_of_the_filter_for_one_pair) {
    std::mt19937 engine(41);
    for (const float unit : {1.0f, 0.5f, 0.0f, 0x1p-100f, 0x1p30f})
        for (const bool big : {false, true})
            for (const test::Tables& tables : test::kernel_tables()) {
                if (&tables.intersect == &scalar_intersect) continue;
                const std::vector<Record> records = make_records(unit, big, engine);
                CandidateChunk candidates(nullptr);
                list_candidates(tables.intersect.group, engine, candidates);
                for (const NarrowPolicy policy : {NarrowPolicy{}, {true, false}, {false, true}}) {
                    const Left expected = filter_one_by_one(records, candidates, policy);
                    const Left found = filter_by_simd(tables.intersect, records, candidates, policy);
                    const auto where = [&] {
                        return std::string(tables.name) + ", unit " + std::to_string(unit) + ", big " +
                               std::to_string(big) + ", policy " + std::to_string(policy.skip_adjacent) +
                               std::to_string(policy.proper);
                    };
                    ASSERT_EQ(found.survivors, expected.survivors) << where();
                    ASSERT_EQ(found.edges, expected.edges) << where();
                    ASSERT_EQ(found.edge_signs, expected.edge_signs) << where();
                    ASSERT_EQ(found.flat, expected.flat) << where();
                    ASSERT_EQ(found.flat_shared, expected.flat_shared) << where();
                }
            }
}

}  // namespace
}  // namespace crumple::cpu
