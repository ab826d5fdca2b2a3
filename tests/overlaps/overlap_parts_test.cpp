// Tests of overlaps from parts of a scene: what combine() makes of the results of all parts is the same bytes as the
// result of find() for the whole scene.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "error_of.h"
#include "memory_limit.h"
#include "overlaps/closed_bodies.h"
#include "rounds.h"

namespace crumple {
namespace {

using test::Dice;
using test::difference;
using test::error_of;
using Soup = test::Soup<double>;

/// Returns one body of several random closed pieces, which may meet.
Soup pile(Dice& dice, int pieces, bool grid) {
    Soup soup;
    for (int i = 0; i < pieces; ++i)
        dice.chance(0.5) ? add_box(dice, grid, 2, soup) : add_tetrahedron(dice, grid, 3, soup);
    return soup;
}

/// Finds the result of each part.
std::vector<Overlaps> found_in(Detector& detector, const std::vector<Part>& parts, const OverlapQuery& query) {
    std::vector<Overlaps> found;
    for (const Part& part : parts) {
        detector.find(part, query);
        found.push_back(detector.take_result<Overlaps>());
    }
    return found;
}

std::vector<Overlaps> found_in_parts(Detector& detector, const Scene& scene, int count, const OverlapQuery& query) {
    return found_in(detector, detector.partition(scene, query, count), query);
}

class OverlapParts : public testing::TestWithParam<Options> {
   protected:
    Detector detector_{GetParam()}, elsewhere_{GetParam()};
    Detector plain_{Options{.backend = Backend::cpu, .threads = 1}};

    /// Compares overlaps from several numbers of parts with find(). Returns the number of rows.
    std::int64_t compare(const Scene& scene, const OverlapQuery& query,
                         const std::vector<int>& counts = {1, 2, 7, 50}) {
        const Overlaps expected = plain_.find(scene, query);
        for (const int count : counts) {
            SCOPED_TRACE(testing::Message() << count << " parts");
            std::vector<Overlaps> found = found_in(elsewhere_, plain_.partition(scene, query, count), query);
            std::reverse(found.begin(), found.end());
            EXPECT_EQ(difference(detector_.combine(scene, query, found), expected), "");
        }
        return expected.count;
    }
};

std::vector<Options> options_of_parts() {
    return {{.backend = Backend::cpu, .threads = 1},
            {.backend = Backend::cpu, .threads = 3},
            {.backend = Backend::cpu, .threads = 1, .memory_limit = 1 << 26},
            {.backend = Backend::reference}};
}

constexpr std::array names_of_options{"One", "Three", "Limited", "Reference"};
INSTANTIATE_TEST_SUITE_P(, OverlapParts, testing::ValuesIn(options_of_parts()),
                         [](const auto& option) { return names_of_options[option.index]; });

TEST_P(OverlapParts, overlap_of_a_mesh_with_itself_has_the_bytes_of_the_whole) {
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < (sanitized ? 2u : 6u); ++seed) {
        SCOPED_TRACE(seed);
        Dice dice(seed);
        const Soup soup = pile(dice, 3 + dice.below(8), seed % 2 == 0);
        rows += compare(soup.view(), test::everything);
        compare(soup.view(), {.output = Output::body_pairs, .min_volume = 0.01});
        compare(soup.view(), {.output = Output::any});
    }
    EXPECT_GT(rows, sanitized ? 1 : 4);
}

TEST_P(OverlapParts, overlap_of_two_meshes_has_the_bytes_of_the_whole) {
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < (thorough() ? 12u : sanitized ? 3u : 6u); ++seed) {
        SCOPED_TRACE(seed);
        Dice dice(100 + seed);
        const bool grid = seed % 2 == 0;
        const Soup a = pile(dice, 1 + dice.below(6), grid), b = pile(dice, 1 + dice.below(6), grid);
        OverlapQuery query = test::everything;
        query.first_free = seed == 1;  // takes most of the time, and combine() finds it in the whole meshes
        query.self_overlaps = seed % 3 == 0;
        rows += seed == 1 ? compare({a.view(), b.view()}, query, {7}) : compare({a.view(), b.view()}, query);
        for (const Output output : {Output::any, Output::any_by_world, Output::body_pairs})
            compare({a.view(), b.view()}, {.output = output});
    }
    EXPECT_GT(rows, 3);
}

TEST_P(OverlapParts, nested_and_distant_meshes_have_the_rows_of_the_whole) {
    Dice dice(5);
    Soup large, small;
    add_box(dice, true, 2, large);
    small = large;
    for (auto& p : large.vertices)
        for (std::size_t k = 0; k < 3; ++k) p[k] = small.vertices[0][k] + 3 * (p[k] - small.vertices[0][k]) - 1;
    EXPECT_EQ(compare({large.view(), small.view()}, test::everything), 1);
    for (auto& p : small.vertices) p[0] += 1000;
    EXPECT_EQ(compare({large.view(), small.view()}, {}), 0);
    compare({large.view(), Soup().view()}, {.curves = true});
}

TEST_P(OverlapParts, seams_are_welded_and_open_meshes_are_treated_as_in_the_whole) {
    Dice dice(6);
    Soup torn = pile(dice, 4, true), other = pile(dice, 4, true);
    Soup loose;
    for (const auto& t : torn.triangles) {
        const auto first = static_cast<std::int32_t>(loose.vertices.size());
        for (const std::int32_t v : t) loose.vertices.push_back(torn.vertices[static_cast<std::size_t>(v)]);
        loose.triangles.push_back({first, first + 1, first + 2});
    }
    OverlapQuery query = test::all_but_first_free;
    query.weld = true;
    EXPECT_GT(compare(loose.view(), query) + compare({loose.view(), other.view()}, query), 0);
    query = {.curves = true};
    for (const OpenSurfaces open : {OpenSurfaces::skip, OpenSurfaces::curves}) {
        query.open = open;
        compare({loose.view(), other.view()}, query);
    }
    const std::vector<Overlaps> found = found_in_parts(detector_, loose.view(), 3, {});
    EXPECT_STREQ(error_of([&] { detector_.combine(loose.view(), {}, found); }).what(),
                 error_of([&] { plain_.find(loose.view(), OverlapQuery()); }).what());
}

TEST_P(OverlapParts, float32_meshes_and_meshes_with_groups_are_supported) {
    Dice dice(7);
    const Soup soup = pile(dice, 6, true);
    test::Soup<float> single;
    for (const auto& [x, y, z] : soup.vertices)
        single.vertices.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    single.triangles = soup.triangles;
    const std::vector<std::int32_t> groups(soup.triangles.size(), 3);
    MeshView mesh = single.view();
    mesh.groups = groups;
    EXPECT_EQ(compare(mesh, {.gradient = true}), 1);
    const Part part = detector_.partition(mesh, OverlapQuery(), 2)[0];
    const OverlapQuery by_groups{.filter = {.groups = PairScope::between}};
    EXPECT_STREQ(error_of([&] { detector_.find(part, by_groups); }).what(),
                 error_of([&] { detector_.find(mesh, by_groups); }).what());
}

TEST_P(OverlapParts, each_pair_of_triangles_is_in_one_part) {
    Dice dice(8);
    const Soup soup = pile(dice, 12, false);
    const Intersections& whole = plain_.find(soup.view(), IntersectionQuery());
    std::vector<Pair> pairs;
    for (const Overlaps& part : found_in_parts(detector_, soup.view(), 9, {})) {
        EXPECT_TRUE(std::is_sorted(part.part_pairs.begin(), part.part_pairs.end()));
        EXPECT_EQ(part.part.count, 9);
        EXPECT_TRUE(part.part.self_overlaps);
        EXPECT_TRUE(part.bodies.empty() && part.volume.empty() && !part.any && part.count == 0);
        EXPECT_EQ(part.statistics.pairs, static_cast<std::int64_t>(part.part_pairs.size()));
        pairs.insert(pairs.end(), part.part_pairs.begin(), part.part_pairs.end());
    }
    std::sort(pairs.begin(), pairs.end());
    EXPECT_TRUE(std::equal(pairs.begin(), pairs.end(), whole.pairs.begin(), whole.pairs.end()));
    EXPECT_GT(pairs.size(), 20u);
}

TEST_P(OverlapParts, results_that_do_not_fit_together_are_errors) {
    Dice dice(9);
    const Soup a = pile(dice, 5, true), b = pile(dice, 5, true);
    const Scene scene{a.view(), b.view()};
    const std::vector<Overlaps> found = found_in_parts(detector_, scene, 3, {});
    const auto message = [&](std::vector<Overlaps> results, const OverlapQuery& query = {}) {
        return std::string(error_of([&] { detector_.combine(scene, query, results); }).what());
    };
    EXPECT_EQ(message({}), "combine() needs the results of all parts of the scene");
    EXPECT_EQ(message({found[0], found[1]}),
              "result 0 of combine() is about one of another number of parts: combine() needs one result of each part");
    EXPECT_EQ(message({found[0], found[2], found[0]}),
              "result 2 of combine() is about the same part as an earlier one");
    EXPECT_EQ(message({found[0], found[1], plain_.find(scene, OverlapQuery())}),
              "result 2 of combine() is not about a part of the scene");
    EXPECT_EQ(message(found, {.self_overlaps = true}), "result 0 of combine() was found without self_overlaps");
    const auto changed = [&](const auto& change) {
        std::vector<Overlaps> others = found;
        for (Overlaps& other : others) {
            if (other.part_pairs.empty()) continue;
            change(other);
            break;
        }
        return message(others);
    };
    const auto ends = [](const std::string& text, const std::string& end) {
        return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
    };
    const auto triangles = static_cast<std::int32_t>(b.triangles.size());
    EXPECT_TRUE(ends(changed([&](Overlaps& o) { o.part_pairs[0].b = triangles; }), "a triangle that the scene lacks"));
    EXPECT_TRUE(ends(changed([](Overlaps& o) { o.part_pairs[0].a = -1; }), "a triangle that the scene lacks"));
    EXPECT_TRUE(ends(changed([](Overlaps& o) { o.part_bodies[0] = {-1, 0}; }), "a mesh that the scene lacks"));
    EXPECT_TRUE(ends(changed([](Overlaps& o) { o.part_bodies.push_back({0, 0}); }), "lists of different lengths"));
    EXPECT_TRUE(ends(changed([](Overlaps& o) { o.part.index = 3; }), "index of a part that is not below their number"));
    EXPECT_EQ(changed([](Overlaps& o) {
                  o.part_pairs.push_back(o.part_pairs[0]);
                  o.part_bodies.push_back(o.part_bodies[0]);
              }),
              "several results of combine() have the same pair: they are about parts of different scenes");
    EXPECT_EQ(difference(detector_.combine(scene, {}, found), plain_.find(scene, OverlapQuery())), "");
}

TEST_P(OverlapParts, scenes_and_deliveries_that_have_no_parts_are_refused) {
    const test::ClosedBodies bodies = test::closed_bodies(10, 2, true, false);
    const MeshView mesh = bodies.soups[0].view();
    const Part part = detector_.partition(mesh, OverlapQuery(), 1)[0];
    EXPECT_TRUE(detector_.supports(part, OverlapQuery()));
    EXPECT_EQ(error_of([&] { detector_.partition(bodies.view(), OverlapQuery(), 2); }).code,
              ErrorCode::invalid_argument);
    const std::vector<Overlaps> found = found_in_parts(detector_, mesh, 1, {});
    EXPECT_EQ(error_of([&] { detector_.combine(bodies.view(), {}, found); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector_.combine(part, {}, found); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector_.any(part, OverlapQuery()); }).code, ErrorCode::invalid_argument);
    const Overlaps& own = detector_.find(part, OverlapQuery());
    EXPECT_EQ(error_of([&] { detector_.combine(mesh, {}, std::span(&own, 1)); }).code, ErrorCode::invalid_argument);
    const Part of_impacts = detector_.partition(mesh, ProximityQuery{.radius = 1}, 1)[0];
    EXPECT_STREQ(error_of([&] { detector_.find(of_impacts, OverlapQuery()); }).what(),
                 "the part was made for a query about features");
}

TEST_P(OverlapParts, stop_ends_a_call_and_the_next_one_works) {
    Dice dice(11);
    const Soup soup = pile(dice, 6, false);
    const std::vector<Part> parts = detector_.partition(soup.view(), OverlapQuery(), 2);
    const std::vector<Overlaps> found = found_in(detector_, parts, {});
    std::stop_source source;
    source.request_stop();
    EXPECT_EQ(error_of([&] { detector_.find(parts[0], OverlapQuery(), source.get_token()); }).code,
              ErrorCode::cancelled);
    EXPECT_EQ(error_of([&] { detector_.combine(soup.view(), {}, found, source.get_token()); }).code,
              ErrorCode::cancelled);
    EXPECT_EQ(difference(detector_.combine(soup.view(), {}, found), plain_.find(soup.view(), OverlapQuery())), "");
}

TEST(OverlapPartsMemory, parts_and_their_combination_stay_within_a_memory_limit) {
    Dice dice(12);
    const Soup soup = pile(dice, sanitized ? 60 : 150, false);
    const auto differ = [](const Overlaps& x, const Overlaps& y) { return difference(x, y); };
    Detector plain(Options{.backend = Backend::cpu, .threads = 1});
    const std::vector<Part> parts = plain.partition(soup.view(), OverlapQuery(), 3);
    const std::vector<Overlaps> found = found_in(plain, parts, {});
    test::expect_same_under_limit([&](Detector& d) { return d.find(parts[1], OverlapQuery()); }, differ);
    test::expect_same_under_limit([&](Detector& d) { return d.combine(soup.view(), {.curves = true}, found); }, differ);
}

}  // namespace
}  // namespace crumple
