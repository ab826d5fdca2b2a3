// Tests of the claims of docs/worlds.md, one each.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>

#include "detector/each_check_polls.h"
#include "error_of.h"
#include "memory_limit.h"
#include "worlds/compare_worlds.h"
#include "worlds/random_worlds.h"

namespace crumple {
namespace {

using test::error_of;
using test::random_soup;
using test::same_bytes;

Pose moved(double x, double y = 0, double z = 0) { return {{1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z}}; }

std::vector<std::array<std::int32_t, 4>> rows(const Intersections& c) {
    std::vector<std::array<std::int32_t, 4>> rows;
    for (std::size_t i = 0; i < c.pairs.size(); ++i)
        rows.push_back({c.bodies[i].first, c.pairs[i].a, c.bodies[i].second, c.pairs[i].b});
    return rows;
}

TEST(World, pairs_and_contacts_of_one_unposed_body_equal_those_of_one_mesh) {
    for (const std::uint64_t name : {0u, 1u}) {
        const auto soup = random_soup(300, 0.3);
        Detector detector, other;
        const std::vector<Shape> shapes{Shape(soup.view(), name)};
        const std::vector<Body> bodies{{.self = true}};
        const Intersections& found =
            detector.find(World{shapes, bodies, {}}, {.output = Output::contacts, .index = true});
        const Intersections& expected = other.find(soup.view(), {.output = Output::contacts});
        ASSERT_GT(expected.pairs.size(), 50u);
        EXPECT_TRUE(test::same_pairs(found.pairs.span(), expected.pairs.span()));
        EXPECT_TRUE(same_bytes(found.hit, expected.hit, "hit flags"));
        EXPECT_TRUE(same_bytes(found.contacts.points, expected.contacts.points, "points"));
        EXPECT_TRUE(same_bytes(found.contacts.offsets, expected.contacts.offsets, "offsets"));
        EXPECT_TRUE(same_bytes(found.contacts.kinds, expected.contacts.kinds, "kinds"));
    }
}

TEST(World, pairs_and_contacts_of_two_unposed_bodies_equal_those_of_two_meshes) {
    const auto a = random_soup(200, 0.3), b = random_soup(250, 0.3, 5);
    for (const std::uint64_t name : {0u, 1u}) {
        Detector detector, other;
        const std::vector<Shape> shapes{Shape(a.view(), name), Shape(b.view(), 2 * name)};
        const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
        IntersectionQuery query{.output = Output::contacts};
        query.filter.bodies = PairScope::between;
        const Intersections& found = detector.find(World{shapes, bodies, {}}, query);
        const Intersections& expected = other.find({a.view(), b.view()}, {.output = Output::contacts});
        ASSERT_GT(expected.pairs.size(), 50u);
        EXPECT_TRUE(test::same_pairs(found.pairs.span(), expected.pairs.span()));
        EXPECT_TRUE(same_bytes(found.contacts.points, expected.contacts.points, "points"));
        EXPECT_TRUE(same_bytes(found.contacts.offsets, expected.contacts.offsets, "offsets"));
        EXPECT_TRUE(same_bytes(found.contacts.kinds, expected.contacts.kinds, "kinds"));
    }
}

TEST(World, rows_are_sorted_by_body_and_triangle_and_counted_by_world) {
    const auto soup = random_soup(40, 0.5);
    const std::vector<Shape> shapes{Shape(soup.view())};
    const std::vector<Body> bodies{{.world = 0, .self = true},
                                   {.world = 0, .self = true},
                                   {.world = 2, .self = true},
                                   {.world = -1, .self = true}};
    Detector detector;
    IntersectionQuery query{.index = true};
    query.filter.bodies = PairScope::between;
    const Intersections& found = detector.find(World{shapes, bodies, {}}, query);
    ASSERT_EQ(found.world_hit.size(), 3u);
    EXPECT_EQ(found.world_hit[1], 0);
    EXPECT_EQ(found.world_counts[1], 0);
    EXPECT_GT(found.world_counts[0], found.world_counts[2]);
    EXPECT_EQ(found.world_counts[0] + found.world_counts[2], found.count);
    EXPECT_EQ(found.world_offsets[3], found.count);
    EXPECT_EQ(found.body_offsets[4], found.count);
    std::array<std::int64_t, 3> counted{};
    for (std::size_t i = 0; i < found.bodies.size(); ++i) {
        const BodyPair& pair = found.bodies[i];
        ++counted[pair.first < 2 ? 0u : 2u];
        EXPECT_LT(pair.first, pair.second);
        EXPECT_TRUE((pair.first < 2 && pair.second != 2) || (pair.first == 2 && pair.second == 3));
    }
    for (std::size_t world = 0; world < 3; ++world) EXPECT_EQ(found.world_counts[world], counted[world]);
    const auto listed = rows(found);
    EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end()));
}

TEST(World, pairs_of_two_bodies_in_all_worlds_belong_to_no_world) {
    const auto soup = random_soup(40, 0.5);
    const std::vector<Shape> shapes{Shape(soup.view(), 1)};
    const std::vector<Body> bodies{
        {.world = 0, .self = false}, {.world = -1, .self = false}, {.world = -1, .self = false}};
    const std::vector<Pose> poses{moved(100), moved(0), moved(0.1)};
    Detector detector;
    const Intersections& found = detector.find(World{shapes, bodies, poses});
    EXPECT_GT(found.count, 0);
    EXPECT_EQ(found.world_counts[0], 0);
    EXPECT_EQ(found.world_hit[0], 0);
    EXPECT_TRUE(found.any);
    EXPECT_EQ(found.bodies[0], (BodyPair{1, 2}));
}

TEST(World, posed_float32_vertices_are_rounded_to_float32) {
    // 1/4 + 2/3 rounded to float32 is slightly larger, and touches a plane there.
    const std::vector<std::array<float, 3>> corner{{0.25f, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    const double step = 2.0 / 3;
    const auto touched = static_cast<double>(static_cast<float>(0.25 + step));
    const std::vector<std::array<double, 3>> plane{{touched, -1, -1}, {touched, 1, -1}, {touched, 0, 1}};
    const std::vector<std::array<std::int32_t, 3>> triangle{{0, 1, 2}};
    const std::vector<Shape> shapes{Shape(MeshView(corner, triangle)), Shape(MeshView(plane, triangle))};
    const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
    const std::vector<Pose> poses{moved(step), {}};
    ASSERT_LT(0.25 + step, touched) << "without rounding to float32 they would be apart";
    Detector detector;
    EXPECT_TRUE(detector.find(World{shapes, bodies, poses}, {.output = Output::any}).any);
}

TEST(World, named_shapes_are_cached) {
    auto soup = random_soup(500, 0.2);
    const auto probe = random_soup(20, 0.3, 9);
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    const auto shapes = [&](std::uint64_t name) {
        return std::vector<Shape>{Shape(soup.view(), name), Shape(probe.view())};
    };
    Detector detector;
    const auto named = shapes(7);
    const std::int64_t before = detector.find(World{named, bodies, {}}).count;
    ASSERT_GT(before, 0);
    for (auto& vertex : soup.vertices) vertex[0] += 100;
    EXPECT_EQ(detector.find(World{named, bodies, {}}).count, before) << "what was read first stays";
    EXPECT_EQ(detector.find(World{shapes(8), bodies, {}}).count, 0);
    EXPECT_EQ(detector.find(World{shapes(0), bodies, {}}).count, 0);
    const auto fewer = random_soup(499, 0.2);
    const std::vector<Shape> changed{Shape(fewer.view(), 7), Shape(probe.view())};
    const Error error = error_of([&] { detector.find(World{changed, bodies, {}}); });
    EXPECT_EQ(error.element, Element::shape);
    EXPECT_EQ(error.index, 0);
    EXPECT_EQ(detector.find(World{named, bodies, {}}).count, 0) << "after an error nothing is remembered";
}

// Shapes that a tree cannot split evenly: equal triangles, sizes from tiny to huge, a line, extents beyond float64.
TEST(World, named_shapes_that_do_not_split_evenly_match_brute_force) {
    constexpr int triangles = 60;
    std::vector<test::Soup<double>> soups(4);
    const auto add = [](test::Soup<double>& soup, const std::array<std::array<double, 3>, 3>& corners) {
        const auto first = static_cast<std::int32_t>(soup.vertices.size());
        soup.vertices.insert(soup.vertices.end(), corners.begin(), corners.end());
        soup.triangles.push_back({first, first + 1, first + 2});
    };
    for (int k = 0; k < triangles; ++k) {
        const double scale = std::ldexp(1.0, 4 * (k - triangles / 2)), far = k % 2 == 0 ? 1.5e308 : -1.5e308;
        add(soups[0], {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
        add(soups[1], {{{scale, 0, 0}, {2 * scale, scale, 0}, {scale, scale, scale}}});
        add(soups[2], {{{0.5 * k, 0, 0}, {0.5 * k + 1, 0, 0}, {0.5 * k + 0.25, 0, 0}}});
        add(soups[3], {{{far, 0.1 * k, 0}, {far, 0.1 * k + 1, 0}, {far / 2, 0.1 * k, 1}}});
    }
    std::vector<Shape> shapes;
    for (std::size_t s = 0; s < soups.size(); ++s) shapes.push_back(Shape(soups[s].view(), s + 1));
    std::vector<Body> bodies;
    std::vector<Pose> poses;
    for (std::int32_t b = 0; b < 8; ++b) {
        bodies.push_back({.shape = b / 2, .world = b / 2});
        poses.push_back(b % 2 == 0 ? Pose{} : moved(0.25));
    }
    Detector detector, reference(Options{.backend = Backend::reference});
    for (const Output output : {Output::body_pairs, Output::pairs}) {
        const Intersections& expected = reference.find(World{shapes, bodies, poses}, {.output = output});
        ASSERT_EQ(expected.world_hit.size(), 4u);
        EXPECT_TRUE(expected.world_hit[0] && expected.world_hit[1] && expected.world_hit[2]);
        EXPECT_TRUE(test::same_world_result(detector.find(World{shapes, bodies, poses}, {.output = output}), expected));
    }
}

TEST(World, reused_detector_matches_a_fresh_one_for_named_and_unnamed_shapes) {
    Detector lasting({.threads = 2});
    for (unsigned seed = 0; seed < 30; ++seed) {
        const auto world = test::random_world(seed % 5, {.named = 1, .mixed_precision = false});
        auto shapes = world->shapes;
        test::Dice dice(seed);
        for (Shape& shape : shapes) shape.name = dice.chance(0.3) ? 0 : shape.name + 100 * (seed % 5);
        const IntersectionQuery query = test::random_query(seed, 6);
        const World view{shapes, world->bodies, world->poses};
        Detector fresh({.threads = 1});
        ASSERT_TRUE(test::same_world_result(lasting.find(view, query), fresh.find(view, query))) << seed;
    }
}

TEST(World, sufficient_memory_limit_is_respected) {
    const auto soup = random_soup(3000, 0.1), other = random_soup(3000, 0.1, 2);
    const std::vector<Shape> shapes{Shape(soup.view(), 1), Shape(other.view(), 2)};
    const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
    Detector free;
    const std::int64_t pairs = free.find(World{shapes, bodies, {}}).count;
    const std::int64_t limit = test::sufficient_limit({.memory_limit = 100'000}, [&](Detector& by) {
        by.find(World{shapes, bodies, {}});
    });
    EXPECT_GT(limit, 100'000);
    Detector enough({.memory_limit = limit});
    const Intersections& found = enough.find(World{shapes, bodies, {}});
    EXPECT_EQ(found.count, pairs);
    EXPECT_LE(found.statistics.peak_memory_bytes, limit);
}

TEST(World, thousand_worlds_give_the_same_result_under_a_memory_limit) {
    const auto soup = random_soup(40, 0.4), other = random_soup(40, 0.4, 2);
    const std::vector<Shape> shapes{Shape(soup.view()), Shape(other.view(), 1)};
    std::vector<Body> bodies;
    for (std::int32_t world = 0; world < 1000; ++world)
        for (std::int32_t shape = 0; shape < 2; ++shape)
            bodies.push_back({.shape = shape, .world = world, .self = true});
    const World world{shapes, bodies, {}};
    const IntersectionQuery query{.output = Output::contacts, .index = true};
    Detector free, limited({.memory_limit = 1 << 28});
    const Intersections& found = limited.find(world, query);
    EXPECT_GE(found.count, 20'000);
    EXPECT_LE(found.statistics.peak_memory_bytes, 1 << 28);
    EXPECT_TRUE(test::same_world_result(found, free.find(world, query)));
}

TEST(World, blocks_hold_all_rows) {
    for (unsigned seed = 0; seed < 60; ++seed) {
        const auto world =
            test::random_world(seed, {.bodies = 8, .worlds = static_cast<int>(seed % 4), .triangles = 60});
        IntersectionQuery query = test::random_query(seed, 8);
        query.output = seed % 3 == 0 ? Output::pairs : Output::contacts;
        query.index = false;
        Detector detector({.backend = seed % 5 == 0 ? Backend::reference : Backend::cpu, .threads = 2});
        Intersections expected = detector.find(world->view(), query);
        std::vector<BodyPair> bodies;
        std::vector<Pair> pairs;
        std::vector<ContactKind> kinds;
        std::vector<std::array<double, 3>> points;
        std::int64_t last = 0;
        const auto take = [&](const Intersections& block) {
            EXPECT_LE(block.pairs.size(), 7U);
            ASSERT_EQ(block.bodies.size(), block.pairs.size());
            bodies.insert(bodies.end(), block.bodies.begin(), block.bodies.end());
            pairs.insert(pairs.end(), block.pairs.begin(), block.pairs.end());
            kinds.insert(kinds.end(), block.contacts.kinds.begin(), block.contacts.kinds.end());
            points.insert(points.end(), block.contacts.points.begin(), block.contacts.points.end());
            last = block.count;
        };
        const Statistics statistics = detector.stream(world->view(), query, take, 7);
        ASSERT_EQ(statistics.pairs, expected.count) << seed;
        ASSERT_EQ(last, expected.count) << seed;
        ASSERT_EQ(pairs.size(), expected.pairs.size()) << seed;
        ASSERT_EQ(points.size(), expected.contacts.points.size()) << seed;
        std::set<test::Row> rows;
        for (std::size_t i = 0; i < pairs.size(); ++i)
            rows.emplace(bodies[i].first, pairs[i].a, bodies[i].second, pairs[i].b);
        ASSERT_EQ(rows, test::rows_of(expected)) << seed;
        ASSERT_EQ(kinds.size(), expected.contacts.kinds.size()) << seed;
    }
}

TEST(World, blocks_are_refused_for_outputs_without_pairs_of_triangles) {
    const auto soup = random_soup(10, 0.5);
    const std::vector<Shape> shapes{Shape(soup.view())};
    const std::vector<Body> bodies{{.self = true}};
    const auto never = [](const Intersections&) { FAIL(); };
    for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs, Output::count}) {
        Detector detector;
        EXPECT_EQ(error_of([&] {
                      detector.stream(World{shapes, bodies, {}}, {.output = output}, never);
                  }).code,
                  ErrorCode::invalid_argument);
    }
}

TEST(World, stop_requested_before_the_call_cancels_it) {
    const auto soup = random_soup(10, 0.5);
    const std::vector<Shape> shapes{Shape(soup.view())};
    const std::vector<Body> bodies{{.self = true}};
    std::stop_source stop;
    stop.request_stop();
    Detector detector;
    EXPECT_EQ(error_of([&] {
                  detector.find(World{shapes, bodies, {}}, {}, stop.get_token());
              }).code,
              ErrorCode::cancelled);
    EXPECT_GE(detector.find(World{shapes, bodies, {}}).count, 0);
}

TEST(World, stop_request_is_checked_at_least_once_per_pair_of_overlapping_bodies) {
    // Saddles slightly above each other, in one world: groups of triangles overlap, and nothing collides.
    constexpr std::int32_t n = 20;
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> faces;
    for (std::int32_t i = 0; i < n; ++i)
        for (std::int32_t j = 0; j < n; ++j) {
            vertices.push_back({1.0 * i, 1.0 * j, 0.1 * (i - n / 2) * (j - n / 2)});
            if (i == 0 || j == 0) continue;
            const std::int32_t v = n * i + j;
            faces.push_back({v, v - 1, v - n - 1});
            faces.push_back({v, v - n - 1, v - n});
        }
    const std::vector<Shape> shapes{Shape({vertices, faces}, 1)};
    const std::vector<Body> bodies(20, Body{});
    std::vector<Pose> poses;
    for (std::size_t b = 0; b < bodies.size(); ++b) poses.push_back(moved(0, 0, 0.001 * static_cast<double>(b)));
    const test::EachCheckPolls each_check_polls;
    Detector detector({.threads = 1});
    int polls = 0;
    detector.set_poll([&] { ++polls; });
    EXPECT_FALSE(detector.find(World{shapes, bodies, poses}, {.output = Output::any_by_world}).any);
    EXPECT_GE(polls, 190) << "one for each of the 190 pairs of bodies";
    std::stop_source stop;
    detector.set_poll([&] { stop.request_stop(); });
    const auto call = [&] { detector.find(World{shapes, bodies, poses}, {.output = Output::any}, stop.get_token()); };
    EXPECT_EQ(error_of(call).code, ErrorCode::cancelled);
}

TEST(World, swapped_results_outlive_the_detector) {
    const auto soup = random_soup(300, 0.3), other = random_soup(300, 0.3, 2);
    const std::vector<Shape> shapes{Shape(soup.view()), Shape(other.view(), 1)};
    const std::vector<Body> bodies{
        {.shape = 0, .self = true}, {.shape = 1, .world = 1, .self = true}, {.shape = 1, .world = -1, .self = true}};
    const IntersectionQuery query{.output = Output::contacts, .index = true};
    Detector fresh;
    const Intersections& expected = fresh.find(World{shapes, bodies, {}}, query);
    ASSERT_GT(expected.count, 50);
    Intersections taken, spare;
    {
        Detector detector;
        const Intersections& found = detector.find(World{shapes, bodies, {}}, query);
        const Pair* const storage = found.pairs.data();
        detector.swap_result(taken);
        EXPECT_EQ(taken.pairs.data(), storage) << "nothing is copied";
        EXPECT_FALSE(found.any || found.count || !found.pairs.empty() || !found.world_hit.empty() || !found.hit.empty())
            << "the detector's own answer is empty";
        detector.find(World{shapes, bodies, {}}, {.output = Output::any});
        detector.swap_result(spare);
        detector.swap_result(spare);
        detector.find(World{shapes, bodies, {}}, query);
    }
    EXPECT_TRUE(test::same_world_result(taken, expected));
    EXPECT_TRUE(same_bytes(taken.world_offsets, expected.world_offsets, "offsets of worlds"));
    EXPECT_TRUE(same_bytes(taken.body_offsets, expected.body_offsets, "offsets of bodies"));
    EXPECT_TRUE(same_bytes(taken.hit, expected.hit, "hit flags"));

    Detector limited({.memory_limit = 10'000'000});
    limited.find(World{shapes, bodies, {}}, query);
    limited.swap_result(taken);
    const std::int64_t peak = limited.find(World{shapes, bodies, {}}, query).statistics.peak_memory_bytes;
    std::vector<Intersections> held(5);
    for (Intersections& result : held) {
        limited.swap_result(result);
        EXPECT_LE(limited.find(World{shapes, bodies, {}}, query).statistics.peak_memory_bytes, peak)
            << "answers taken over do not count";
    }
}

class WrongWorld : public testing::TestWithParam<Backend> {
   protected:
    Error error(const World& world, const IntersectionQuery& query = {}) {
        Detector detector({.backend = GetParam()});
        return error_of([&] { detector.find(world, query); });
    }
    test::Soup<float> soup = random_soup(5, 0.5);
    std::vector<Shape> shapes{Shape(soup.view())};
    std::vector<Body> bodies{{.self = true}, {.self = true}};
};

TEST_P(WrongWorld, error_about_a_pose_shape_or_world_id_names_the_body) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Pose> poses{{}, moved(nan)};
    Error e = error({shapes, bodies, poses});
    EXPECT_STREQ(e.what(), "body 1: its pose is not finite");
    EXPECT_EQ(e.element, Element::body);
    EXPECT_EQ(e.index, 1);
    poses.pop_back();
    EXPECT_STREQ(error({shapes, bodies, poses}).what(), "there are 1 poses for 2 bodies");
    bodies[1].shape = 3;
    EXPECT_STREQ(error({shapes, bodies, {}}).what(), "body 1: there is no shape 3 (number of shapes: 1)");
    bodies[1] = {.world = -2};
    EXPECT_STREQ(error({shapes, bodies, {}}).what(), "body 1: its world is -2; worlds are 0 to 2147483646, or -1");
    bodies = {{.world = 1}, {.world = 0}};
    EXPECT_STREQ(error({shapes, bodies, {}}).what(),
                 "body 1: its world 0 comes after world 1; world ids must ascend over the bodies");
    bodies = {{.world = -1}, {.world = 0}};
    EXPECT_STREQ(error({shapes, bodies, {}}).what(), "body 1: bodies that are in all worlds (-1) must come last");
    bodies = {{}, {}};
    IntersectionQuery query;
    query.filter.excluded_bodies = {{0, 2}};
    EXPECT_STREQ(error({shapes, bodies, {}}, query).what(), "excluded_bodies names body 2 of 2");
}

TEST_P(WrongWorld, error_names_the_vertex_or_triangle) {
    soup.vertices[7][1] = std::numeric_limits<float>::infinity();
    Error e = error({shapes, bodies, {}});
    EXPECT_STREQ(e.what(), "body 0: vertex 7 is not finite");
    EXPECT_EQ(e.code, ErrorCode::not_finite);
    soup.vertices[7][1] = 3;
    const std::vector<Pose> poses{{}, {{1, 0, 0, 0, 0, 2e38, 0, 0, 0, 0, 1, 0}}};
    EXPECT_STREQ(error({shapes, bodies, poses}).what(), "body 1: vertex 7 is posed to infinity");
    soup.vertices[7][1] = 0;
    soup.triangles[2][1] = 15;
    e = error({shapes, bodies, {}});
    EXPECT_STREQ(e.what(), "body 0: triangle 2 names vertex 15 of 15");
    EXPECT_EQ(e.code, ErrorCode::index_out_of_range);
}

TEST_P(WrongWorld, error_about_a_negative_number_of_triangles_names_the_shape) {
    shapes[0].triangles.rows = -1;
    EXPECT_STREQ(error({shapes, bodies, {}}).what(), "shape 0 has -1 triangles; 0 to 2147483647 are possible");
}

INSTANTIATE_TEST_SUITE_P(, WrongWorld, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& info) { return std::string(test::backend_name(info.param)); });

TEST(World, bodies_are_tested_against_themselves_on_request_only) {
    const auto soup = random_soup(300, 0.3);
    const std::vector<Shape> shapes{Shape(soup.view())};
    std::vector<Body> bodies{{}};
    Detector detector;
    EXPECT_FALSE(detector.find(World{shapes, bodies, {}}, {}).any);
    bodies[0].self = true;
    EXPECT_TRUE(detector.find(World{shapes, bodies, {}}, {}).any);
}

PairFilter without(std::int32_t a, std::int32_t b) {
    PairFilter filter;
    filter.excluded_bodies.push_back({a, b});
    return filter;
}
PairFilter between_groups() {
    PairFilter filter;
    filter.groups = PairScope::between;
    return filter;
}

TEST(World, triangle_queries_reject_pairs_with_a_body_of_edges_or_points_only) {
    const auto soup = random_soup(20, 0.3);
    const std::vector<std::int32_t> some{1, 2};
    const std::vector<Edge> edge{{0, 1}};
    std::vector<Shape> shapes(3, Shape(soup.view()));
    shapes[1].triangles = shapes[2].triangles = {};
    shapes[1].points = some;
    shapes[2].edges = edge;
    const auto refused = [&](const std::vector<Body>& bodies, const PairFilter& filter, std::int64_t body) {
        for (const Backend backend : {Backend::reference, Backend::cpu}) {
            Detector detector({.backend = backend});
            IntersectionQuery query;
            query.filter = filter;
            DistanceQuery nearest;
            nearest.filter = filter;
            for (const Error& error : {error_of([&] {
                                           detector.find(World{shapes, bodies, {}}, query);
                                       }),
                                       error_of([&] {
                                           detector.find(World{shapes, bodies, {}}, nearest);
                                       })}) {
                EXPECT_EQ(error.code, ErrorCode::invalid_argument);
                EXPECT_EQ(error.element, Element::body);
                EXPECT_EQ(error.index, body);
                EXPECT_NE(std::string(error.what()).find("no triangles"), std::string::npos) << error.what();
            }
        }
    };
    refused({{.shape = 0}, {.shape = 1}}, {}, 1);
    refused({{.shape = 2}, {.shape = 0}}, {}, 0);
    refused({{.shape = 0, .world = 0}, {.shape = 2, .world = -1}}, {}, 1);
    refused({{.shape = 0}, {.shape = 1, .group = 1}}, between_groups(), 1);
    const auto accepted = [&](const std::vector<Body>& bodies, const PairFilter& filter) {
        Detector detector({.backend = Backend::cpu});
        IntersectionQuery query;
        query.filter = filter;
        DistanceQuery nearest;
        nearest.filter = filter;
        EXPECT_NO_THROW(detector.find(World{shapes, bodies, {}}, query));
        EXPECT_NO_THROW(detector.find(World{shapes, bodies, {}}, nearest));
    };
    accepted({{.shape = 1}}, {});
    accepted({{.shape = 0, .world = 0}, {.shape = 1, .world = 1}}, {});
    accepted({{.shape = 0}, {.shape = 1}}, without(1, 0));
    accepted({{.shape = 0}, {.shape = 1}}, between_groups());
    shapes[1].points = std::span<const std::int32_t>();  // the body then has no features at all
    accepted({{.shape = 0}, {.shape = 1}}, {});
    EXPECT_TRUE(Detector()
                    .find(World{shapes, std::vector<Body>{{.shape = 0}, {.shape = 2}}, {}}, ProximityQuery{.radius = 9})
                    .any);
}

TEST(World, errors_in_named_shapes_are_reported_even_if_bodies_are_far_apart) {
    auto soup = random_soup(50, 0.5);
    soup.vertices[9][2] = 1e30f;
    const std::vector<Shape> shapes{Shape(soup.view(), 1), Shape(soup.view(), 2)};
    const std::vector<Body> bodies{{.shape = 0}, {.shape = 1}};
    const std::vector<Pose> poses{moved(1000), {{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1e10, 0}}};
    Detector detector;
    EXPECT_STREQ(error_of([&] {
                     detector.find(World{shapes, bodies, poses});
                 }).what(),
                 "body 1: vertex 9 is posed to infinity");
    soup.triangles[3][0] = -1;
    Detector other;
    EXPECT_STREQ(error_of([&] {
                     other.find(World{shapes, bodies, poses});
                 }).what(),
                 "shape 0: triangle 3 names vertex -1 of 150");
}

}  // namespace
}  // namespace crumple
