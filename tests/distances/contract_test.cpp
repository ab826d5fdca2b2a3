// Checks the promises of docs/nearest.md, one per test.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>
#include <vector>

#include "detector/each_check_polls.h"
#include "distances/compare_nearest.h"
#include "error_of.h"
#include "memory_limit.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Pose moved(double x, double y = 0, double z = 0) { return {{1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z}}; }

/// A square of two triangles, at z = 0.
const std::vector<std::array<float, 3>> square{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
const std::vector<std::array<std::int32_t, 3>> halves{{0, 1, 2}, {0, 2, 3}};

class DistancesOfEachBackend : public testing::TestWithParam<Backend> {
   protected:
    const Distances& find(const std::vector<Body>& bodies, const std::vector<Pose>& poses,
                          const DistanceQuery& query = {}) {
        return detector_.find(World{shapes_, bodies, poses}, query);
    }

    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    std::vector<Shape> shapes_{Shape(MeshView(square, halves), 1)};
};

using Rows = std::vector<std::array<std::int32_t, 2>>;
Rows rows(const Distances& distances) {
    Rows rows;
    for (const BodyPair& pair : distances.bodies) rows.push_back({pair.first, pair.second});
    return rows;
}

TEST_P(DistancesOfEachBackend, distance_triangles_and_points_are_reported) {
    const Distances& found = find({{}, {}}, {{}, moved(0.25, 0.5, 3)});
    ASSERT_EQ(rows(found), (Rows{{0, 1}}));
    EXPECT_EQ(found.squared_distance[0], 9);
    EXPECT_EQ(found.touching[0], 0);
    EXPECT_EQ(found.triangles[0], (Pair{0, 0})) << "the first of those that are at that distance";
    EXPECT_EQ(found.points[0][0][2], 0);
    EXPECT_EQ(found.points[0][1][2], 3);
    EXPECT_EQ(found.points[0][0][0], found.points[0][1][0]);
    EXPECT_EQ(found.points[0][0][1], found.points[0][1][1]);
    EXPECT_TRUE(found.points[0][0][0] >= 0.25 && found.points[0][0][0] <= 1) << "where both squares are";
    EXPECT_TRUE(found.points[0][0][1] >= 0.5 && found.points[0][0][1] <= 1) << "where both squares are";
    EXPECT_EQ(found.statistics.pairs, 1);
}
TEST_P(DistancesOfEachBackend, touching_bodies_have_distance_zero) {
    const Distances& found = find({{}, {}, {}}, {{}, moved(1, 0.5), moved(0.5, 0.5, 0)});
    ASSERT_EQ(found.bodies.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(found.touching[i], 1);
        EXPECT_EQ(found.squared_distance[i], 0);
        EXPECT_EQ(found.points[i][0], found.points[i][1]);
    }
    EXPECT_EQ(found.triangles[0], (Pair{0, 0}));
    EXPECT_EQ(found.triangles[1], (Pair{0, 0}));
    EXPECT_EQ(found.points[0][0], (std::array<double, 3>{1, 0.5, 0}));
}
TEST_P(DistancesOfEachBackend, rows_are_sorted_by_pair_of_bodies_across_worlds) {
    const std::vector<Body> bodies{{.world = 0}, {.world = 0}, {.world = 2}, {.world = -1}, {.world = -1}};
    const std::vector<Pose> poses{{}, moved(3), moved(0, 5), moved(0, 0, 4), moved(0, 0, -1)};
    EXPECT_EQ(rows(find(bodies, poses)), (Rows{{0, 1}, {0, 3}, {0, 4}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}));
}
TEST_P(DistancesOfEachBackend, nearest_output_lists_at_most_one_pair_per_world) {
    const std::vector<Body> bodies{{.world = 0}, {.world = 0},  {.world = 0}, {.world = 2},
                                   {.world = 3}, {.world = -1}, {.world = -1}};
    const std::vector<Pose> poses{{}, moved(3), moved(-3), moved(0, 5), moved(40), moved(0, 0, 4), moved(0, 0, -1)};
    DistanceQuery query{.output = Output::nearest};
    const Distances& all = find(bodies, poses, query);
    EXPECT_EQ(rows(all), (Rows{{0, 6}, {3, 6}, {4, 6}})) << "those that are in all worlds have no row";
    EXPECT_EQ((std::vector<std::int64_t>(all.world_rows.begin(), all.world_rows.end())),
              (std::vector<std::int64_t>{0, -1, 1, 2}));
    EXPECT_EQ(all.squared_distance[0], 1);
    query.radius = 20;
    const Distances& near = find(bodies, poses, query);
    EXPECT_EQ(rows(near), (Rows{{0, 6}, {3, 6}}));
    EXPECT_EQ((std::vector<std::int64_t>(near.world_rows.begin(), near.world_rows.end())),
              (std::vector<std::int64_t>{0, -1, 1, -1}));
    query.filter.excluded_bodies = {{0, 6}, {1, 6}, {2, 6}};
    EXPECT_EQ(rows(find(bodies, poses, query))[0], (std::array<std::int32_t, 2>{0, 1})) << "the first of two at 2";
}
TEST_P(DistancesOfEachBackend, nearest_output_takes_the_first_touching_pair) {
    const std::vector<Body> bodies(4);
    const std::vector<Pose> poses{moved(9), {}, moved(0.5), moved(0.5, 0.5)};
    EXPECT_EQ(rows(find(bodies, poses, {.output = Output::nearest})), (Rows{{1, 2}}));
}
TEST_P(DistancesOfEachBackend, radius_is_inclusive) {
    const std::vector<Pose> poses{{}, moved(0, 0, 2), moved(0, 0, 5)};
    const std::vector<Body> bodies(3);
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 2})), (Rows{{0, 1}}));
    EXPECT_EQ(rows(find(bodies, poses, {.radius = std::nextafter(2, 0)})), Rows{});
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 3})), (Rows{{0, 1}, {1, 2}}));
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 0})), Rows{});
    EXPECT_EQ(rows(find(bodies, {{}, moved(0, 1), moved(9)}, {.radius = 0})), (Rows{{0, 1}}));
    EXPECT_EQ(find(bodies, poses, {.radius = infinity}).bodies.size(), 3u);
}
TEST_P(DistancesOfEachBackend, filter_excludes_bodies_and_groups) {
    const std::vector<Body> bodies{{.group = 0}, {.group = 1}, {.group = 1}};
    const std::vector<Pose> poses{{}, moved(2), moved(4)};
    DistanceQuery query;
    query.filter.excluded_bodies = {{1, 0}};
    EXPECT_EQ(rows(find(bodies, poses, query)), (Rows{{0, 2}, {1, 2}}));
    query.filter = {};
    query.filter.groups = PairScope::between;
    EXPECT_EQ(rows(find(bodies, poses, query)), (Rows{{0, 1}, {0, 2}}));
    query.filter = {};
    query.filter.excluded_groups = {{1, 1}};
    EXPECT_EQ(rows(find(bodies, poses, query)), (Rows{{0, 1}, {0, 2}}));
}
/// Both halves of the square are at the same distance. The first one belongs to an excluded group, so the other one is
/// reported.
TEST_P(DistancesOfEachBackend, triangles_of_excluded_groups_do_not_count) {
    const std::vector<std::int32_t> groups{5, 6};
    shapes_.push_back(Shape(MeshView(square, halves, groups), 2));
    const std::vector<Body> bodies{{.shape = 0, .group = 0}, {.shape = 1}};
    const std::vector<Pose> poses{moved(3), {}};
    EXPECT_EQ(find(bodies, poses).triangles[0], (Pair{0, 0}));
    DistanceQuery query;
    query.filter.excluded_groups = {{0, 5}};
    const Distances& found = find(bodies, poses, query);
    EXPECT_EQ(found.triangles[0].b, 1);
    EXPECT_EQ(found.squared_distance[0], 4);
    query.filter.excluded_groups = {{0, 5}, {0, 6}};
    EXPECT_EQ(rows(find(bodies, poses, query)), Rows{}) << "no pair of triangles is wanted";
}
TEST_P(DistancesOfEachBackend, empty_worlds_and_shapes_have_no_rows) {
    EXPECT_EQ(rows(find({}, {})), Rows{});
    EXPECT_EQ(rows(find({{}}, {})), Rows{}) << "a body is not near itself";
    const std::vector<std::array<std::int32_t, 3>> none;
    shapes_.push_back(Shape(MeshView(square, none)));
    EXPECT_EQ(rows(find({{.shape = 0}, {.shape = 1}, {.shape = 0}}, {})), (Rows{{0, 2}}));
}
TEST_P(DistancesOfEachBackend, invalid_queries_and_worlds_are_rejected) {
    const auto refused = [&](auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(rows(find({{}, {}}, {{}, moved(3)})), (Rows{{0, 1}})) << "usable still";
        return error;
    };
    for (const double radius : {-1.0, std::numeric_limits<double>::quiet_NaN(), -infinity})
        EXPECT_EQ(refused([&] { find({{}}, {}, {.radius = radius}); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(refused([&] { find({{}}, {}, {.output = Output::any}); }).element, Element::option);
    DistanceQuery within;
    within.filter.bodies = PairScope::within;
    EXPECT_EQ(refused([&] { find({{}}, {}, within); }).element, Element::option);
    EXPECT_EQ(refused([&] { find({{.shape = 4}}, {}); }).element, Element::body);
    const Error infinite = refused([&] { find({{}, {}}, {{}, moved(std::numeric_limits<double>::max())}); });
    EXPECT_EQ(infinite.code, ErrorCode::not_finite);
    EXPECT_STREQ(infinite.what(), "body 1: vertex 0 is posed to infinity");
    const std::vector<std::array<std::int32_t, 3>> wrong{{0, 1, 9}};
    shapes_.push_back(Shape(MeshView(square, wrong)));
    EXPECT_EQ(refused([&] { find({{}, {.shape = 1}}, {}); }).code, ErrorCode::index_out_of_range);
    std::stop_source stop;
    stop.request_stop();
    const std::vector<Body> bodies(2);
    const auto stopped = [&] { detector_.find(World{shapes_, bodies, {}}, DistanceQuery(), stop.get_token()); };
    EXPECT_EQ(refused(stopped).code, ErrorCode::cancelled);
}

INSTANTIATE_TEST_SUITE_P(, DistancesOfEachBackend, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& info) { return std::string(backend_name(info.param)); });

TEST(DistanceCalls, swap_result_moves_the_result_without_copying) {
    const std::vector<Shape> shapes{Shape(MeshView(square, halves), 1)};
    const std::vector<Body> bodies(2);
    const std::vector<Pose> poses{{}, moved(0, 0, 3)};
    Detector detector({.backend = Backend::cpu});
    const BodyPair* const storage = detector.find(World{shapes, bodies, poses}, DistanceQuery()).bodies.data();
    Distances taken;
    detector.swap_result(taken);
    EXPECT_EQ(taken.bodies.data(), storage);
    EXPECT_EQ(taken.squared_distance[0], 9);
    EXPECT_EQ(taken.statistics.pairs, 1);
    EXPECT_TRUE(detector.find(World{shapes, {}, {}}, DistanceQuery()).bodies.empty());
}

/// Trees of named shapes are shared with other queries about worlds.
TEST(DistanceCalls, vertices_of_a_cached_named_shape_are_not_read_again) {
    const auto soup = random_soup(50, 0.2);
    std::vector<Shape> shapes{Shape(soup.view(), 7)};
    const std::vector<Body> bodies(2);
    const std::vector<Pose> poses{{}, moved(3)};
    Detector detector({.backend = Backend::cpu});
    detector.find(World{shapes, bodies, poses}, {.output = Output::any});
    const Distances expected = detector.find(World{shapes, bodies, poses}, DistanceQuery());
    auto other = soup;
    for (auto& p : other.vertices) p = {9, 9, 9};
    shapes[0] = Shape(other.view(), 7);
    EXPECT_TRUE(same_nearest(detector.find(World{shapes, bodies, poses}, DistanceQuery()), expected))
        << "it is not read again";
    other.triangles.pop_back();
    shapes[0] = Shape(other.view(), 7);
    EXPECT_EQ(error_of([&] { detector.find(World{shapes, bodies, poses}, DistanceQuery()); }).element, Element::shape);
}

/// Expects the first of many intersecting pairs, and the first point of its contact.
TEST(DistanceCalls, first_pair_that_intersects_is_reported) {
    Detector detector({.backend = Backend::cpu}), other({.backend = Backend::cpu});
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    for (unsigned seed = 0; seed < 60; ++seed) {
        const auto a = random_soup(400, 0.2, 2 * seed + 1), b = random_soup(400, 0.2, 2 * seed + 2);
        const std::vector<Shape> shapes{Shape(a.view()), Shape(b.view())};
        const std::vector<Pose> poses{{}, moved(0.001 * seed, 0.3)};
        IntersectionQuery query{.output = Output::contacts};
        query.filter.bodies = PairScope::between;
        const Intersections& all = other.find(World{shapes, bodies, poses}, query);
        const Distances& found = detector.find(World{shapes, bodies, poses}, DistanceQuery());
        ASSERT_GT(all.count, 20);
        ASSERT_EQ(found.triangles[0], all.pairs[0]) << "seed " << seed;
        ASSERT_EQ(found.points[0][0], all.contacts.points[0]);
    }
}

TEST(DistanceCalls, stop_request_in_a_poll_ends_the_call_before_the_next_poll) {
    const auto soup = random_soup(3000, 0.05);
    const std::vector<Shape> shapes{Shape(soup.view(), 1)};
    const std::vector<Body> bodies(200);
    std::vector<Pose> poses;
    for (int i = 0; i < 200; ++i) poses.push_back(moved(0.01 * i, 2.5 * i));
    const test::EachCheckPolls each_check_polls;
    Detector detector({.backend = Backend::cpu, .threads = 1});
    std::stop_source stop;
    int polls = 0;
    detector.set_poll([&] { ++polls, stop.request_stop(); });
    const auto call = [&] { detector.find(World{shapes, bodies, poses}, DistanceQuery(), stop.get_token()); };
    EXPECT_EQ(error_of(call).code, ErrorCode::cancelled);
    EXPECT_EQ(polls, 1);
}

class NearestMemory : public testing::TestWithParam<int> {};

/// Expects that a call under a limit either returns the same result and does not exceed the limit, or throws an error
/// whose bytes_needed lead to a sufficient limit.
TEST_P(NearestMemory, peak_stays_within_the_limit_or_the_query_is_refused) {
    const auto world = random_world(3, {.shapes = 4, .bodies = 30, .triangles = 300, .named = 0.7, .reach = 3});
    for (const Output output : {Output::pairs, Output::nearest}) {
        const DistanceQuery query{.output = output};
        const Options options{.backend = Backend::cpu, .threads = GetParam()};
        Detector free(options);
        const std::int64_t peak = free.find(world->view(), query).statistics.peak_memory_bytes;
        Distances expected;
        free.swap_result(expected);
        bool refused = false, succeeded = false;
        for (std::int64_t limit = peak; limit > 1000; limit = limit * 3 / 5) {
            SCOPED_TRACE(limit);
            Options tight = options;
            tight.memory_limit = limit;
            Detector limited(tight);
            try {
                const Distances& found = limited.find(world->view(), query);
                EXPECT_LE(found.statistics.peak_memory_bytes, limit);
                EXPECT_TRUE(same_nearest(found, expected));
                succeeded = true;
            } catch (const Error& error) {
                refused = true;
                ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
                EXPECT_GT(error.bytes_needed, limit);
                tight.memory_limit =
                    sufficient_limit(tight, [&](Detector& detector) { detector.find(world->view(), query); });
                for (int again = 0; again < 3; ++again) {
                    Detector enough(tight);
                    const Distances& found = enough.find(world->view(), query);
                    EXPECT_LE(found.statistics.peak_memory_bytes, tight.memory_limit);
                    EXPECT_TRUE(same_nearest(found, expected));
                }
                EXPECT_NO_THROW(limited.find(World(), query)) << "usable still";
            }
        }
        EXPECT_TRUE(refused && succeeded);
    }
}
INSTANTIATE_TEST_SUITE_P(Threads, NearestMemory, testing::Values(1, 3));

}  // namespace
}  // namespace crumple::test
