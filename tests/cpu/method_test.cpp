// Tests of Options::method: sweep directions change no result, and membership rules that lose pairs say so.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "crumple/detector.h"
#include "crumple/error.h"
#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;

Method along(SweepDirection sweep) { return {.sweep = sweep}; }
Method along(double x, double y, double z) { return {.sweep = SweepDirection::given, .direction = {x, y, z}}; }
Method by(Membership rule, double threshold = 0) { return {.membership = rule, .threshold = threshold}; }

const std::vector<Method> sweeps{along(SweepDirection::pca), along(SweepDirection::x), along(SweepDirection::y),
                                 along(SweepDirection::z),   along(1, 2, -3),          along(-1e300, 1e300, 0),
                                 along(0, 0, 5e-324)};

/// Returns the mesh of a soup that moves to these positions.
MeshView moving(const test::Soup<float>& soup, const std::vector<std::array<float, 3>>& end) {
    return soup.view().moving_to(MeshView(end, soup.triangles).vertices);
}

/// Two triangles whose tips cross at x = 0. Their centroids are at x = -1.25 and 1.25, and the tips are 1.5 away from
/// these. With two clusters and no iteration of fuzzy C-means, the centres of the clusters are the centroids.
test::Soup<float> crossing() {
    test::Soup<float> soup;
    soup.vertices = {{-2, -0.1f, 0}, {-2, 0.1f, 0}, {0.25f, 0, 0}, {2, 0, -0.1f}, {2, 0, 0.1f}, {-0.25f, 0, 0}};
    soup.triangles = {{0, 1, 2}, {3, 4, 5}};
    return soup;
}
Options two_clusters(const Method& method) {
    return {.backend = Backend::cpu,
            .threads = 1,
            .clusters = 2,
            .fuzzy_c_means = {.max_iterations = 0, .first_iterations = 0},
            .method = method};
}

TEST(Method, sweep_directions_change_no_result) {
    const auto sheet = test::wavy_sheet(40);
    const auto soup = test::random_soup<double>(3000, 0.1);
    Detector plain({.backend = Backend::cpu});
    const Intersections of_sheet = plain.find(sheet.view()), between = plain.find({sheet.view(), soup.view()});
    ASSERT_GT(of_sheet.pairs.size(), 100u);
    ASSERT_GT(between.pairs.size(), 100u);
    for (const Method& method : sweeps)
        for (const int leaf_size : {40, 3000}) {
            Detector detector({.backend = Backend::cpu, .leaf_size = leaf_size, .method = method});
            const Intersections& found = detector.find(sheet.view());
            EXPECT_EQ(difference(pairs_of(of_sheet), pairs_of(found)), "");
            EXPECT_TRUE(found.statistics.complete);
            EXPECT_EQ(difference(pairs_of(between), pairs_of(detector.find({sheet.view(), soup.view()}))), "");
        }
}

TEST(Method, sweep_directions_change_no_result_of_queries_about_features) {
    const auto sheet = test::wavy_sheet(12);
    std::vector<std::array<float, 3>> end = sheet.vertices;
    for (auto& [x, y, z] : end) z = -z, x += 0.01f;
    const ProximityQuery near{.radius = 0.01};
    const ImpactQuery impact;
    Detector plain({.backend = Backend::cpu});
    const Proximities of_near = plain.find(sheet.view(), near);
    const Impacts of_impact = plain.find(moving(sheet, end), impact);
    const Candidates of_candidates = plain.find(sheet.view(), CandidateQuery{.inflation = 0.01});
    ASSERT_TRUE(of_near.any && of_impact.any && of_candidates.any);
    for (const Method& method : sweeps) {
        Detector detector({.backend = Backend::cpu, .leaf_size = 40, .method = method});
        EXPECT_EQ(detector.find(sheet.view(), near).count, of_near.count);
        EXPECT_EQ(detector.find(moving(sheet, end), impact).count, of_impact.count);
        EXPECT_EQ(detector.find(sheet.view(), CandidateQuery{.inflation = 0.01}).count, of_candidates.count);
    }
}

TEST(Method, sweep_directions_are_those_of_the_sweep) {
    // Thin strips across y: all overlap along x, none overlap along y.
    test::Soup<float> strips;
    for (std::int32_t t = 0; t < 200; ++t) {
        const float y = 0.01f * static_cast<float>(t);
        strips.vertices.insert(strips.vertices.end(), {{0, y, 0}, {3, y, 0}, {3, y + 0.001f, 0}});
        strips.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const auto tests = [&](const Method& method) {
        return Detector({.backend = Backend::cpu, .method = method}).find(strips.view()).statistics.interval_tests;
    };
    EXPECT_EQ(tests(along(SweepDirection::x)), 200 * 199 / 2);
    EXPECT_EQ(tests(along(SweepDirection::y)), 0);
    EXPECT_EQ(tests(along(0, 1, 0)), 0);
    EXPECT_EQ(tests(along(-7, 0, 0)), 200 * 199 / 2);
}

TEST(Method, equation_5_loses_the_pair_of_the_paper_and_says_so) {
    const auto soup = crossing();
    const Intersections whole = Detector(two_clusters({})).find(soup.view());
    ASSERT_EQ(pairs_of(whole), (std::vector<Pair>{{0, 1}}));
    EXPECT_TRUE(whole.statistics.complete);
    EXPECT_EQ(whole.statistics.clusters, 2);
    Detector detector(two_clusters(by(Membership::equation_5)));
    const Intersections& found = detector.find(soup.view());
    EXPECT_EQ(found.statistics.clusters, 2);
    EXPECT_EQ(pairs_of(found), std::vector<Pair>{});
    EXPECT_FALSE(found.statistics.complete);
}

TEST(Method, high_threshold_loses_a_pair_and_low_threshold_does_not) {
    const auto soup = crossing();
    Detector high(two_clusters(by(Membership::threshold, 1))), low(two_clusters(by(Membership::threshold, 0)));
    EXPECT_EQ(pairs_of(high.find(soup.view())), std::vector<Pair>{});
    EXPECT_FALSE(high.find(soup.view()).statistics.complete);
    EXPECT_EQ(pairs_of(low.find(soup.view())), (std::vector<Pair>{{0, 1}}));
    EXPECT_TRUE(low.find(soup.view()).statistics.complete);
}

TEST(Method, membership_follows_the_fuzziness) {
    // Centroids at x = -0.5 and 0.5, which are the centres; a third triangle at x = -0.25. Its distances are 0.25 and
    // 0.75. Its membership in the second cluster is 1 / (1 + 3^(2 / (t - 1))): 0.1 for t = 2, 0.25 for t = 3.
    test::Soup<float> soup;
    for (const float x : {-0.5f, 0.5f, -0.25f}) {
        const auto n = static_cast<std::int32_t>(soup.vertices.size());
        soup.vertices.insert(soup.vertices.end(),
                             {{x - 0.002f, 0, 0}, {x + 0.001f, 0.001f, 0}, {x + 0.001f, -0.001f, 0}});
        soup.triangles.push_back({n, n + 1, n + 2});
    }
    // Sample points of three triangles and two clusters: 0 and 2. So the third triangle is listed second.
    std::swap(soup.triangles[1], soup.triangles[2]);
    const auto members = [&](double fuzziness, double threshold) {
        Options options = two_clusters(by(Membership::threshold, threshold));
        options.fuzzy_c_means.fuzziness = fuzziness;
        return Detector(options).find(soup.view()).statistics.members;
    };
    EXPECT_EQ(members(2, 0.09), 4);
    EXPECT_EQ(members(2, 0.11), 3);
    EXPECT_EQ(members(3, 0.24), 4);
    EXPECT_EQ(members(3, 0.26), 3);
}

TEST(Method, results_that_claim_to_be_complete_are) {
    const auto soup = test::random_soup(3000, 0.15);
    const std::vector<Pair> expected = pairs_of(Detector({.backend = Backend::cpu}).find(soup.view()));
    ASSERT_GT(expected.size(), 1000u);
    int complete = 0, losing = 0;
    for (const Membership rule : {Membership::equation_5, Membership::threshold})
        for (const double threshold : {0.0, 0.001, 0.02, 0.1, 0.3, 1.0})
            for (const int clusters : {1, 2, 9})
                for (const int leaf_size : {100, 5000}) {
                    if (rule == Membership::equation_5 && threshold > 0) continue;
                    Detector detector({.backend = Backend::cpu,
                                       .threads = 2,
                                       .clusters = clusters,
                                       .leaf_size = leaf_size,
                                       .method = by(rule, threshold)});
                    for (int call = 0; call < 2; ++call) {
                        const Intersections& found = detector.find(soup.view());
                        const std::vector<Pair> pairs = pairs_of(found);
                        EXPECT_TRUE(std::includes(expected.begin(), expected.end(), pairs.begin(), pairs.end()));
                        if (found.statistics.complete) {
                            EXPECT_EQ(difference(expected, pairs), "") << threshold << ' ' << clusters;
                        }
                        complete += found.statistics.complete && clusters > 1;
                        losing += pairs.size() < expected.size();
                    }
                }
    EXPECT_GT(complete, 0);
    EXPECT_GT(losing, 0);
}

TEST(Method, all_ways_of_delivery_say_that_pairs_may_be_missing) {
    const auto soup = crossing();
    Detector detector(two_clusters(by(Membership::equation_5)));
    EXPECT_FALSE(detector.stream(soup.view(), IntersectionQuery(), [](const Intersections&) {}).complete);
    EXPECT_FALSE(detector.find(soup.view(), IntersectionQuery{.output = Output::any}).statistics.complete);
    EXPECT_FALSE(detector.find(soup.view(), ProximityQuery{.radius = 0.01}).statistics.complete);
    EXPECT_FALSE(detector.stream(soup.view(), ProximityQuery{.radius = 0.01}, [](const Proximities&) {}).complete);
    EXPECT_FALSE(detector.find(soup.view(), CandidateQuery()).statistics.complete);
    EXPECT_FALSE(detector.find(moving(soup, soup.vertices), ImpactQuery()).statistics.complete);
    const std::vector<std::array<std::int32_t, 3>> first{soup.triangles[0]}, second{soup.triangles[1]};
    const std::vector<Shape> shapes{Shape(MeshView(soup.vertices, first)), Shape(MeshView(soup.vertices, second))};
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    EXPECT_FALSE(detector.find(World{shapes, bodies, {}}).statistics.complete);
    test::Soup<float> one = soup;
    one.triangles.clear();
    EXPECT_TRUE(detector.find(one.view()).statistics.complete) << "the flag of an earlier call is still set";
}

TEST(Method, queries_whose_results_cannot_say_so_are_refused) {
    const auto soup = crossing();
    Detector detector(two_clusters(by(Membership::threshold, 0.5)));
    const auto refused = [&](auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_NE(std::string_view(error.what()).find("membership rule ball"), std::string_view::npos) << error.what();
    };
    const MeshView step = moving(soup, soup.vertices);
    refused([&] { detector.any(soup.view()); });
    refused([&] { detector.any(step, ImpactQuery()); });
    refused([&] { detector.find(step, FirstImpactQuery()); });
    refused([&] { detector.find(step, FreeStepQuery()); });
    refused([&] { detector.find(soup.view(), OverlapQuery()); });
    refused([&] { detector.stream(soup.view(), OverlapQuery(), [](const Overlaps&) {}); });
    refused([&] {
        detector.find({soup.view(), soup.view()}, IntersectionQuery{.output = Output::any, .containment = true});
    });
    EXPECT_FALSE(detector.supports(soup.view(), OverlapQuery()));
    EXPECT_TRUE(detector.supports(soup.view()));
}

TEST(Method, reference_ignores_the_method) {
    const auto soup = crossing();
    Options options = two_clusters(by(Membership::equation_5));
    options.backend = Backend::reference;
    Detector detector(options);
    EXPECT_EQ(pairs_of(detector.find(soup.view())), (std::vector<Pair>{{0, 1}}));
    EXPECT_TRUE(detector.find(soup.view()).statistics.complete);
    EXPECT_TRUE(detector.any(soup.view()));
    EXPECT_TRUE(detector.supports(soup.view(), OverlapQuery()));
}

TEST(Method, wrong_settings_are_rejected) {
    const auto infinity = std::numeric_limits<double>::infinity();
    for (const Method& method :
         {along(0, 0, 0), along(1, infinity, 0), Method{.direction = {1, 0, 0}}, by(Membership::threshold, -0.1),
          by(Membership::threshold, 1.1), by(Membership::threshold, infinity - infinity),
          by(Membership::equation_5, 0.5), Method{.sweep = static_cast<SweepDirection>(9)},
          Method{.membership = static_cast<Membership>(9)}})
        EXPECT_EQ(error_of([&] { Detector{Options{.method = method}}; }).code, ErrorCode::invalid_argument);
}

}  // namespace
}  // namespace crumple
