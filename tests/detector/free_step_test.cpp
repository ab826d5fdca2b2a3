// Tests of free steps: what is held back, how far, and because of which impact.

#include <gtest/gtest.h>

#include <algorithm>

#include "crumple/crumple.h"
#include "features/moving_soups.h"

namespace crumple::test {
namespace {

constexpr double cut = 1 - 0x1p-16;

/// Returns pairs of equal triangles, side by side along x. One triangle of a pair is static at height 0. The other is 2
/// above it, and falls by falls[i] in pair i.
MovingSoup<> falling(const std::vector<double>& falls) {
    MovingSoup<> soup;
    const auto add = [&](double x, double z, double fall) {
        const std::int32_t a = soup.vertex({x, 0, z}, {x, 0, z - fall}),
                           b = soup.vertex({x + 2, 0, z}, {x + 2, 0, z - fall}),
                           c = soup.vertex({x, 2, z}, {x, 2, z - fall});
        soup.triangles.push_back({a, b, c});
    };
    for (std::size_t i = 0; i < falls.size(); ++i) {
        add(4 * static_cast<double>(i), 0, 0);
        add(4 * static_cast<double>(i) + 0.25, 2, falls[i]);
    }
    return soup;
}

VertexView rows(const Array<double>& positions) {
    return rows_of_three(positions.data(), static_cast<std::int64_t>(positions.size()) / 3);
}

FreeStepQuery holding(Held held, ImpactQuery query = {}) { return {query, held}; }

class FreeSteps : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{{.backend = GetParam()}};

    void expect_free(const MovingSoup<>& soup, const FreeStep& step, const ImpactQuery& query = {}) {
        EXPECT_FALSE(detector_.any(soup.view().moving_to(rows(step.positions)), query));
    }
};

TEST_P(FreeSteps, free_step_reports_the_first_impact) {
    const MovingSoup<> soup = falling({4, 8, 1});
    const MeshView moving = soup.view().moving_to(soup.end_view());
    const FreeStep step = detector_.find(moving, FreeStepQuery());
    EXPECT_EQ(step.share, 0.25 * cut);
    EXPECT_EQ(step.first, detector_.find(moving, FirstImpactQuery()));
    EXPECT_EQ(step.first.toi, 0.25);
    EXPECT_TRUE(step.vertex_shares.empty() && step.body_shares.empty() && step.first_vertex.empty());
    const FreeStep whole = detector_.find(soup.view().moving_to(soup.view().vertices), FreeStepQuery());
    EXPECT_EQ(whole.share, 1);
    EXPECT_FALSE(whole.first.found);
}

TEST_P(FreeSteps, only_vertices_of_pairs_that_touch_are_held_back) {
    const MovingSoup<> soup = falling({4, 8, 1});
    const FreeStep step = detector_.find(soup.view().moving_to(soup.end_view()), holding(Held::vertices));
    expect_free(soup, step);
    EXPECT_EQ(step.share, 0.25 * cut);
    ASSERT_EQ(step.vertex_shares.size(), soup.start.size());
    for (std::size_t v = 0; v < soup.start.size(); ++v) {
        const double held = v / 6 == 0 ? 0.5 * cut : 0.25 * cut;
        EXPECT_EQ(step.vertex_shares[v], v / 6 == 2 ? 1 : held) << v;
    }
}

TEST_P(FreeSteps, each_body_or_world_is_held_back_by_its_own_first_impact) {
    const MovingSoup<> soup = falling({4, 8, 1});
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    for (const std::int32_t world : {0, 0, 1}) {
        for (int part = 0; part < 2; ++part) {
            const auto t = static_cast<std::int64_t>(shapes.size());
            Shape shape(rows_of_three(soup.start[0].data() + 9 * t, 3), rows_of_three(soup.triangles[0].data(), 1));
            shape.end = rows_of_three(soup.end[0].data() + 9 * t, 3);
            shapes.push_back(shape);
            bodies.push_back({.shape = static_cast<std::int32_t>(t), .world = world});
        }
    }
    const World world{shapes, bodies, {}};
    const auto shares = [&](Held held) {
        const FreeStep step = detector_.find(world, holding(held));
        EXPECT_EQ(step.first.bodies, (BodyPair{2, 3}));
        EXPECT_TRUE(std::ranges::equal(step.first_vertex, std::vector<std::int64_t>{0, 3, 6, 9, 12, 15, 18}));
        EXPECT_EQ(step.share, 0.25 * cut);
        expect_free(soup, step);
        return std::vector<double>(step.body_shares.begin(), step.body_shares.end());
    };
    const double half = 0.5 * cut, quarter = 0.25 * cut;
    EXPECT_EQ(shares(Held::bodies), (std::vector{half, half, quarter, quarter, 1., 1.}));
    EXPECT_EQ(shares(Held::worlds), (std::vector{quarter, quarter, quarter, quarter, 1., 1.}));
    bodies.back().world = -1;
    bodies[4].world = 0;
    EXPECT_EQ(shares(Held::bodies), (std::vector{half, half, quarter, quarter, 1., 1.}));
}

/// Bodies that are in all worlds touch each other, while another body touches earlier or is stuck at the start.
TEST_P(FreeSteps, bodies_in_all_worlds_are_held_back_before_they_touch) {
    MovingSoup<> soup = falling({8, 4});
    std::vector<Shape> shapes;
    const std::vector<Body> bodies{{0, 0, 0}, {1, 0, 0}, {2, 0, -1}, {3, 0, -1}};
    for (const bool stuck : {false, true}) {
        if (stuck)  // the first two triangles intersect at the start
            for (std::size_t v = 3; v < 6; ++v) soup.start[v] = {0.5, 0.5, 1 - static_cast<double>(v - 3)};
        shapes.clear();
        for (std::int64_t t = 0; t < 4; ++t) {
            Shape shape(rows_of_three(soup.start[0].data() + 9 * t, 3), rows_of_three(soup.triangles[0].data(), 1));
            shape.end = rows_of_three(soup.end[0].data() + 9 * t, 3);
            shapes.push_back(shape);
        }
        const World world{shapes, bodies, {}};
        for (const Held held : {Held::worlds, Held::bodies}) {
            const FreeStep step = detector_.find(world, holding(held, {.triangle_pairs = stuck}));
            EXPECT_EQ(step.body_shares[1], stuck ? 0 : 0.25 * cut);
            EXPECT_EQ(step.body_shares[3], stuck ? 0 : 0.5 * cut);
            EXPECT_EQ(step.intersects, stuck);
        }
    }
    const MovingSoup<> one = falling({4});
    std::vector<Shape> alone{Shape(one.view())};
    alone[0].end = one.end_view();
    const std::vector<Body> itself{{.world = -1, .self = true}};
    EXPECT_EQ(detector_.find(World{alone, itself, {}}, FreeStepQuery()).share, 0.5 * cut);
    const std::vector<Body> all_through{{2, 0, 0}, {0, 0, -1}, {1, 0, -1}};
    const FreeStep held =
        detector_.find(World{shapes, all_through, {}}, holding(Held::worlds, {.triangle_pairs = true}));
    EXPECT_TRUE(held.intersects);
    EXPECT_EQ(held.intersecting_bodies, (BodyPair{1, 2}));
    EXPECT_EQ(held.share, 0);
}

TEST_P(FreeSteps, two_meshes_stop_just_before_they_touch) {
    const MovingSoup<> soup = falling({4});
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}};
    const std::vector<std::array<double, 3>> low(soup.start.begin(), soup.start.begin() + 3),
        high(soup.start.begin() + 3, soup.start.end()), end(soup.end.begin() + 3, soup.end.end());
    const FreeStep step = detector_.find({MeshView(low, one).moving_to(MeshView(low, one).vertices),
                                          MeshView(high, one).moving_to(MeshView(end, one).vertices)},
                                         FreeStepQuery());
    EXPECT_EQ(step.share, 0.5 * cut);
    EXPECT_EQ(step.body_shares.size(), 2u);
    expect_free(soup, step);
}

TEST_P(FreeSteps, posed_bodies_move_from_start_to_end_poses) {
    const MovingSoup<> soup = falling({0});
    const std::vector<std::array<std::int32_t, 3>> one{{0, 1, 2}};
    const Shape shape{MeshView(soup.start, one)};
    const std::vector<Shape> shapes{shape};
    const std::vector<Body> bodies(2);
    const std::vector<Pose> start{Pose{}, Pose{{1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, 2}}},
        end{Pose{}, Pose{{1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, -2}}};
    const World world{shapes, bodies, start, end};
    const FreeStep step = detector_.find(world, FreeStepQuery());
    EXPECT_EQ(step.share, 0.5 * cut);
    const auto posed = static_cast<std::size_t>(3 * step.first_vertex[1]);
    EXPECT_EQ(step.positions[posed], 0.25);
    EXPECT_EQ(step.positions[posed + 2], 2 - 4 * (0.5 * cut));
}

TEST_P(FreeSteps, triangles_that_intersect_at_the_start_hold_back_only_their_world) {
    MovingSoup<> soup = falling({1, 1});
    for (std::size_t v = 3; v < 6; ++v)
        soup.start[v] = {soup.start[v - 3][0] + 0.5, 0.5, 1 - static_cast<double>(v - 3)};
    const MeshView moving = soup.view().moving_to(soup.end_view());
    const FreeStep stuck = detector_.find(moving, holding(Held::vertices, {.triangle_pairs = true}));
    EXPECT_EQ(stuck.share, 0);
    EXPECT_TRUE(stuck.intersects);
    EXPECT_EQ(stuck.intersecting, (Pair{0, 1}));
    EXPECT_FALSE(detector_.find(moving, holding(Held::vertices)).intersects);

    std::vector<Shape> shapes;
    const std::vector<Body> bodies{{.shape = 0, .world = 0, .self = true}, {.shape = 1, .world = 1, .self = true}};
    const std::vector<std::array<std::int32_t, 3>> two{{0, 1, 2}, {3, 4, 5}};
    for (std::int64_t i = 0; i < 2; ++i) {
        Shape shape(rows_of_three(soup.start[0].data() + 18 * i, 6), rows_of_three(two[0].data(), 2));
        shape.end = rows_of_three(soup.end[0].data() + 18 * i, 6);
        shapes.push_back(shape);
    }
    const FreeStep step = detector_.find(World{shapes, bodies, {}}, holding(Held::worlds, {.triangle_pairs = true}));
    EXPECT_TRUE(step.intersects);
    EXPECT_EQ(step.intersecting, (Pair{0, 1}));
    EXPECT_EQ(step.intersecting_bodies, (BodyPair{0, 0}));
    EXPECT_TRUE(std::ranges::equal(step.body_shares, std::vector<double>{0, 1}));
}

TEST_P(FreeSteps, approaching_only_lets_near_triangles_move_apart) {
    MovingSoup<> soup = falling({-2, 2});
    for (std::size_t v = 3; v < 6; ++v) soup.start[v][2] = 0.5;
    const ImpactQuery near{.min_distance = 1};
    const MeshView moving = soup.view().moving_to(soup.end_view());
    const FreeStep stuck = detector_.find(moving, holding(Held::vertices, near));
    EXPECT_TRUE(stuck.first.start);
    EXPECT_TRUE(std::ranges::all_of(stuck.vertex_shares, [](double share) { return share == 0; }));
    ImpactQuery approaching = near;
    approaching.approaching_only = true;
    const FreeStep step = detector_.find(moving, holding(Held::vertices, approaching));
    expect_free(soup, step, approaching);
    EXPECT_EQ(step.first.toi, 0.5);
    EXPECT_EQ(step.vertex_shares[3], 1);
    EXPECT_EQ(step.vertex_shares[9], 0.5 * cut);

    for (std::size_t v = 3; v < 6; ++v) soup.end[v][2] = 0.25;  // now approaching
    const FreeStep held = detector_.find(soup.view().moving_to(soup.end_view()), holding(Held::vertices, approaching));
    expect_free(soup, held, approaching);
    EXPECT_EQ(held.vertex_shares[3], 0);
    EXPECT_EQ(held.vertex_shares[9], 0.5 * cut);
}

INSTANTIATE_TEST_SUITE_P(, FreeSteps, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& p) { return p.param == Backend::cpu ? "cpu" : "reference"; });

/// The steps of hard soups are free after the positions have been rounded, unless they stay at a start where something
/// touches.
TEST(FreeStepsOfSoups, free_steps_of_hard_soups_have_no_impact_if_anything_moves) {
    Detector cpu({.backend = Backend::cpu, .threads = 1}), reference({.backend = Backend::reference});
    int cuts = 0, some = 0, soups = 0;
    for (const NamedMove<double>& move : moving_soups<double>()) {
        if (move.soup.start.size() > 60 || move.soup.triangles.empty()) continue;
        SCOPED_TRACE(move.name);
        const MeshView moving = move.soup.view().moving_to(move.soup.end_view());
        for (const bool approaching : {false, true}) {
            const Held held = approaching == (soups % 2 == 0) ? Held::worlds : Held::vertices;
            const FreeStepQuery query = holding(held, {.approaching_only = approaching});
            const FreeStep step = cpu.find(moving, query), expected = reference.find(moving, query);
            ASSERT_TRUE(std::ranges::equal(step.positions, expected.positions));
            ASSERT_TRUE(std::ranges::equal(step.vertex_shares, expected.vertex_shares));
            ASSERT_EQ(step.first, expected.first);
            ASSERT_EQ(step.share == 1, !step.first.found);
            const ImpactQuery impacts = query;
            const bool stays = std::ranges::equal(
                step.positions,
                cpu.find(move.soup.view().moving_to(move.soup.view().vertices), FreeStepQuery()).positions);
            if (approaching || !stays) {
                ASSERT_FALSE(reference.any(move.soup.view().moving_to(rows(step.positions)), impacts));
            }
            cuts += step.share < 1;
            some += held == Held::vertices && step.share < 1 &&
                    std::ranges::find(step.vertex_shares, 1) != step.vertex_shares.end();
        }
        ++soups;
    }
    EXPECT_GT(cuts, 20);
    EXPECT_GT(some, 5);
}

}  // namespace
}  // namespace crumple::test
