// Tests of the parts that Detector::partition makes of a scene: each can be searched without the scene, and all parts
// together report each pair of the whole result once.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "error_of.h"
#include "partition/part_centres.h"
#include "partition/parts_of_scene.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;

/// Pairs that parts have reported, with the points of their contacts.
using OwnedPairs = std::map<Pair, std::vector<std::array<double, 3>>>;

void add(const Intersections& found, OwnedPairs& result) {
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        std::vector<std::array<double, 3>> contact;
        if (!found.contacts.kinds.empty()) {
            const auto* points = found.contacts.points.data();
            contact.assign(points + found.contacts.offsets[i], points + found.contacts.offsets[i + 1]);
        }
        EXPECT_TRUE(result.emplace(found.pairs[i], contact).second)
            << "two parts own " << testing::PrintToString(found.pairs[i]);
    }
}

std::vector<Pair> pairs_of(const OwnedPairs& result) {
    std::vector<Pair> pairs;
    for (const auto& entry : result) pairs.push_back(entry.first);
    return pairs;
}

void expect_union(const Intersections& whole, const std::vector<Part>& parts, const IntersectionQuery& query,
                  Detector& elsewhere) {
    OwnedPairs expected, joined;
    add(whole, expected);
    for (const Part& part : parts) add(elsewhere.find(part, query), joined);
    ASSERT_EQ(difference(pairs_of(expected), pairs_of(joined)), "") << parts.size() << " parts";
    EXPECT_TRUE(expected == joined) << parts.size() << " parts: contacts differ";
}

template <class Scalar>
class PartUnion : public testing::Test {
   public:
    static test::Soup<Scalar> soup(int count, double size, unsigned seed = 1) {
        auto soup = test::random_soup<Scalar>(count, size, seed);
        // Adds triangles adjacent by index and by position, duplicates and degenerate triangles.
        for (std::size_t t = 7; t < soup.triangles.size(); t += 7) soup.triangles[t][0] = soup.triangles[t - 1][2];
        for (std::size_t v = 30; v < soup.vertices.size(); v += 30) soup.vertices[v] = soup.vertices[v - 3];
        for (std::size_t t = 11; t < soup.triangles.size(); t += 11) soup.triangles[t] = soup.triangles[t - 3];
        for (std::size_t t = 13; t < soup.triangles.size(); t += 26) soup.triangles[t][1] = soup.triangles[t][2];
        for (std::size_t t = 0; t < soup.triangles.size(); ++t)
            soup.groups.push_back(static_cast<std::int32_t>(t / 3 % 4));
        return soup;
    }
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(PartUnion, Scalars, );

const std::vector<GroupPair> excluded{{0, 1}, {2, 2}};

/// Returns queries. The first one is tested with more numbers of parts than the others (counts()).
std::vector<IntersectionQuery> queries() {
    return {{.output = Output::contacts},
            {.neighbours = Neighbours::skip, .weld = true},
            {.output = Output::contacts, .weld = true, .filter = {.groups = PairScope::between}},
            {.kind = IntersectionKind::proper, .filter = {.groups = PairScope::within}},
            {.filter = {.excluded_groups = excluded}}};
}

std::vector<int> counts(const IntersectionQuery& query) {
    if (query.contacts() && !query.weld) return {1, 2, 3, 64, 65, 1000};
    return {3, 64, 65};
}

TYPED_TEST(PartUnion, parts_of_one_soup_give_all_pairs_once) {
    const auto soup = TestFixture::soup(1200, 0.12);
    Detector detector({.threads = 2, .leaf_size = 100}), elsewhere({.threads = 1, .leaf_size = 50}),
        reference({.backend = Backend::reference});
    for (const IntersectionQuery& query : queries()) {
        const Intersections whole = detector.find(soup.view(), query);
        ASSERT_GT(whole.pairs.size(), 100u);
        for (const int count : counts(query)) {
            const auto parts = detector.partition(soup.view(), {}, count);
            expect_union(whole, parts, query, elsewhere);
            if (count == 3 || count == 1000) expect_union(whole, parts, query, reference);
        }
    }
}

TYPED_TEST(PartUnion, parts_of_two_meshes_give_all_pairs_once) {
    const auto a = TestFixture::soup(700, 0.15), b = TestFixture::soup(500, 0.15, 4);
    const auto ungrouped = test::random_soup<double>(300, 0.2, 9);
    Detector detector({.threads = 2, .leaf_size = 100}), elsewhere({.threads = 1, .leaf_size = 50}),
        reference({.backend = Backend::reference});
    for (const auto& second : {b.view(), ungrouped.view()}) {
        for (const IntersectionQuery& query : queries()) {
            const Intersections whole = detector.find({a.view(), second}, query);
            ASSERT_GT(whole.pairs.size(), 50u);
            for (const int count : counts(query)) {
                const auto parts = detector.partition({a.view(), second}, {}, count);
                expect_union(whole, parts, query, elsewhere);
                if (count == 3) expect_union(whole, parts, query, reference);
            }
        }
    }
}

TEST(Part, part_holds_both_triangles_of_its_pairs) {
    auto soup = test::wavy_sheet(40);
    Detector detector;
    const std::vector<Pair> whole = test::pairs_of(detector.find(soup.view()));
    ASSERT_GT(whole.size(), 50u);
    const std::vector<Part> parts = detector.partition(soup.view(), {}, 7);
    for (const Part& part : parts) {
        EXPECT_EQ(part.count, 7);
        EXPECT_FALSE(part.second);
        const auto& xyz = std::get<std::vector<float>>(part.mesh.vertices);
        for (std::size_t i = 0; i < part.mesh.ids.size(); ++i)
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const auto local = static_cast<std::size_t>(part.mesh.corners[3 * i + corner]);
                const auto global = soup.triangles[static_cast<std::size_t>(part.mesh.ids[i])][corner];
                for (std::size_t axis = 0; axis < 3; ++axis)
                    ASSERT_EQ(xyz[3 * local + axis], soup.vertices[static_cast<std::size_t>(global)][axis]);
            }
        EXPECT_LT(xyz.size(), 3 * part.mesh.ids.size()) << "vertices are shared";
    }
    soup = {};  // parts must not refer to it
    std::vector<Pair> joined;
    for (const Part& part : parts) {
        const auto is_member = [&](std::int32_t t) { return std::ranges::binary_search(part.mesh.ids, t); };
        for (const Pair& pair : detector.find(part).pairs) {
            EXPECT_TRUE(is_member(pair.a)) << pair.a << " in part " << part.index;
            EXPECT_TRUE(is_member(pair.b)) << pair.b << " in part " << part.index;
            joined.push_back(pair);
        }
    }
    std::sort(joined.begin(), joined.end());
    EXPECT_EQ(difference(whole, joined), "");
}

TEST(Part, offsets_and_hits_follow_the_order_of_ids) {
    const auto a = test::random_soup(300, 0.3), b = test::random_soup(200, 0.3, 4);
    Detector detector;
    std::size_t found = 0;
    for (const Part& part : detector.partition({a.view(), b.view()}, {}, 3)) {
        const Intersections& result = detector.find(part);
        const auto &first = part.mesh.ids, &second = part.second->ids;
        ASSERT_EQ(result.offsets.size(), first.size() + 1);
        ASSERT_EQ(result.hit.size(), first.size());
        ASSERT_EQ(result.hit_second.size(), second.size());
        std::vector<std::uint8_t> hit(first.size()), hit_second(second.size());
        for (std::size_t i = 0; i < first.size(); ++i)
            for (std::int64_t p = result.offsets[i]; p < result.offsets[i + 1]; ++p) {
                EXPECT_EQ(result.pairs[p].a, first[i]);
                hit[i] = 1;
                hit_second[static_cast<std::size_t>(std::ranges::lower_bound(second, result.pairs[p].b) -
                                                    second.begin())] = 1;
                ++found;
            }
        EXPECT_TRUE(std::ranges::equal(hit, result.hit));
        EXPECT_TRUE(std::ranges::equal(hit_second, result.hit_second));
    }
    EXPECT_EQ(found, detector.find({a.view(), b.view()}).pairs.size());
}

TEST(Part, parts_do_not_depend_on_threads_or_backend) {
    const auto soup = test::wavy_sheet(120);
    const auto parts_of = [&](int threads, Backend backend) {
        return Detector({.backend = backend, .threads = threads}).partition(soup.view(), {}, 100);
    };
    const auto expected = parts_of(1, Backend::reference);
    for (const int threads : {1, 7}) {
        const auto parts = parts_of(threads, Backend::cpu);
        ASSERT_EQ(parts.size(), expected.size());
        for (std::size_t k = 0; k < parts.size(); ++k) {
            EXPECT_EQ(parts[k].index, static_cast<std::int32_t>(k));
            EXPECT_EQ(parts[k].mesh.ids, expected[k].mesh.ids);
            EXPECT_EQ(parts[k].mesh.corners, expected[k].mesh.corners);
            EXPECT_EQ(parts[k].mesh.vertices, expected[k].mesh.vertices);
            ASSERT_EQ(parts[k].levels.size(), 2u);
            for (std::size_t l = 0; l < 2; ++l) {
                EXPECT_EQ(parts[k].levels[l].cluster, expected[k].levels[l].cluster);
                EXPECT_EQ(parts[k].levels[l].masks, expected[k].levels[l].masks);
            }
        }
    }
}

// A process with a slice of the triangles finds the same members as one with all triangles.
TEST(Part, slices_of_the_triangles_give_the_same_members_of_parts) {
    const auto soup = test::random_soup<double>(500, 0.1);
    ParallelFor serial;
    SceneBuffers buffers;
    const PreparedScene scene = prepare_scene(soup.view(), nullptr, false, serial, buffers);
    for (const int count : {5, 64, 65, 1000, 5000}) {
        const PartCentres centres = place_parts(scene, count, serial);
        const PartTree tree = centres.tree();
        const std::vector<Part> parts = make_parts(scene, count, serial);
        for (const std::int64_t begin : {0, 123, 499}) {
            auto alone = soup;  // has another bounding box than the whole soup
            alone.triangles = {soup.triangles.begin() + begin,
                               soup.triangles.begin() + std::min<std::int64_t>(begin + 50, 500)};
            SceneBuffers own;
            const PreparedScene slice = prepare_scene(alone.view(), nullptr, false, serial, own);
            const auto ball = [&](std::int64_t t) { return PartBall(slice.triangle(t), tree.normalise); };
            const PartMembers members = list_members(tree, count, ball, 0, slice.triangle_count());
            std::int64_t listed = 0, expected = 0;
            for (std::size_t k = 0; k < parts.size(); ++k) {
                const Part& part = parts[k];
                for (const std::int32_t id : part.mesh.ids)
                    expected += id >= begin && id < begin + slice.triangle_count();
                for (std::int64_t i = members.first[k]; i < members.first[k + 1]; ++i, ++listed) {
                    const auto at = static_cast<std::size_t>(i);
                    const auto id = members.triangle[at] + static_cast<std::int32_t>(begin);
                    const auto place = std::ranges::lower_bound(part.mesh.ids, id) - part.mesh.ids.begin();
                    ASSERT_LT(place, part.mesh.size());
                    ASSERT_EQ(part.mesh.ids[static_cast<std::size_t>(place)], id);
                    for (std::size_t l = 0; l < part.levels.size(); ++l)
                        EXPECT_EQ(part.levels[l].masks[static_cast<std::size_t>(place)],
                                  members.masks[part.levels.size() * at + l]);
                }
            }
            EXPECT_EQ(listed, expected) << count << " parts, slice from " << begin;
            EXPECT_GE(listed, slice.triangle_count());
        }
    }
}

TEST(Part, up_to_64_parts_need_one_level_and_up_to_4096_two) {
    const auto soup = test::random_soup(2000, 0.05);
    Detector detector;
    for (const auto& [count, levels] : {std::pair{1, 1u}, {64, 1u}, {65, 2u}, {4096, 2u}, {4097, 3u}}) {
        const auto parts = detector.partition(soup.view(), {}, count);
        ASSERT_EQ(parts.size(), static_cast<std::size_t>(count));
        std::vector<std::vector<std::int32_t>> paths;
        for (const Part& part : parts) {
            ASSERT_EQ(part.levels.size(), levels) << count;
            std::vector<std::int32_t> path;
            for (const PartLevel& level : part.levels) path.push_back(level.cluster);
            paths.push_back(path);
        }
        EXPECT_TRUE(std::ranges::is_sorted(paths)) << count;
        EXPECT_EQ(std::ranges::adjacent_find(paths), paths.end()) << "two parts at one place";
    }
}

TEST(Part, clusters_get_parts_in_proportion_to_points_but_1_to_64_each) {
    const std::vector<std::int64_t> points{1000, 0, 3000, 10};
    const std::vector<int> shares = distribute_parts(84, 64, points);
    EXPECT_EQ(std::accumulate(shares.begin(), shares.end(), 0), 84);
    EXPECT_NEAR(shares[0], 20, 2);
    EXPECT_EQ(shares[1], 1);
    EXPECT_NEAR(shares[2], 60, 3);
    EXPECT_EQ(shares[3], 1);
    EXPECT_EQ(distribute_parts(128, 64, std::vector<std::int64_t>{5, 0}), (std::vector<int>{64, 64}));
}

// Parts are checked before use, since they may come from elsewhere.
TEST(Part, inconsistent_parts_are_rejected) {
    const auto soup = test::random_soup(40, 0.4), other = test::random_soup(30, 0.4, 2);
    Detector detector;
    const Part good = detector.partition({soup.view(), other.view()}, {}, 3)[1];
    const auto refused = [&](auto spoil) {
        Part part = good;
        spoil(part);
        const Error error = error_of([&] { detector.find(part); });
        EXPECT_TRUE(detector.find(good).statistics.triangles == good.triangle_count());
        return error;
    };
    ASSERT_GT(good.mesh.size(), 5);
    EXPECT_EQ(error_of([&] { detector.find(Part{}); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](Part& p) { p.index = 3; }).element, Element::option);
    EXPECT_EQ(refused([](Part& p) { p.levels.resize(5, p.levels[0]); }).element, Element::option);
    EXPECT_EQ(refused([](Part& p) { p.levels[0].cluster = 64; }).element, Element::option);
    EXPECT_EQ(refused([](Part& p) { p.levels[0].masks.pop_back(); }).element, Element::option);
    EXPECT_EQ(refused([](Part& p) { p.mesh.corners.pop_back(); }).element, Element::option);
    EXPECT_EQ(refused([](Part& p) { std::get<std::vector<float>>(p.mesh.vertices).pop_back(); }).element,
              Element::option);
    EXPECT_EQ(refused([](Part& p) { p.levels[0].masks[4] = 0; }).index, 4);
    EXPECT_EQ(refused([](Part& p) { p.mesh.ids[3] = p.mesh.ids[2]; }).index, 3);
    EXPECT_EQ(refused([](Part& p) { p.mesh.ids[0] = -1; }).index, 0);
    EXPECT_EQ(refused([](Part& p) { p.second->corners[7] = 1000; }).code, ErrorCode::index_out_of_range);
    EXPECT_EQ(refused([](Part& p) { p.mesh.groups = {1}; }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(refused([](Part& p) { std::get<std::vector<float>>(p.mesh.vertices)[4] = NAN; }).code,
              ErrorCode::not_finite);
    EXPECT_EQ(error_of([&] { detector.partition(soup.view(), {}, 0); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector.partition(soup.view(), {}, 262145); }).code, ErrorCode::invalid_argument);
}

// Centres are computed in float32, where the largest float64 number rounds to infinity.
TEST(Part, parts_of_a_scene_with_largest_float64_numbers_give_all_pairs_once) {
    constexpr double most = std::numeric_limits<double>::max();
    test::Soup<double> soup;
    soup.vertices = {{-most, most, -most}, {-most, most, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0},
                     {0.25, 0.25, -1},     {0.25, 0.25, 1},  {2, 2, 0}};
    soup.triangles = {{0, 0, 0}, {0, 0, 0}, {0, 0, 1}, {2, 3, 4}, {5, 6, 7}};
    Detector detector;
    const IntersectionQuery query{.weld = true};
    const Intersections whole = detector.find(soup.view(), query);
    ASSERT_GE(whole.pairs.size(), 1u);
    for (const int count : {1, 2, 4, 65, 1000})
        expect_union(whole, detector.partition(soup.view(), {}, count), query, detector);
}

TEST(Part, parts_of_a_scene_far_from_the_origin_give_all_pairs_once) {
    auto soup = test::random_soup<double>(400, 0.2);
    for (auto& vertex : soup.vertices)
        for (double& x : vertex) x = (x + 1e6) * 1e200;
    Detector detector;
    const Intersections whole = detector.find(soup.view());
    ASSERT_GT(whole.pairs.size(), 50u);
    for (const int count : {3, 65, 1000}) expect_union(whole, detector.partition(soup.view(), {}, count), {}, detector);
}

// If centres cannot separate the triangles, one part has them all, and the others are empty.
TEST(Part, coincident_triangles_are_in_one_part) {
    test::Soup<float> stack;
    stack.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (int i = 0; i < 50; ++i) stack.triangles.push_back({0, 1, 2});
    Detector detector;
    const Intersections whole = detector.find(stack.view());
    for (const int count : {2, 64, 65, 1000}) {
        const auto parts = detector.partition(stack.view(), {}, count);
        expect_union(whole, parts, {}, detector);
        std::int64_t members = 0;
        int filled = 0;
        for (const Part& part : parts) {
            members += part.triangle_count();
            filled += part.triangle_count() > 0;
        }
        EXPECT_EQ(members, 50) << count;
        EXPECT_EQ(filled, 1) << count;
    }
}

TEST(Part, parts_of_an_empty_mesh_are_empty) {
    Detector detector;
    for (const int count : {1, 64, 1000}) {
        for (const Part& part : detector.partition(MeshView(), {}, count)) {
            EXPECT_EQ(part.triangle_count(), 0);
            EXPECT_TRUE(detector.find(part).pairs.empty());
        }
        const auto soup = test::random_soup(20, 0.3);
        for (const Part& part : detector.partition({soup.view(), MeshView()}, {}, count))
            EXPECT_TRUE(detector.find(part, {.output = Output::contacts}).pairs.empty());
    }
}

TEST(Part, parts_overlap_little_and_are_balanced) {
    const auto soup = test::wavy_sheet(100);
    Detector detector;
    for (const auto& [count, most_members, most_share] : {std::tuple{8, 1.5, 2.0}, {64, 1.8, 2.5}, {200, 2.5, 3.0}}) {
        std::int64_t members = 0, largest = 0;
        for (const Part& part : detector.partition(soup.view(), {}, count)) {
            members += part.triangle_count();
            largest = std::max(largest, part.triangle_count());
        }
        const auto triangles = static_cast<double>(soup.triangles.size());
        EXPECT_GE(members, static_cast<std::int64_t>(soup.triangles.size()));
        EXPECT_LT(static_cast<double>(members), most_members * triangles) << count;
        EXPECT_LT(static_cast<double>(largest * count), most_share * static_cast<double>(members)) << count;
    }
}

}  // namespace
}  // namespace crumple
