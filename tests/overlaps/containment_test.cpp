// Tests of intersections with containment: against brute force in rational arithmetic, against overlaps, and in named
// cases.

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "error_of.h"
#include "memory_limit.h"
#include "overlaps/closed_bodies.h"
#include "rounds.h"
#include "shared_results.h"

namespace crumple {
namespace {

using test::closed_bodies;
using test::ClosedBodies;
using test::Dice;
using test::difference;
using test::error_of;

constexpr Output contained_outputs[] = {Output::any, Output::any_by_world, Output::body_pairs};

IntersectionQuery with_containment(Output output = Output::body_pairs, bool weld = false) {
    return {.output = output, .weld = weld, .containment = true, .open = OpenSurfaces::skip};
}

using ContainedSoup = test::Soup<double>;

/// Returns a cube with edges of length `size` around a point.
ContainedSoup cube(double x, double y, double z, double size) {
    Dice dice(0);
    ContainedSoup soup;
    test::add_box(dice, true, 1, soup);
    for (int v = 0; v < 8; ++v)
        soup.vertices[static_cast<std::size_t>(v)] = {x + (v & 1 ? 0.5 : -0.5) * size, y + (v & 2 ? 0.5 : -0.5) * size,
                                                      z + (v & 4 ? 0.5 : -0.5) * size};
    return soup;
}
ContainedSoup inside_out(ContainedSoup soup) {
    for (auto& t : soup.triangles) std::swap(t[1], t[2]);
    return soup;
}
ContainedSoup hollow_cube() { return test::joined(cube(0, 0, 0, 4), inside_out(cube(0, 0, 0, 2))); }
/// Returns closed bodies of three sizes, so that some lie inside others or in their cavities; on a grid or not, some
/// mirrored.
ClosedBodies nested_bodies(unsigned seed, int bodies, bool grid) {
    ClosedBodies all = closed_bodies(seed, bodies, grid, false);
    Dice dice(seed + 1000);
    for (std::size_t b = 0; b < all.poses.size(); ++b) {
        const bool large = b % 4 == 0;
        if (large) all.soups[b] = dice.chance(0.4) ? hollow_cube() : cube(0, 0, 0, 4);
        all.shapes[b] = Shape(all.soups[b].view());
        Pose& pose = all.poses[b] = grid ? Pose{} : test::random_motion(dice, 0.5);
        const double scale = large ? 4 : dice.chance(0.5) ? 0.5 : 0.25;
        for (std::size_t i = 0; i < 12; ++i)
            if (i % 4 != 3) pose.rows[i] *= i < 4 && dice.chance(0.2) ? -scale : scale;
        for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] += large ? dice.below(2) : dice.below(16) - 8;
    }
    return all;
}

class Containment : public testing::TestWithParam<int> {
   protected:
    Detector detector_{Options{.backend = Backend::cpu, .threads = GetParam()}};
    Detector reference_{Options{.backend = Backend::reference}};
    test::SharedResults<Intersections> expected_;
    std::int64_t contained_ = 0, meeting_ = 0, skipped_ = 0;

    Intersections compare(const Scene& scene, const IntersectionQuery& query) {
        const Intersections& found = detector_.find(scene, query);
        EXPECT_EQ(difference(found, expected_.next([&] { return reference_.find(scene, query); })), "");
        for (const std::uint8_t inside : found.inside) ++(inside ? contained_ : meeting_);
        skipped_ += static_cast<std::int64_t>(found.skipped.size());
        return found;
    }
    void compare_all(const World& world, const PairFilter& filter = {}) {
        for (const bool weld : {false, true})
            for (const Output output : contained_outputs) {
                SCOPED_TRACE(static_cast<int>(output));
                IntersectionQuery query = with_containment(output, weld);
                query.filter = filter;
                const Intersections found = compare(world, query);
                EXPECT_EQ(detector_.any(world, query), found.any);
            }
    }
};

INSTANTIATE_TEST_SUITE_P(Threads, Containment, testing::Values(1, 3), testing::PrintToStringParamName());

TEST_P(Containment, agrees_with_brute_force) {
    for (unsigned seed = 0; seed < (sanitized ? 10u : 24u); ++seed) {
        SCOPED_TRACE(seed);
        compare_all(nested_bodies(seed, 4, seed % 2 == 0).view());
    }
    EXPECT_GT(contained_, 20);
    EXPECT_GT(meeting_, 20);
    EXPECT_EQ(skipped_, 0);
}

TEST_P(Containment, agrees_with_brute_force_on_many_worlds_and_filters) {
    for (unsigned seed = 300; seed < (sanitized ? 303u : 308u); ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = nested_bodies(seed, 9, seed % 2 == 0);
        for (std::size_t b = 0; b < 9; ++b)
            bodies.bodies[b].world = b >= 7 ? -1 : static_cast<std::int32_t>(b / 2 + (b > 3 ? 1 : 0));
        if (seed % 3 == 0)
            for (std::size_t b = 0; b < 9; ++b)
                bodies.shapes[b] = Shape(bodies.soups[b].view(), 1 + b + 9 * std::uint64_t{seed});
        compare_all(bodies.view());
        compare_all(bodies.view(), {.groups = seed % 2 == 0 ? PairScope::between : PairScope::within,
                                    .excluded_bodies = {{0, 1}, {7, 2}}});
        compare_all(bodies.view(), {.bodies = PairScope::between, .excluded_groups = {{0, 1}}});
    }
    EXPECT_GT(contained_, 20);
}

TEST_P(Containment, agrees_with_brute_force_where_surfaces_are_open) {
    for (unsigned seed = 600; seed < (sanitized ? 604u : 612u); ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = nested_bodies(seed, 5, seed % 2 == 0);
        for (const std::size_t open : {std::size_t{1}, std::size_t{4}}) {
            bodies.soups[open].triangles.pop_back();
            bodies.shapes[open] = Shape(bodies.soups[open].view());
        }
        if (seed % 3 == 0) bodies.bodies[4].world = -1;
        compare_all(bodies.view());
    }
    EXPECT_GT(contained_, 5);
    EXPECT_GT(skipped_, 5);
}

TEST_P(Containment, lists_the_body_pairs_of_an_overlap_query) {
    for (unsigned seed = 900; seed < 960; ++seed) {
        SCOPED_TRACE(seed);
        ClosedBodies bodies = nested_bodies(seed, 6, seed % 2 == 0);
        for (Body& body : bodies.bodies) body.self = false;
        const Overlaps overlaps = detector_.find(bodies.view(), OverlapQuery{.output = Output::body_pairs});
        const Intersections& found = detector_.find(bodies.view(), with_containment());
        EXPECT_TRUE(
            std::equal(found.bodies.begin(), found.bodies.end(), overlaps.bodies.begin(), overlaps.bodies.end()));
        for (std::size_t i = 0; i < found.bodies.size(); ++i)
            EXPECT_FALSE(found.inside[i] && overlaps.relation[i] == OverlapRelation::touching);
        EXPECT_EQ(detector_.any(bodies.view(), OverlapQuery()), found.any);
        const Array<std::uint8_t> hit = found.world_hit;
        EXPECT_TRUE(
            std::equal(hit.begin(), hit.end(),
                       detector_.find(bodies.view(), OverlapQuery{.output = Output::any_by_world}).world_hit.begin()));
    }
}

TEST_P(Containment, inside_and_skipped_are_empty_unless_containment_is_requested) {
    const ClosedBodies bodies = nested_bodies(4, 6, false);
    const Intersections& found = detector_.find(bodies.view(), {.output = Output::body_pairs});
    EXPECT_TRUE(found.inside.empty());
    EXPECT_TRUE(found.skipped.empty());
    const ContainedSoup outer = cube(0, 0, 0, 4), across = cube(2, 0, 0, 1);
    const Intersections& meeting = detector_.find({outer.view(), across.view()}, {.output = Output::body_pairs});
    EXPECT_EQ(meeting.bodies.size(), 1u);
    EXPECT_TRUE(meeting.inside.empty());
    ContainedSoup open = cube(0, 0, 0, 1);
    open.triangles.pop_back();
    const Scene scene(outer.view(), open.view());
    EXPECT_EQ(detector_.find(scene, with_containment()).skipped.size(), 1u);
    EXPECT_EQ(detector_.find(scene, with_containment()).inside.size(), 1u);
    EXPECT_TRUE(detector_.find(scene, {.output = Output::body_pairs}).inside.empty());
    EXPECT_TRUE(detector_.find(scene, {.output = Output::body_pairs}).skipped.empty());
}

/// Returns the soup with three vertices of its own for each triangle, as in an STL file.
ContainedSoup unwelded(const ContainedSoup& soup) {
    ContainedSoup apart;
    for (const auto& t : soup.triangles) {
        const auto first = static_cast<std::int32_t>(apart.vertices.size());
        for (const std::int32_t v : t) apart.vertices.push_back(soup.vertices[static_cast<std::size_t>(v)]);
        apart.triangles.push_back({first, first + 1, first + 2});
    }
    return apart;
}

class KnownContainments : public testing::Test {
   protected:
    /// Returns how two bodies lie: "apart", "meeting" or "inside".
    std::string relation(const ContainedSoup& a, const ContainedSoup& b, bool weld = false) {
        IntersectionQuery query = with_containment(Output::body_pairs, weld);
        query.open = OpenSurfaces::error;
        const Scene scene(a.view(), b.view());
        const Intersections& found = cpu_.find(scene, query);
        EXPECT_EQ(difference(found, reference_.find(scene, query)), "");
        EXPECT_EQ(found.bodies.size(), found.inside.size());
        const std::string is = found.bodies.empty() ? "apart" : found.inside[0] ? "inside" : "meeting";
        EXPECT_EQ(cpu_.any(scene, query), is != "apart");
        EXPECT_EQ(reference_.any(scene, query), is != "apart");
        return is;
    }

    Detector cpu_{Options{.backend = Backend::cpu, .threads = 1}};
    Detector reference_{Options{.backend = Backend::reference}};
};

TEST_F(KnownContainments, body_in_another_is_inside) {
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(0.5, 0, 0, 1)), "inside");
    EXPECT_EQ(relation(cube(0.5, 0, 0, 1), cube(0, 0, 0, 4)), "inside");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(9, 0, 0, 1)), "apart");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(2, 0, 0, 1)), "meeting");
}
TEST_F(KnownContainments, body_that_touches_another_from_inside_meets_it) {
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(1.5, 0, 0, 1)), "meeting");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(0, 0, 0, 4)), "meeting");
}
TEST_F(KnownContainments, body_in_a_cavity_is_not_inside) {
    EXPECT_EQ(relation(hollow_cube(), cube(0, 0, 0, 1)), "apart");
    EXPECT_EQ(relation(hollow_cube(), cube(1.5, 1.5, 1.5, 0.5)), "inside");
    EXPECT_EQ(relation(hollow_cube(), cube(0, 0, 0, 3)), "inside") << "it fills the cavity and more";
    EXPECT_EQ(relation(test::joined(cube(0, 0, 0, 4), cube(0, 0, 0, 2)), cube(0, 0, 0, 1)), "inside")
        << "covered twice, which is no cavity";
}
TEST_F(KnownContainments, body_with_one_component_inside_another_is_inside) {
    EXPECT_EQ(relation(cube(0, 0, 0, 4), test::joined(cube(9, 0, 0, 1), cube(0, 0, 0, 1))), "inside");
    EXPECT_EQ(relation(test::joined(cube(9, 0, 0, 4), cube(0, 0, 0, 4)), cube(0, 0, 0, 1)), "inside");
    EXPECT_EQ(relation(test::joined(cube(9, 0, 0, 4), cube(0, 0, 0, 4)), cube(4.5, 0, 0, 1)), "apart");
}
TEST_F(KnownContainments, inside_out_bodies_contain_and_are_contained) {
    EXPECT_EQ(relation(inside_out(cube(0, 0, 0, 4)), cube(0, 0, 0, 1)), "inside");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), inside_out(cube(0, 0, 0, 1))), "inside");
}
TEST_F(KnownContainments, body_inside_a_mirrored_body_is_inside) {
    const ContainedSoup outer = cube(0, 0, 0, 4), inner = cube(0, 0, 0, 1);
    const Shape shapes[] = {Shape(outer.view()), Shape(inner.view())};
    const Body bodies[] = {{.shape = 0}, {.shape = 1}};
    Pose mirror;
    mirror.rows[0] = -1;
    const Pose poses[] = {mirror, {}};
    const Intersections& found = cpu_.find(World{shapes, bodies, poses}, with_containment());
    ASSERT_EQ(found.inside.size(), 1u);
    EXPECT_EQ(found.inside[0], 1);
}

TEST_F(KnownContainments, bodies_closed_only_by_welding_need_the_weld_option) {
    const ContainedSoup outer = unwelded(cube(0, 0, 0, 4)), inner = unwelded(cube(0, 0, 0, 1));
    EXPECT_EQ(relation(outer, inner, true), "inside");
    const Error error = error_of([&] { relation(outer, inner); });
    EXPECT_EQ(error.element, Element::body);
    EXPECT_NE(std::string(error.what()).find("IntersectionQuery::weld closes seams, IntersectionQuery::open leaves"),
              std::string::npos)
        << error.what();
}
TEST_F(KnownContainments, contact_at_welded_vertices_alone_does_not_count) {
    ContainedSoup corner = cube(0, 0, 0, 1);  // one vertex will be at a corner of the outer cube, the others are inside
    corner.vertices[7] = {2, 2, 2};
    EXPECT_EQ(relation(cube(0, 0, 0, 4), corner), "meeting");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), corner, true), "inside");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(4, 4, 4, 4), true), "apart") << "touches at a corner from outside";
    EXPECT_EQ(relation(cube(0, 0, 0, 4), cube(0, 0, 0, 4), true), "meeting") << "triangles that are equal";
}
TEST_F(KnownContainments, body_that_enters_through_welded_vertices_is_inside) {
    // Two tetrahedra with a common tip at a vertex of the cube, one inside the cube and one outside. Through the tip
    // they are one connected component.
    ContainedSoup hourglass;
    hourglass.vertices = {{2, 2, 2}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {3, 3, 4}, {4, 3, 3}, {3, 4, 3}};
    hourglass.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {4, 6, 5}};
    EXPECT_EQ(relation(cube(0, 0, 0, 4), hourglass), "meeting");
    EXPECT_EQ(relation(cube(0, 0, 0, 4), hourglass, true), "inside");
}

TEST_F(KnownContainments, open_body_can_be_inside_but_contains_nothing) {
    ContainedSoup open_inner = cube(0, 0, 0, 1), open_outer = cube(0, 0, 0, 4);
    open_inner.triangles.pop_back();
    open_outer.triangles.pop_back();
    const ContainedSoup outer = cube(0, 0, 0, 4), inner = cube(0, 0, 0, 1), far = cube(2, 0, 0, 1);
    for (Detector* detector : {&cpu_, &reference_}) {
        const Intersections in = detector->find({outer.view(), open_inner.view()}, with_containment());
        ASSERT_EQ(in.inside.size(), 1u);
        EXPECT_EQ(in.inside[0], 1);
        ASSERT_EQ(in.skipped.size(), 1u);
        EXPECT_EQ(in.skipped[0], 1);
        const Intersections around = detector->find({open_outer.view(), inner.view()}, with_containment());
        EXPECT_FALSE(around.any);
        ASSERT_EQ(around.skipped.size(), 1u);
        EXPECT_EQ(around.skipped[0], 0);
        // Bodies whose surfaces meet need no winding number, so that one of them is open is no error.
        for (const Output output : contained_outputs) {
            IntersectionQuery query = with_containment(output);
            query.open = OpenSurfaces::error;
            EXPECT_TRUE(detector->find({open_outer.view(), far.view()}, query).any);
            EXPECT_EQ(error_of([&] { detector->find({outer.view(), open_inner.view()}, query); }).index, 1);
        }
    }
}

TEST_F(KnownContainments, open_body_near_vertices_without_triangles_is_no_error) {
    ContainedSoup open, points;
    open.vertices = {{15, 3, 15}, {-11, 3, -5}, {7, 3, 3}, {-0x1.fffffffffffffp+1023, 1, 0}};
    open.triangles = {{0, 1, 2}};
    points.vertices = {{2, 3, 0}, {2, 3, 1}};
    const std::array shapes{Shape(open.view()), Shape(points.view())};
    const std::array bodies{Body{.shape = 0}, Body{.shape = 1}};
    const std::array poses{Pose{}, Pose{}};
    for (Detector* detector : {&cpu_, &reference_})
        for (const Output output : contained_outputs) {
            IntersectionQuery query = with_containment(output);
            query.open = OpenSurfaces::error;
            EXPECT_FALSE(detector->find(World{shapes, bodies, poses}, query).any);
        }
}

TEST_F(KnownContainments, pose_that_makes_a_degenerate_body_infinite_is_an_error) {
    test::Soup<float> point;
    point.vertices = {{0x1.fffffep127f, 1, 1}};
    point.triangles = {{0, 0, 0}};
    const std::array shapes{Shape(point.view())};
    const std::array bodies{Body{}};
    Pose twice;
    twice.rows[0] = 2;
    const std::array poses{twice};
    for (Detector* detector : {&cpu_, &reference_}) {
        const OverlapQuery query{.self_overlaps = true};
        EXPECT_EQ(error_of([&] { detector->find(World{shapes, bodies, poses}, query); }).code, ErrorCode::not_finite);
    }
}

TEST_F(KnownContainments, errors_in_a_shape_name_the_first_body_that_has_it) {
    const ContainedSoup good = cube(0, 0, 0, 2);
    ContainedSoup infinite = cube(1, 0, 0, 2), wrong = infinite;
    infinite.vertices[3][1] = std::numeric_limits<double>::infinity();
    wrong.triangles[5][1] = 8;
    const std::array bodies{Body{.shape = 0}, Body{.shape = 0}, Body{.shape = 1}, Body{.shape = 1}};
    for (const auto& [bad, message] :
         {std::pair(&infinite, "body 2: vertex 3 is not finite"), {&wrong, "body 2: triangle 5 names vertex 8 of 8"}})
        for (Detector* detector : {&cpu_, &reference_}) {
            const std::array shapes{Shape(good.view()), Shape(bad->view())};
            const World world{shapes, bodies, {}};
            EXPECT_STREQ(error_of([&] { detector->find(world, OverlapQuery()); }).what(), message);
            EXPECT_STREQ(error_of([&] { detector->find(world, with_containment()); }).what(), message);
        }
}

TEST_F(KnownContainments, error_in_a_shape_without_a_body_names_the_shape) {
    const ContainedSoup good = cube(0, 0, 0, 2);
    ContainedSoup infinite = good;
    infinite.vertices[0][0] = std::numeric_limits<double>::infinity();
    const std::array shapes{Shape(good.view()), Shape(infinite.view())};
    const std::array bodies{Body{.shape = 0}, Body{.shape = 0}};
    const World world{shapes, bodies, {}};
    EXPECT_STREQ(error_of([&] { cpu_.find(world, OverlapQuery()); }).what(), "shape 1: vertex 0 is not finite");
}

TEST_F(KnownContainments, rows_follow_the_order_of_bodies) {
    const ContainedSoup outer = cube(0, 0, 0, 8), left = cube(-2, 0, 0, 2), right = cube(-1, 0, 0, 2);
    const Shape shapes[] = {Shape(left.view()), Shape(outer.view()), Shape(right.view())};
    const Body bodies[] = {{.shape = 0}, {.shape = 1}, {.shape = 2}};
    const Intersections found = cpu_.find(World{shapes, bodies, {}}, with_containment());
    const std::vector<BodyPair> expected{{0, 1}, {0, 2}, {1, 2}};
    EXPECT_TRUE(std::equal(found.bodies.begin(), found.bodies.end(), expected.begin(), expected.end()));
    const std::vector<std::uint8_t> inside{1, 0, 1};
    EXPECT_TRUE(std::equal(found.inside.begin(), found.inside.end(), inside.begin(), inside.end()));
    EXPECT_EQ(found.world_hit[0], 1);
    EXPECT_EQ(found.count, 0);
}

TEST_F(KnownContainments, unsuitable_scenes_and_options_are_rejected) {
    const ContainedSoup a = cube(0, 0, 0, 4), b = cube(0, 0, 0, 1);
    const Scene two(a.view(), b.view());
    const auto message = [&](const Scene& scene, IntersectionQuery query) {
        query.containment = true;
        return std::string(error_of([&] { cpu_.find(scene, query); }).what());
    };
    EXPECT_EQ(message(a.view(), {.output = Output::any}), "containment needs bodies: a world or two meshes");
    EXPECT_FALSE(cpu_.supports(a.view(), with_containment()));
    EXPECT_TRUE(cpu_.supports(two, with_containment()));
    EXPECT_FALSE(cpu_.supports(cpu_.partition(two, {}, 2)[0], with_containment()));
    EXPECT_EQ(error_of([&] { cpu_.any(a.view(), with_containment()); }).code, ErrorCode::invalid_argument);
    for (const Output output : {Output::count, Output::pairs, Output::contacts})
        EXPECT_NE(message(two, {.output = output}).find("output must be any, any_by_world or body_pairs with"),
                  std::string::npos);
    EXPECT_NE(message(two, {.output = Output::any, .kind = IntersectionKind::proper}).find("kind must be all"),
              std::string::npos);
    EXPECT_NE(message(two, {.output = Output::any, .neighbours = Neighbours::skip, .weld = true})
                  .find("neighbours must be geometric"),
              std::string::npos);
    const Shape shape(a.view());
    const Body body{.shape = 0};
    EXPECT_NE(
        message(World{{&shape, 1}, {&body, 1}, {}}, {.output = Output::any, .filter = {.bodies = PairScope::within}})
            .find("bodies must not be within"),
        std::string::npos);
    EXPECT_EQ(error_of([&] { cpu_.stream(two, with_containment(), [](const Intersections&) { FAIL(); }); }).code,
              ErrorCode::invalid_argument);
    EXPECT_TRUE(cpu_.any(two, with_containment())) << "and goes on";
}

TEST(ContainmentMemory, call_under_a_sufficient_limit_gives_the_same_result_within_it) {
    const ClosedBodies bodies = nested_bodies(12, 40, false);
    test::expect_same_under_limit([&](Detector& detector) { return detector.find(bodies.view(), with_containment()); },
                                  [](const Intersections& a, const Intersections& b) { return difference(a, b); });
}

TEST(ContainmentCalls, cancelled_call_throws_and_detector_stays_usable) {
    const ClosedBodies bodies = nested_bodies(12, 10, false);
    Detector detector(Options{.backend = Backend::cpu});
    const Intersections expected = detector.find(bodies.view(), with_containment());
    ASSERT_TRUE(expected.any);
    std::stop_source source;
    source.request_stop();
    EXPECT_EQ(error_of([&] { detector.find(bodies.view(), with_containment(), source.get_token()); }).code,
              ErrorCode::cancelled);
    EXPECT_EQ(difference(detector.find(bodies.view(), with_containment()), expected), "");
}

}  // namespace
}  // namespace crumple
