// Compares pairs of triangles of a step with their definition.

#include "features/triangle_pairs.h"

#include <gtest/gtest.h>

#include "error_of.h"
#include "features/listed_soups.h"
#include "memory_limit.h"

namespace crumple::test {
namespace {

template <class Scalar>
class TrianglePairsOfAStep : public testing::Test {
   protected:
    static void compare(const MovingSoup<Scalar>& soup, ImpactQuery query) {
        query.index = true;
        query.triangle_pairs = false;
        Impacts features;
        reference().find(soup.view().moving_to(soup.end_view()), query);
        reference().swap_result(features);
        const TrianglePairs expected = triangle_pairs_of(soup, features, query.weld);
        query.triangle_pairs = true;
        Impacts all;
        reference().find(soup.view().moving_to(soup.end_view()), query);
        reference().swap_result(all);
        EXPECT_EQ(listed(all.triangle_pairs), expected);
        EXPECT_EQ(all.any, !expected.empty() || features.any) << "what touches without a face is no pair of triangles";
        for (const TestedDetector& entry : std::span(tested()).first(4)) {
            SCOPED_TRACE(entry.name);
            const Impacts& found = entry.detector->find(soup.view().moving_to(soup.end_view()), query);
            ASSERT_TRUE(same_list(found.triangle_pairs, all.triangle_pairs));
            EXPECT_EQ(found.any, all.any);
            for (std::size_t kind = 0; kind < feature_kinds; ++kind)
                ASSERT_TRUE(same_list(found.lists[kind], features.lists[kind])) << "as without";
        }
        Detector& detector = *tested()[1].detector;
        EXPECT_EQ(!detector.any(soup.view().moving_to(soup.end_view()), query), !all.any);
        EXPECT_TRUE(
            same_first(detector.find(soup.view().moving_to(soup.end_view()), FirstImpactQuery{query}), features.first));
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(TrianglePairsOfAStep, Precisions);

TYPED_TEST(TrianglePairsOfAStep, triangle_pairs_match_their_definition) {
    for (const auto& move : moving_soups<TypeParam>(0.4))
        for (const bool weld : {false, true}) {
            SCOPED_TRACE(testing::Message() << move.name << (weld ? ", welded" : ""));
            this->compare(move.soup, {.weld = weld});
            if (this->HasFatalFailure()) return;
        }
}

TYPED_TEST(TrianglePairsOfAStep, triangle_pairs_within_a_distance_match_their_definition) {
    for (const auto& move : moving_soups<TypeParam>(0.1)) {
        if (move.unit > 1e200) continue;
        SCOPED_TRACE(move.name);
        this->compare(move.soup, {.min_distance = 0.5 * move.unit});
    }
}

TYPED_TEST(TrianglePairsOfAStep, triangle_pairs_with_codimensional_features_match_definition) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        SCOPED_TRACE(seed);
        this->compare(with_lists(rounded<TypeParam>(moving_grid(4, 24, 20, 100 + seed)), seed), {});
    }
}

// A blade that sticks in a plate and moves along it: no vertex and no edge ever touches.
MovingSoup<> blade_in_a_plate(double x) {
    MovingSoup<> soup;
    const auto add = [&](double px, double py, double pz, double dx) { soup.vertex({px, py, pz}, {px + dx, py, pz}); };
    add(-9, -9, 0, 0);
    add(9, -9, 0, 0);
    add(0, 9, 0, 0);
    add(0, 0, -1, x);
    add(0.5, 0, 1, x);
    add(-0.5, 0.2, 1, x);
    soup.triangles = {{0, 1, 2}, {3, 4, 5}};
    return soup;
}

TEST(TrianglePairs, intersecting_triangles_without_impacts_are_triangle_pairs_only) {
    const MovingSoup<> soup = blade_in_a_plate(0.25);
    for (const Backend backend : {Backend::reference, Backend::cpu}) {
        Detector detector({.backend = backend});
        EXPECT_FALSE(detector.any(soup.view().moving_to(soup.end_view()), ImpactQuery()));
        EXPECT_EQ(detector.find(soup.view().moving_to(soup.end_view()), FreeStepQuery()).share, 1);
        const ImpactQuery query{.triangle_pairs = true};
        EXPECT_TRUE(detector.any(soup.view().moving_to(soup.end_view()), query));
        EXPECT_EQ(detector.find(soup.view().moving_to(soup.end_view()), FreeStepQuery{query}).share, 0);
        const Impacts& found = detector.find(soup.view().moving_to(soup.end_view()), query);
        EXPECT_TRUE(found.any);
        EXPECT_EQ(found.count, 0) << "impacts";
        EXPECT_EQ(listed(found.triangle_pairs), (TrianglePairs{{{0, 1}, {0, true}}}));
    }
}

TEST(TrianglePairs, free_step_ends_before_contact_of_triangles_apart_at_the_start) {
    MovingSoup<> soup = blade_in_a_plate(0);
    for (std::size_t v = 3; v < 6; ++v) soup.start[v][2] += 2;
    Detector detector({.backend = Backend::cpu});
    const ImpactQuery query{.triangle_pairs = true};
    const FreeStep step = detector.find(soup.view().moving_to(soup.end_view()), FreeStepQuery{query});
    EXPECT_GT(step.share, 0.4);
    EXPECT_LT(step.share, 0.5);
    const Impacts& found = detector.find(soup.view().moving_to(soup.end_view()), query);
    EXPECT_EQ(listed(found.triangle_pairs), (TrianglePairs{{{0, 1}, {0.5, false}}}));
}

TEST(TrianglePairs, triangle_pairs_are_listed_on_request_only) {
    const MovingSoup<> soup = blade_in_a_plate(0.25);
    Detector detector({.backend = Backend::cpu});
    EXPECT_EQ(detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery{.triangle_pairs = true})
                  .triangle_pairs.pairs.size(),
              1U);
    EXPECT_TRUE(detector.find(soup.view().moving_to(soup.end_view()), ImpactQuery()).triangle_pairs.pairs.empty());
    const ImpactQuery earliest{.output = Output::first, .triangle_pairs = true};
    const Impacts& first = detector.find(soup.view().moving_to(soup.end_view()), earliest);
    EXPECT_TRUE(first.any);
    EXPECT_FALSE(first.first.found) << "which is one of features";
    EXPECT_TRUE(first.triangle_pairs.pairs.empty());
}

TEST(TrianglePairs, limited_call_gives_same_result_or_names_larger_limit) {
    const MovingSoup<> soup = in_general(1200, 0.12, 0.05, 6);
    const ImpactQuery query{.triangle_pairs = true};
    Detector free({.backend = Backend::cpu, .threads = 2, .leaf_size = 40});
    Impacts expected;
    const std::int64_t peak = free.find(soup.view().moving_to(soup.end_view()), query).statistics.peak_memory_bytes;
    free.swap_result(expected);
    ASSERT_FALSE(expected.triangle_pairs.pairs.empty());
    bool refused = false;
    for (std::int64_t limit = peak; limit > 50'000; limit = limit * 2 / 3) {
        SCOPED_TRACE(limit);
        Options tight{.backend = Backend::cpu, .threads = 2, .memory_limit = limit, .leaf_size = 40};
        const auto expect_same = [&](Detector& detector) {
            const Impacts& found = detector.find(soup.view().moving_to(soup.end_view()), query);
            EXPECT_LE(found.statistics.peak_memory_bytes, tight.memory_limit);
            EXPECT_TRUE(same_list(found.triangle_pairs, expected.triangle_pairs));
        };
        Detector detector(tight);
        try {
            expect_same(detector);
        } catch (const Error& error) {
            refused = true;
            ASSERT_EQ(error.code, ErrorCode::memory_limit);
            EXPECT_GT(error.bytes_needed, limit);
            sufficient_limit(tight, [&](Detector& enough) {
                const Impacts& found = enough.find(soup.view().moving_to(soup.end_view()), query);
                EXPECT_TRUE(same_list(found.triangle_pairs, expected.triangle_pairs));
            });
        }
    }
    EXPECT_TRUE(refused) << "no limit was too small";
}

}  // namespace
}  // namespace crumple::test
