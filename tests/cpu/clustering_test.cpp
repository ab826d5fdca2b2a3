// Tests of Detector::cluster: the clusters, leaves and frames are those of the next search.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "crumple/detector.h"
#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::error_of;
using Vector = Clustering::Vector;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double distance(const Vector& a, const Vector& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }
Vector centroid(const test::Soup<float>& soup, std::size_t triangle) {
    Vector sum{};
    for (const std::int32_t v : soup.triangles[triangle])
        for (std::size_t i = 0; i < 3; ++i) sum[i] += double{soup.vertices[static_cast<std::size_t>(v)][i]} / 3;
    return sum;
}
std::set<std::int32_t> members_of(const Clustering& clustering, std::size_t leaf) {
    return {clustering.members.begin() + clustering.leaf_offsets[leaf],
            clustering.members.begin() + clustering.leaf_offsets[leaf + 1]};
}

/// Expects that the numbers of clusters, leaves and members are those of a result.
void expect_same_counts(const Clustering& clustering, const Statistics& statistics) {
    EXPECT_EQ(std::ssize(clustering.centres), statistics.clusters);
    EXPECT_EQ(std::ssize(clustering.leaf_cluster), statistics.leaves);
    EXPECT_EQ(std::ssize(clustering.members), statistics.members);
}

const Options small_leaves{.backend = Backend::cpu, .threads = 2, .clusters = 5, .leaf_size = 200};

TEST(ClusteringOfScene, clusters_are_those_of_the_next_search) {
    test::Soup<float> sheet = test::wavy_sheet(50);
    Detector detector(small_leaves), other(small_leaves);
    for (int frame = 0; frame < 4; ++frame) {
        const Clustering clustering = detector.cluster(sheet.view());
        EXPECT_EQ(detector.cluster(sheet.view()).centres, clustering.centres) << "the first call changed the detector";
        const Intersections &found = detector.find(sheet.view()), &expected = other.find(sheet.view());
        expect_same_counts(clustering, found.statistics);
        EXPECT_EQ(found.statistics.box_overlaps, expected.statistics.box_overlaps);
        EXPECT_EQ(found.statistics.interval_tests, expected.statistics.interval_tests);
        EXPECT_TRUE(clustering.complete);
        for (auto& [x, y, z] : sheet.vertices) x += 0.1f * y, z *= 1.1f;
    }
}

TEST(ClusteringOfScene, lists_fit_together) {
    const test::Soup<float> sheet = test::wavy_sheet(50);
    const std::size_t triangles = sheet.triangles.size();
    const Clustering c = Detector(small_leaves).cluster(sheet.view());
    ASSERT_EQ(c.centres.size(), 5u);
    ASSERT_EQ(c.offsets.size(), triangles + 1);
    ASSERT_EQ(c.offsets.back(), std::ssize(c.clusters));
    ASSERT_GT(c.leaf_cluster.size(), c.centres.size());
    ASSERT_EQ(c.leaf_centres.size(), c.leaf_cluster.size());
    ASSERT_EQ(c.axes.size(), c.leaf_cluster.size());
    ASSERT_EQ(c.leaf_offsets.size(), c.leaf_cluster.size() + 1);
    EXPECT_TRUE(std::is_sorted(c.leaf_cluster.begin(), c.leaf_cluster.end()));
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::set<std::int32_t> clusters(c.clusters.begin() + c.offsets[t], c.clusters.begin() + c.offsets[t + 1]);
        ASSERT_FALSE(clusters.empty());
        std::size_t nearest = 0;
        for (std::size_t k = 1; k < c.centres.size(); ++k)
            if (distance(centroid(sheet, t), c.centres[k]) < distance(centroid(sheet, t), c.centres[nearest]))
                nearest = k;
        EXPECT_EQ(c.nearest_cluster[t], static_cast<std::int32_t>(nearest)) << t;
        EXPECT_TRUE(clusters.count(c.nearest_cluster[t]));
        std::set<std::int32_t> of_leaves;
        for (std::size_t l = 0; l < c.leaf_cluster.size(); ++l)
            if (std::binary_search(c.members.begin() + c.leaf_offsets[l], c.members.begin() + c.leaf_offsets[l + 1],
                                   static_cast<std::int32_t>(t)))
                of_leaves.insert(c.leaf_cluster[l]);
        EXPECT_EQ(of_leaves, clusters) << "triangle " << t << " is in other clusters than its leaves";
        const auto home = static_cast<std::size_t>(c.nearest_leaf[t]);
        EXPECT_EQ(c.leaf_cluster[home], c.nearest_cluster[t]);
        EXPECT_TRUE(members_of(c, home).count(static_cast<std::int32_t>(t)));
    }
}

TEST(ClusteringOfScene, every_pair_has_a_common_leaf) {
    const test::Soup<float> sheet = test::wavy_sheet(50);
    Detector detector(small_leaves);
    const Clustering c = detector.cluster(sheet.view());
    std::vector<std::set<std::int32_t>> members;
    for (std::size_t l = 0; l < c.leaf_cluster.size(); ++l) members.push_back(members_of(c, l));
    const Intersections& found = detector.find(sheet.view());
    ASSERT_GT(found.pairs.size(), 100u);
    for (const Pair& pair : found.pairs)
        EXPECT_TRUE(std::any_of(members.begin(), members.end(), [&](const auto& leaf) {
            return leaf.count(pair.a) && leaf.count(pair.b);
        })) << testing::PrintToString(pair);
}

TEST(ClusteringOfScene, first_axis_is_the_sweep_direction) {
    test::Soup<float> flat = test::wavy_sheet(30);
    for (auto& [x, y, z] : flat.vertices) y *= 0.2f;  // widest along x
    Options options{.backend = Backend::cpu, .clusters = 1};
    const auto axes = [&](const Method& method) {
        options.method = method;
        return Detector(options).cluster(flat.view()).axes.at(0);
    };
    EXPECT_GT(std::abs(axes({})[0][0]), 0.99);
    EXPECT_EQ(axes({.sweep = SweepDirection::z})[0], (Vector{0, 0, 1}));
    const auto given = axes({.sweep = SweepDirection::given, .direction = {3, 0, -4}});
    EXPECT_NEAR(given[0][0], 0.6, 1e-6);
    EXPECT_NEAR(given[0][2], -0.8, 1e-6);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(dot(given[i], given[k]), i == k, 1e-6);
}

TEST(ClusteringOfScene, rule_that_may_lose_pairs_is_reported) {
    const test::Soup<float> sheet = test::wavy_sheet(50);
    Options options = small_leaves;
    options.method = {.membership = Membership::threshold, .threshold = 1};
    const Clustering c = Detector(options).cluster(sheet.view());
    EXPECT_FALSE(c.complete);
    EXPECT_EQ(c.clusters.size(), sheet.triangles.size()) << "each triangle is in its nearest cluster only";
}

TEST(ClusteringOfScene, second_mesh_follows_the_first_and_distant_triangles_are_left_out) {
    const test::Soup<float> a = test::random_soup(500, 0.2);
    test::Soup<float> b = test::random_soup(300, 0.2, 2);
    for (auto& [x, y, z] : b.vertices) x += 0.9f;
    Detector detector({.backend = Backend::cpu, .clusters = 2});
    const Clustering c = detector.cluster({a.view(), b.view()});
    ASSERT_EQ(c.nearest_cluster.size(), 800u);
    const auto left_out = std::count(c.nearest_cluster.begin(), c.nearest_cluster.end(), -1);
    EXPECT_GT(left_out, 100);
    EXPECT_LT(left_out, 800);
    for (std::size_t t = 0; t < 800; ++t) {
        EXPECT_EQ(c.nearest_cluster[t] < 0, c.offsets[t] == c.offsets[t + 1]);
        EXPECT_EQ(c.nearest_cluster[t] < 0, c.nearest_leaf[t] < 0);
    }
    expect_same_counts(c, detector.find({a.view(), b.view()}).statistics);
}

TEST(ClusteringOfScene, scene_without_triangles_has_one_empty_cluster) {
    const test::Soup<float> nothing;
    const Clustering c = Detector({.backend = Backend::cpu}).cluster(nothing.view());
    EXPECT_EQ(c.centres.size(), 1u);
    EXPECT_EQ(c.leaf_cluster.size(), 1u);
    EXPECT_EQ(c.axes[0][0], Vector{});
    EXPECT_TRUE(c.members.empty());
}

TEST(ClusteringOfScene, other_backends_and_scenes_are_refused) {
    const test::Soup<float> sheet = test::wavy_sheet(3);
    Detector reference({.backend = Backend::reference}), cpu({.backend = Backend::cpu});
    EXPECT_STREQ(error_of([&] { reference.cluster(sheet.view()); }).what(),
                 "clusters need the cpu backend (Options::backend)");
    EXPECT_EQ(error_of([&] { cpu.cluster(World{}); }).code, ErrorCode::invalid_argument);
    test::Soup<float> wrong = sheet;
    wrong.triangles[2][1] = 1000;
    EXPECT_EQ(error_of([&] { cpu.cluster(wrong.view()); }).code, ErrorCode::index_out_of_range);
}

}  // namespace
}  // namespace crumple
