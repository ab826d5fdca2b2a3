// Tests of options of proximity queries other than one radius: a radius of each vertex, rings of adjacent triangles, a
// rest shape. Checks simple cases, compares with brute force, and compares brute force with the contract applied to a
// list of all near pairs.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "error_of.h"
#include "exact/proximity/rational_distance.h"
#include "features/moving_soups.h"
#include "features/tested_detectors.h"
#include "rounds.h"

namespace crumple::test {
namespace {

constexpr double ulp = 0x1p-52;

/// Returns random radii of about `size`: powers of two, thirds, zero, and numbers that are not float32.
std::vector<double> random_radii(Draw& draw, std::size_t vertices, double size) {
    std::vector<double> radii(vertices);
    for (double& r : radii) {
        const double some[] = {0, 0.5, 1.0 / 3, 1, std::nextafter(0.5, 1.0), draw.number(), 1e-9 * draw.number()};
        r = size * some[static_cast<std::size_t>(draw.below(7))];
    }
    return radii;
}

class NearFilters : public testing::TestWithParam<Backend> {
   protected:
    Detector detector{Options{.backend = GetParam(), .threads = 2}};

    std::size_t faces(const MovingSoup<>& soup, const ProximityQuery& query) {
        return detector.find(soup.view(), query).vertex_faces().pairs.size();
    }
};
INSTANTIATE_TEST_SUITE_P(, NearFilters, testing::ValuesIn(tested_backends), name_of_backend);

/// A small triangle, whose first and lowest vertex is `height` above the centre of a large one.
MovingSoup<> two(double height = 1) {
    MovingSoup<> soup;
    const auto add = [&](double x, double y, double z) { soup.vertex({x, y, z}, {x, y, z}); };
    add(-8, -8, 0), add(8, -8, 0), add(0, 8, 0);
    add(0, 0, height), add(1, 0, height + 8), add(0, 1, height + 8);
    soup.triangles = {{0, 1, 2}, {3, 4, 5}};
    return soup;
}

TEST_P(NearFilters, radii_are_added_without_rounding) {
    const auto near = [&](double face, double vertex, double height, bool strict) {
        const std::vector<double> radii{face, 0, 0, vertex, 0, 0};
        const MovingSoup<> soup = two(height);
        const auto& pairs =
            detector.find(soup.view(), ProximityQuery{.radii = radii, .strict = strict}).vertex_faces().pairs;
        return std::find(pairs.begin(), pairs.end(), Pair{3, 0}) != pairs.end();
    };
    EXPECT_TRUE(near(0.75, 0.25, 1, false)) << "at the sum";
    EXPECT_FALSE(near(0.75, 0.25, 1, true)) << "at the sum, strictly";
    EXPECT_FALSE(near(0.75, 0.25 - ulp / 8, 1, false)) << "one beside";
    EXPECT_TRUE(near(0.75, 0.25 + ulp, 1, true)) << "one beside";
    // Sums that are not representable, on either side of a representable number.
    EXPECT_TRUE(near(1, 0x1p-80, 1, true)) << "rounds to 1, and is more";
    EXPECT_FALSE(near(1, 0x1p-80, 1 + ulp, false));
    EXPECT_FALSE(near(1 - ulp / 2, ulp / 4, 1, false)) << "rounds to 1, and is less";
    EXPECT_TRUE(near(1 - ulp / 2, ulp / 4, 1 - ulp / 2, true));
    EXPECT_TRUE(near(0, 0, 0, false)) << "touching";
    EXPECT_FALSE(near(0, 0, 0, true));
    EXPECT_TRUE(near(0, 1, 1, false)) << "one without a radius";
    constexpr double most = std::numeric_limits<double>::max();
    EXPECT_TRUE(near(most, most, 1, true)) << "a sum beyond all numbers";
}

TEST_P(NearFilters, feature_has_the_largest_radius_of_its_vertices) {
    for (std::size_t v = 0; v < 3; ++v) {
        std::vector<double> radii(6, 0.25);
        radii[v] = 0.75;
        EXPECT_EQ(faces(two(), {.radii = radii}), 1u) << "vertex " << v;
        radii[v] = 0.75 - ulp;
        EXPECT_EQ(faces(two(), {.radii = radii}), 0u) << "vertex " << v;
    }
    std::vector<double> radii(6, 0.25);
    radii[4] = radii[5] = 100;
    const MovingSoup<> soup = two();
    const Proximities& nearby = detector.find(soup.view(), ProximityQuery{.radii = radii});
    const std::vector<Pair> expected{{0, 1}, {1, 1}, {2, 1}, {4, 0}, {5, 0}};
    EXPECT_TRUE(same_pairs(nearby.vertex_faces().pairs.span(), expected)) << "the vertex 3 has a radius of its own";
    EXPECT_EQ(nearby.edge_edges().pairs.size(), 9u);
}

TEST_P(NearFilters, pairs_close_in_the_rest_shape_are_left_out) {
    const MovingSoup<> soup = two(0.5);
    for (const double height : {1.0, std::nextafter(1.0, 2.0)}) {
        MovingSoup<> rest = two(height);
        const auto narrow = rounded<float>(rest);
        const bool close = height == 1;
        EXPECT_EQ(faces(soup, {.radius = 1, .rest = rest.view().vertices, .rest_radius = 1}), close ? 0u : 1u);
        EXPECT_EQ(faces(soup, {.radius = 1, .rest = narrow.view().vertices, .rest_radius = 1}), 0u) << "rounded to 1";
        EXPECT_FALSE(
            detector
                .find(soup.view(),
                      ProximityQuery{
                          .output = Output::any, .radius = 1, .rest = narrow.view().vertices, .rest_radius = 1})
                .any);
    }
    EXPECT_EQ(faces(soup, {.radius = 1, .rest = soup.view().vertices}), 1u) << "apart at rest, and that is enough";
    EXPECT_EQ(faces(two(0), {.radius = 1, .rest = two(0).view().vertices}), 0u) << "in contact at rest";
}

/// A strip of quads of width 1 along x, with two triangles each.
MovingSoup<> strip(std::int32_t quads) {
    MovingSoup<> soup;
    for (std::int32_t i = 0; i <= quads; ++i)
        for (const double y : {0.0, 1.0}) soup.vertex({1.0 * i, y, 0}, {1.0 * i, y, 0});
    for (std::int32_t i = 0; i < quads; ++i) {
        const std::int32_t a = 2 * i;
        soup.triangles.push_back({a, a + 2, a + 1});
        soup.triangles.push_back({a + 1, a + 2, a + 3});
    }
    return soup;
}

TEST_P(NearFilters, rings_leave_out_features_within_that_many_edges) {
    const MovingSoup<> soup = strip(8);
    // From vertex (0, 0), x edges lead to one face between x and x + 1, and x + 1 edges to the other one.
    for (const std::int32_t rings : {0, 1, 2, 3, 7, 8, 1000}) {
        const ProximityList& list =
            detector.find(soup.view(), ProximityQuery{.radius = 100, .rings = rings}).vertex_faces();
        std::set<std::int32_t> of_first, expected;
        for (const Pair& pair : list.pairs)
            if (pair.a == 0) of_first.insert(pair.b);
        for (std::int32_t t = 0; t < 16; ++t)
            if ((t + 1) / 2 > rings) expected.insert(t);
        EXPECT_EQ(of_first, expected) << rings << " rings";
    }
    MovingSoup<> apart = soup;
    apart.append(strip(2));
    EXPECT_EQ(detector.find(apart.view(), ProximityQuery{.radius = 0, .rings = 1000}).vertex_faces().pairs.size(), 27u)
        << "no path leads from one sheet to another, wherever they are";
    EXPECT_FALSE(detector.find(apart.view(), ProximityQuery{.radius = 0, .weld = true, .rings = 1000}).any)
        << "unless vertices at equal positions are one";
}

TEST_P(NearFilters, least_distances_ignore_rings_and_rest_shape) {
    const MovingSoup<> soup = strip(4);
    const Proximities all = detector.find(
        soup.view(), ProximityQuery{.radius = 10, .closest = true, .least = true, .rings = 1, .index = true});
    ASSERT_GT(all.vertex_faces().pairs.size(), 0u);
    MovingSoup<> as_cut = soup;
    for (auto& p : as_cut.start) p[2] = 7;
    const ProximityQuery plain{.radius = 10, .least = true};
    ProximityQuery resting = plain;
    resting.rest = as_cut.view().vertices, resting.rest_radius = 1.5;
    Detector other({.backend = Backend::reference});
    const Proximities& near = other.find(soup.view(), plain);
    EXPECT_LT(near.vertex_distance[0], 1.5);
    const auto expect_least = [&](const Proximities& found) {
        EXPECT_LT(found.vertex_faces().pairs.size(), near.vertex_faces().pairs.size());
        EXPECT_TRUE(std::ranges::equal(found.vertex_distance, near.vertex_distance));
        EXPECT_TRUE(std::ranges::equal(found.face_distance, near.face_distance));
        EXPECT_TRUE(std::ranges::equal(found.edge_distance, near.edge_distance));
    };
    expect_least(all);
    expect_least(detector.find(soup.view(), resting));
    ProximityQuery of_groups = resting;
    of_groups.filter.groups = PairScope::within;
    expect_least(detector.find(soup.view(), of_groups));
    EXPECT_EQ(all.vertex_faces().type.size(), all.vertex_faces().pairs.size());
    EXPECT_EQ(all.vertex_faces().offsets[1], 5) << "the faces from there on";
}

TEST_P(NearFilters, errors_name_argument_and_vertex) {
    const MovingSoup<> soup = two();
    const auto of = [&](const ProximityQuery& query) { return error_of([&] { detector.find(soup.view(), query); }); };
    std::vector<double> radii(5, 1);
    EXPECT_STREQ(of({.radii = radii}).what(), "there are 5 radii for 6 vertices");
    radii.resize(6, 1);
    for (const double wrong : {-1.0, std::nan(""), std::numeric_limits<double>::infinity(), -0x1p-1074}) {
        radii[4] = wrong;
        const Error error = of({.radii = radii});
        EXPECT_STREQ(error.what(), "the radius of vertex 4 must be finite and 0 or more");
        EXPECT_EQ(error.element, Element::vertex);
        EXPECT_EQ(error.index, 4);
    }
    radii[4] = -0.0;
    EXPECT_STREQ(of({.radius = 1, .radii = radii}).what(), "radius must be 0 if radii are given");
    EXPECT_STREQ(of({.rings = -1}).what(), "rings must be 0 or more");
    EXPECT_STREQ(of({.rest_radius = 1}).what(), "rest_radius needs a rest shape");
    EXPECT_STREQ(of({.rest_radius = -1}).what(), "rest_radius must be finite and 0 or more");
    EXPECT_STREQ(of({.rest_radius = std::nan("")}).what(), "rest_radius must be finite and 0 or more");
    MovingSoup<> rest = two();
    rest.start[3][1] = std::nan("");
    const Error error = of({.rest = rest.view().vertices});
    EXPECT_STREQ(error.what(), "rest shape: vertex 3 is not finite");
    EXPECT_EQ(error.code, ErrorCode::not_finite);
    EXPECT_EQ(error.index, 3);
    VertexView view = soup.view().vertices;
    view.rows = 5;
    EXPECT_STREQ(of({.rest = view}).what(), "there are 5 vertices in the rest shape for 6 vertices");
    view = soup.view().vertices;
    view.data = nullptr;
    EXPECT_STREQ(of({.rest = view}).what(), "the vertices of the rest shape have no data");

    std::vector<Shape> shapes{Shape(soup.view()), Shape(soup.view())};
    const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
    const auto of_world = [&](const ProximityQuery& query) {
        return error_of([&] { detector.find(World{shapes, bodies, {}}, query); });
    };
    EXPECT_STREQ(of_world({.radii = radii}).what(), "radii must be empty for a world; use Shape::radii");
    EXPECT_STREQ(of_world({.rest = soup.view().vertices}).what(), "rest must be empty for a world; use Shape::rest");
    EXPECT_STREQ(of_world({.rest_radius = 1}).what(), "rest_radius needs a rest shape");
    radii[2] = -3;
    shapes[1].radii = radii;
    EXPECT_STREQ(of_world({}).what(), "shape 1: the radius of vertex 2 must be finite and 0 or more");
    radii[2] = 0;
    EXPECT_STREQ(of_world({.radius = 1}).what(), "radius must be 0 if radii are given");
    shapes[1].rest = rest.view().vertices;
    EXPECT_STREQ(of_world({}).what(), "shape 1: rest shape: vertex 3 is not finite");
    EXPECT_FALSE(detector.find(soup.view(), ProximityQuery()).any) << "usable still";
}

TEST(NearFiltersOfWorlds, rest_shape_and_rings_apply_within_a_body) {
    const MovingSoup<> soup = two();
    const std::vector<double> radii(6, 0.5);
    for (const Backend backend : {Backend::reference, tested_backend}) {
        Detector detector({.backend = backend, .threads = 2});
        std::vector<Shape> shapes{Shape(soup.view()), Shape(soup.view())};
        const std::vector<Body> bodies{{.shape = 0, .self = true}, {.shape = 1, .self = true}};
        const auto count = [&](const ProximityQuery& query) {
            return detector.find(World{shapes, bodies, {}}, query).vertex_faces().pairs.size();
        };
        // Pairs: each body's vertex above its own face; and each body's vertices on or above the other's faces.
        const std::size_t between = 2 * 7, within = 2;
        EXPECT_EQ(count({.radius = 1}), between + within);
        shapes[0].rest = shapes[1].rest = soup.view().vertices;
        EXPECT_EQ(count({.radius = 1, .rest_radius = 1}), between) << "at rest, too";
        shapes[1].rest = {};
        EXPECT_EQ(count({.radius = 1, .rest_radius = 1}), between + 1) << "without a shape at rest";
        EXPECT_EQ(count({.radius = 1, .rings = 5}), between + within) << "no edges lead to other triangles";
        shapes[0].radii = shapes[1].radii = radii;
        EXPECT_EQ(count({}), between + within);
        shapes[1].radii = {};
        EXPECT_EQ(count({}), between - 2 + 1) << "that of others is 0";

        // Two equal sheets at the same place: rings leave out pairs within each sheet, but none between the two.
        const MovingSoup<> sheet = strip(3);
        const std::vector<Shape> sheets{Shape(sheet.view())};
        const auto pairs_of_sheets = [&](std::size_t number, std::int32_t rings) {
            const std::vector<Body> equal(number, Body{.self = true});
            const ProximityQuery query{.radius = 1, .rings = rings};
            return detector.find(World{sheets, equal, {}}, query).vertex_faces().pairs.size();
        };
        const std::size_t left_out = pairs_of_sheets(1, 0) - pairs_of_sheets(1, 1);
        EXPECT_GT(left_out, 0U);
        EXPECT_EQ(pairs_of_sheets(2, 1), pairs_of_sheets(2, 0) - 2 * left_out);
    }
}

/// Poses move and scale shapes, but not radii.
TEST(NearFiltersOfWorlds, radii_and_rest_shapes_are_not_posed) {
    const MovingSoup<> soup = two();
    const std::vector<double> radii(6, 0.5);
    std::vector<Shape> shapes{Shape(soup.view())};
    shapes[0].radii = radii;
    const std::vector<Body> bodies(1, Body{.self = true});
    Detector detector({.backend = tested_backend});
    for (const double scale : {0.5, 1.0, 1.0 + ulp, 2.0}) {
        const std::vector<Pose> poses{{{scale, 0, 0, 1, 0, scale, 0, 1, 0, 0, scale, 0}}};
        shapes[0].rest = {};
        EXPECT_EQ(detector.find(World{shapes, bodies, poses}, ProximityQuery()).any, scale <= 1) << scale;
        shapes[0].rest = soup.view().vertices;
        EXPECT_FALSE(detector.find(World{shapes, bodies, poses}, ProximityQuery{.rest_radius = 1}).any)
            << "nor is the shape at rest";
        EXPECT_EQ(detector.find(World{shapes, bodies, poses}, ProximityQuery{.rest_radius = 0.75}).any, scale <= 1)
            << "a rest shape scaled by 0.5 would leave out the pair";
    }
}

template <class Scalar>
class NearFilterAgreement : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(NearFilterAgreement, Precisions, PrecisionNames);

/// Calls work for soups that are small enough for decisions in rationals, pair by pair.
template <class Scalar, class Work>
void for_each_small_soup(std::size_t most, Work work) {
    unsigned seed = 0;
    for (const NamedMove<Scalar>& move : soups_to_try<Scalar>(1, 0.5)) {
        SCOPED_TRACE(move.name);
        ++seed;
        if (move.soup.triangles.size() > most || move.unit > 1e300) continue;
        work(move, seed);
        if (testing::Test::HasFailure()) return;
    }
}

TYPED_TEST(NearFilterAgreement, radii_match_brute_force) {
    for (const double size : {1e-3, 1.0, 3.0})
        for_each_small_soup<TypeParam>(size < 1 ? 300 : 60, [&](const auto& move, unsigned seed) {
            SCOPED_TRACE(size);
            Draw draw(seed);
            const std::vector<double> radii = random_radii(draw, move.soup.start.size(), size * move.unit);
            expect_near(move.soup, {.radii = radii, .strict = seed % 2 == 0, .weld = seed % 3 == 0});
        });
}
TYPED_TEST(NearFilterAgreement, rings_match_brute_force) {
    for (const std::int32_t rings : {1, 2, 5})
        for_each_small_soup<TypeParam>(60, [&](const auto& move, unsigned seed) {
            SCOPED_TRACE(rings);
            expect_near(move.soup, {.radius = 2 * move.unit, .weld = seed % 2 == 0, .rings = rings});
        });
}
TYPED_TEST(NearFilterAgreement, rest_shapes_match_brute_force) {
    for (const double radius : {0.0, 0.1, 1.0})
        for_each_small_soup<TypeParam>(60, [&](const auto& move, unsigned seed) {
            SCOPED_TRACE(radius);
            ProximityQuery query{
                .radius = 2 * move.unit, .rest = move.soup.end_view(), .rest_radius = radius * move.unit};
            query.rings = seed % 2 == 0 ? 1 : 0;
            expect_near(move.soup, query);
        });
}

/// Soups with codimensional edges and points. Paths, which rings are counted along, follow codimensional edges and the
/// sides of all faces.
TYPED_TEST(NearFilterAgreement, codimensional_features_match_brute_force) {
    for_each_small_soup<TypeParam>(60, [&](const auto& move, unsigned seed) {
        auto soup = move.soup;
        const auto n = static_cast<int>(soup.start.size());
        if (n < 4) return;
        Draw draw(seed);
        soup.edges.emplace();
        for (int i = 0; i < 16; ++i) {
            const int a = draw.below(n), b = draw.below(n);
            if (a != b) soup.edges->push_back({a, b});
        }
        soup.points.emplace();
        for (int i = 0; i < 8; ++i) soup.points->push_back(draw.below(n));
        soup.triangles.resize(soup.triangles.size() / 3);
        const std::vector<double> radii = random_radii(draw, soup.start.size(), 2 * move.unit);
        for (const std::int32_t rings : {0, 1, 2})
            expect_near(soup, {.radii = radii,
                               .weld = seed % 2 == 0,
                               .rings = rings,
                               .rest = soup.end_view(),
                               .rest_radius = 0.5 * move.unit});
    });
}
TEST_P(NearFilters, rings_follow_codimensional_edges) {
    MovingSoup<> soup;  // a rod along x, and a loose vertex
    for (int i = 0; i < 6; ++i) soup.vertex({1.0 * i, 0, 0}, {1.0 * i, 0, 0});
    soup.edges = {{0, 1}, {2, 1}, {2, 3}, {3, 4}};
    const auto pairs = [&](std::int32_t rings) {
        const ProximityList& list =
            detector.find(soup.view(), ProximityQuery{.radius = 10, .rings = rings})[FeatureKind::edge_edge];
        return std::vector<Pair>(list.pairs.begin(), list.pairs.end());
    };
    EXPECT_EQ(pairs(0), (std::vector<Pair>{{0, 2}, {0, 3}, {1, 3}}));
    EXPECT_EQ(pairs(1), (std::vector<Pair>{{0, 3}}));
    EXPECT_TRUE(pairs(2).empty());
    soup.triangles = {{0, 5, 4}};  // a detour whose edges are not listed
    EXPECT_EQ(pairs(0).size(), 3u);
    EXPECT_TRUE(pairs(1).empty());
}

/// One radius for all pairs equals half of it for each vertex.
TYPED_TEST(NearFilterAgreement, equal_radii_act_like_one_radius_of_twice_their_size) {
    for_each_small_soup<TypeParam>(300, [&](const auto& move, unsigned) {
        const double radius = 0.25 * move.unit;
        const std::vector<double> radii(move.soup.start.size(), radius);
        for (const auto& [name, detector] : tested()) {
            const Proximities expected = detector->find(move.soup.view(), ProximityQuery{.radius = 2 * radius});
            ASSERT_TRUE(same_features(detector->find(move.soup.view(), ProximityQuery{.radii = radii}), expected))
                << name;
        }
    });
}

/// The contract of radii, rings and rest shape, applied literally to one pair of features at a time.
struct LiteralContract {
    const MovingSoup<>& soup;
    const ProximityQuery& query;
    std::set<Edge> edges;

    LiteralContract(const MovingSoup<>& s, const ProximityQuery& q) : soup(s), query(q) {
        for (const auto& corner : soup.triangles)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = corner[k], b = corner[(k + 1) % 3];
                edges.insert({std::min(a, b), std::max(a, b)});
            }
    }

    bool passes(FeatureKind kind, const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) const {
        for (const std::int32_t v : a)
            for (const std::int32_t w : b)
                if (path(v, w)) return false;
        const auto radius = [&](const std::vector<std::int32_t>& of) {
            double largest = 0;
            for (const std::int32_t v : of) largest = std::max(largest, query.radii[static_cast<std::size_t>(v)]);
            return largest;
        };
        const DistanceLimit reach{radius(a), radius(b), query.strict};
        return distance(soup.start, kind, a, b).within(reach) &&
               !distance(soup.end, kind, a, b).within({query.rest_radius, 0});
    }

   private:
    bool path(std::int32_t v, std::int32_t w) const {
        std::map<std::int32_t, std::int32_t> steps{{v, 0}};
        for (std::int32_t step = 0; step < query.rings; ++step) {
            const auto reached = steps;
            for (const Edge& e : edges)
                for (const auto& [from, to] : {std::pair(e.a, e.b), std::pair(e.b, e.a)})
                    if (reached.count(from)) steps.emplace(to, step + 1);
        }
        return steps.count(w) > 0;
    }
    static RationalDistance distance(const std::vector<PointOf<double>>& at, FeatureKind kind,
                                     const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
        Features features{kind == FeatureKind::vertex_face ? FeatureKinds::vertex_face : FeatureKinds::edge_edge, {}};
        std::size_t n = 0;
        for (const auto* of : {&a, &b})
            for (const std::int32_t v : *of) {
                const auto& [x, y, z] = at[static_cast<std::size_t>(v)];
                features.point[n++] = {x, y, z};
            }
        return RationalDistance(features);
    }
};

TEST(NearFilterReference, reference_matches_the_filters_as_documented) {
    for (unsigned seed = 0; seed < 12; ++seed) {
        const MovingSoup<> soup = moving_grid(4, 14, 8, 50 + seed);
        Draw draw(seed);
        const std::vector<double> radii = random_radii(draw, soup.start.size(), 2);
        const ProximityQuery query{.radii = radii,
                                   .strict = seed % 2 == 0,
                                   .rings = static_cast<std::int32_t>(seed % 3),
                                   .rest = soup.end_view(),
                                   .rest_radius = 0.5 * draw.below(4)};
        const LiteralContract oracle(soup, query);
        const Proximities all = reference().find(soup.view(), ProximityQuery{.radius = 100});
        const Proximities& found = reference().find(soup.view(), query);
        std::array<std::vector<Pair>, feature_kinds> expected;
        for (const Pair& pair : all.vertex_faces().pairs) {
            const auto& corner = soup.triangles[static_cast<std::size_t>(pair.b)];
            if (oracle.passes(FeatureKind::vertex_face, {pair.a}, {corner[0], corner[1], corner[2]}))
                expected[0].push_back(pair);
        }
        for (const Pair& pair : all.edge_edges().pairs) {
            const Edge e = all.edges[pair.a], f = all.edges[pair.b];
            if (oracle.passes(FeatureKind::edge_edge, {e.a, e.b}, {f.a, f.b})) expected[1].push_back(pair);
        }
        for (std::size_t k = 0; k < 2; ++k)
            EXPECT_TRUE(same_pairs(found.lists[k].pairs.span(), expected[k])) << "seed " << seed << ", kind " << k;
        EXPECT_LT(found.count, all.count);
    }
}

}  // namespace
}  // namespace crumple::test
