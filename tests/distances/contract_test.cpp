// What docs/nearest.md promises, one claim a test.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>
#include <vector>

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

class NearestBodiesOf : public testing::TestWithParam<Backend> {
   protected:
    const Distances& find(const std::vector<Body>& bodies, const std::vector<Pose>& poses,
                          const DistanceQuery& question = {}) {
        return detector_.find(World{shapes_, bodies, poses}, question);
    }

    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    std::vector<Shape> shapes_{Shape(MeshView(square, halves), 1)};
};

using Rows = std::vector<std::array<std::int32_t, 2>>;
Rows rows(const Distances& answer) {
    Rows rows;
    for (const BodyPair& pair : answer.bodies) rows.push_back({pair.first, pair.second});
    return rows;
}

TEST_P(NearestBodiesOf, two_squares_above_each_other) {
    const Distances& found = find({{}, {}}, {{}, moved(0.25, 0.5, 3)});
    ASSERT_EQ(rows(found), (Rows{{0, 1}}));
    EXPECT_EQ(found.squared_distance[0], 9);
    EXPECT_EQ(found.touching[0], 0);
    EXPECT_EQ(found.triangles[0], (Pair{0, 0})) << "the first of those that are at that distance";
    EXPECT_EQ(found.points[0][0][2], 0);
    EXPECT_EQ(found.points[0][1][2], 3);
    EXPECT_EQ(found.points[0][0][0], found.points[0][1][0]);
    EXPECT_EQ(found.statistics.pairs, 1);
}
TEST_P(NearestBodiesOf, bodies_that_touch) {
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
TEST_P(NearestBodiesOf, several_worlds_in_the_order_of_their_bodies) {
    const std::vector<Body> bodies{{.world = 0}, {.world = 0}, {.world = 2}, {.world = -1}, {.world = -1}};
    const std::vector<Pose> poses{{}, moved(3), moved(0, 5), moved(0, 0, 4), moved(0, 0, -1)};
    EXPECT_EQ(rows(find(bodies, poses)), (Rows{{0, 1}, {0, 3}, {0, 4}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}));
}
TEST_P(NearestBodiesOf, each_world_the_nearest_pair) {
    const std::vector<Body> bodies{{.world = 0}, {.world = 0},  {.world = 0}, {.world = 2},
                                   {.world = 3}, {.world = -1}, {.world = -1}};
    const std::vector<Pose> poses{{}, moved(3), moved(-3), moved(0, 5), moved(40), moved(0, 0, 4), moved(0, 0, -1)};
    DistanceQuery question{.output = Output::nearest};
    const Distances& all = find(bodies, poses, question);
    EXPECT_EQ(rows(all), (Rows{{0, 6}, {3, 6}, {4, 6}})) << "those that are in all worlds have no row";
    EXPECT_EQ((std::vector<std::int64_t>(all.world_rows.begin(), all.world_rows.end())),
              (std::vector<std::int64_t>{0, -1, 1, 2}));
    EXPECT_EQ(all.squared_distance[0], 1);
    question.radius = 20;
    const Distances& near = find(bodies, poses, question);
    EXPECT_EQ(rows(near), (Rows{{0, 6}, {3, 6}}));
    EXPECT_EQ((std::vector<std::int64_t>(near.world_rows.begin(), near.world_rows.end())),
              (std::vector<std::int64_t>{0, -1, 1, -1}));
    question.filter.excluded_bodies = {{0, 6}, {1, 6}, {2, 6}};
    EXPECT_EQ(rows(find(bodies, poses, question))[0], (std::array<std::int32_t, 2>{0, 1})) << "the first of two at 2";
}
TEST_P(NearestBodiesOf, each_world_the_first_of_pairs_that_touch) {
    const std::vector<Body> bodies(4);
    const std::vector<Pose> poses{moved(9), {}, moved(0.5), moved(0.5, 0.5)};
    EXPECT_EQ(rows(find(bodies, poses, {.output = Output::nearest})), (Rows{{1, 2}}));
}
TEST_P(NearestBodiesOf, those_within_the_radius_which_counts) {
    const std::vector<Pose> poses{{}, moved(0, 0, 2), moved(0, 0, 5)};
    const std::vector<Body> bodies(3);
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 2})), (Rows{{0, 1}}));
    EXPECT_EQ(rows(find(bodies, poses, {.radius = std::nextafter(2, 0)})), Rows{});
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 3})), (Rows{{0, 1}, {1, 2}}));
    EXPECT_EQ(rows(find(bodies, poses, {.radius = 0})), Rows{});
    EXPECT_EQ(rows(find(bodies, {{}, moved(0, 1), moved(9)}, {.radius = 0})), (Rows{{0, 1}}));
    EXPECT_EQ(find(bodies, poses, {.radius = infinity}).bodies.size(), 3u);
}
TEST_P(NearestBodiesOf, what_the_rules_want) {
    const std::vector<Body> bodies{{.group = 0}, {.group = 1}, {.group = 1}};
    const std::vector<Pose> poses{{}, moved(2), moved(4)};
    DistanceQuery question;
    question.filter.excluded_bodies = {{1, 0}};
    EXPECT_EQ(rows(find(bodies, poses, question)), (Rows{{0, 2}, {1, 2}}));
    question.filter = {};
    question.filter.groups = PairScope::between;
    EXPECT_EQ(rows(find(bodies, poses, question)), (Rows{{0, 1}, {0, 2}}));
    question.filter = {};
    question.filter.excluded_groups = {{1, 1}};
    EXPECT_EQ(rows(find(bodies, poses, question)), (Rows{{0, 1}, {0, 2}}));
}
/// The nearer half of the square is of an excluded group, so that the other one counts.
TEST_P(NearestBodiesOf, triangles_of_wanted_groups_alone) {
    const std::vector<std::int32_t> groups{5, 6};
    shapes_.push_back(Shape(MeshView(square, halves, groups), 2));
    const std::vector<Body> bodies{{.shape = 0, .group = 0}, {.shape = 1}};
    const std::vector<Pose> poses{moved(3), {}};
    EXPECT_EQ(find(bodies, poses).triangles[0], (Pair{0, 0}));
    DistanceQuery question;
    question.filter.excluded_groups = {{0, 5}};
    const Distances& found = find(bodies, poses, question);
    EXPECT_EQ(found.triangles[0].b, 1);
    EXPECT_EQ(found.squared_distance[0], 4);
    question.filter.excluded_groups = {{0, 5}, {0, 6}};
    EXPECT_EQ(rows(find(bodies, poses, question)), Rows{}) << "no pair of triangles is wanted";
}
TEST_P(NearestBodiesOf, nothing) {
    EXPECT_EQ(rows(find({}, {})), Rows{});
    EXPECT_EQ(rows(find({{}}, {})), Rows{}) << "a body is not near itself";
    const std::vector<std::array<std::int32_t, 3>> none;
    shapes_.push_back(Shape(MeshView(square, none)));
    EXPECT_EQ(rows(find({{.shape = 0}, {.shape = 1}, {.shape = 0}}, {})), (Rows{{0, 2}}));
}
TEST_P(NearestBodiesOf, no_world_that_is_wrong) {
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

INSTANTIATE_TEST_SUITE_P(, NearestBodiesOf, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& info) { return std::string(backend_name(info.param)); });

TEST(NearestBodies, AreHandedOver) {
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

/// Trees of named shapes are those of other questions about worlds.
TEST(NearestBodies, KnowNamedShapes) {
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

/// The first of all pairs that intersect, however many there are, and where their contact begins.
TEST(NearestBodies, ThatTouchNameTheFirstPair) {
    Detector detector({.backend = Backend::cpu}), other({.backend = Backend::cpu});
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    for (unsigned seed = 0; seed < 60; ++seed) {
        const auto a = random_soup(400, 0.2, 2 * seed + 1), b = random_soup(400, 0.2, 2 * seed + 2);
        const std::vector<Shape> shapes{Shape(a.view()), Shape(b.view())};
        const std::vector<Pose> poses{{}, moved(0.001 * seed, 0.3)};
        IntersectionQuery question{.output = Output::contacts};
        question.filter.bodies = PairScope::between;
        const Intersections& all = other.find(World{shapes, bodies, poses}, question);
        const Distances& found = detector.find(World{shapes, bodies, poses}, DistanceQuery());
        ASSERT_GT(all.count, 20);
        ASSERT_EQ(found.triangles[0], all.pairs[0]) << "seed " << seed;
        ASSERT_EQ(found.points[0][0], all.contacts.points[0]);
    }
}

TEST(NearestBodies, EndSoonAfterAStop) {
    const auto soup = random_soup(3000, 0.05);
    const std::vector<Shape> shapes{Shape(soup.view(), 1)};
    const std::vector<Body> bodies(200);
    std::vector<Pose> poses;
    for (int i = 0; i < 200; ++i) poses.push_back(moved(0.01 * i, 2.5 * i));
    Detector detector({.backend = Backend::cpu, .threads = 2});
    std::stop_source stop;
    int polls = 0;
    detector.set_poll([&] { ++polls, stop.request_stop(); });
    const auto call = [&] { detector.find(World{shapes, bodies, poses}, DistanceQuery(), stop.get_token()); };
    EXPECT_EQ(error_of(call).code, ErrorCode::cancelled);
    EXPECT_EQ(polls, 1);
}

class NearestMemory : public testing::TestWithParam<int> {};

/// Under each limit the same answer within it, or an error with a limit that suffices.
TEST_P(NearestMemory, HoldsToTheLimit) {
    const auto world = random_world(3, {.shapes = 4, .bodies = 30, .triangles = 300, .named = 0.7, .reach = 3});
    const Options options{.backend = Backend::cpu, .threads = GetParam()};
    Detector free(options);
    const std::int64_t peak = free.find(world->view(), DistanceQuery()).statistics.peak_memory_bytes;
    Distances expected;
    free.swap_result(expected);
    bool refused = false, kept = false;
    for (std::int64_t limit = peak; limit > 1000; limit = limit * 3 / 5) {
        SCOPED_TRACE(limit);
        Options tight = options;
        tight.memory_limit = limit;
        Detector limited(tight);
        try {
            const Distances& found = limited.find(world->view(), DistanceQuery());
            EXPECT_LE(found.statistics.peak_memory_bytes, limit);
            EXPECT_TRUE(same_nearest(found, expected));
            kept = true;
        } catch (const Error& error) {
            refused = true;
            ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
            EXPECT_GT(error.bytes_needed, limit);
            tight.memory_limit =
                sufficient_limit(tight, [&](Detector& detector) { detector.find(world->view(), DistanceQuery()); });
            for (int again = 0; again < 3; ++again) {
                Detector enough(tight);
                const Distances& found = enough.find(world->view(), DistanceQuery());
                EXPECT_LE(found.statistics.peak_memory_bytes, tight.memory_limit);
                EXPECT_TRUE(same_nearest(found, expected));
            }
            EXPECT_NO_THROW(limited.find(World(), DistanceQuery())) << "usable still";
        }
    }
    EXPECT_TRUE(refused && kept);
}
INSTANTIATE_TEST_SUITE_P(Threads, NearestMemory, testing::Values(1, 3));

}  // namespace
}  // namespace crumple::test
