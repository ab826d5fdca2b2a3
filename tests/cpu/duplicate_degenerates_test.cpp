// Tests of scenes with many copies of degenerate triangles: the copies cost no search of their own, and pairs equal
// those of brute force. Costs are counts of tests, not times.

#include "backends/cpu/stages/copies.h"

#include <gtest/gtest.h>

#include <functional>

#include "backends/cpu/stages/kernels.h"
#include "error_of.h"
#include "halves.h"
#include "memory_limit.h"
#include "rounds.h"
#include "soups.h"

namespace crumple {
namespace {

using test::difference;
using test::error_of;
using test::pairs_of;
using Corners = std::array<std::int32_t, 3>;

constexpr int copies = 4000;
const std::vector<std::vector<Corners>> kinds{{{0, 0, 0}}, {{0, 0, 1}, {1, 0, 0}, {0, 1, 1}}};

test::Soup<float> padded(test::Soup<float> soup, const std::vector<Corners>& kind) {
    for (int i = 0; i < copies; ++i) {
        soup.triangles.push_back(kind[static_cast<std::size_t>(i) % kind.size()]);
        if (!soup.groups.empty()) soup.groups.push_back(i % 2);
    }
    return soup;
}

test::Soup<float> sheet() {
    test::Soup<float> soup = test::wavy_sheet(40);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 3));
    return soup;
}

std::int64_t work(const Intersections& result) {
    return result.statistics.interval_tests + result.statistics.box_overlaps;
}

TEST(DuplicateDegenerates, duplicates_at_most_double_the_work) {
    static const std::vector<GroupPair> excluded{{0, 1}, {2, 2}};
    std::vector<IntersectionQuery> queries(6);
    queries[1].weld = true;
    queries[2].neighbours = Neighbours::skip;
    queries[3].kind = IntersectionKind::proper;
    queries[4].filter.groups = PairScope::between;
    queries[5].filter.excluded_groups = excluded;
    const auto plain = sheet();
    for (const auto& kind : kinds) {
        const auto soup = padded(plain, kind);
        for (const bool in_chunks : {false, true}) {
            for (std::size_t q = 0; q < queries.size(); ++q) {
                SCOPED_TRACE(testing::Message()
                             << kind.size() << " kinds, query " << q << (in_chunks ? ", chunks" : ""));
                const auto detector_for = [&](const MeshView& mesh) {
                    if (!in_chunks) return Detector();
                    const auto find = [&](Detector& by) { by.find(mesh, queries[q]); };
                    return Detector({.memory_limit = test::sufficient_limit({}, find, 4)});
                };
                Detector detector = detector_for(plain.view()), other = detector_for(soup.view());
                const Intersections &expected = detector.find(plain.view(), queries[q]),
                                    &found = other.find(soup.view(), queries[q]);
                EXPECT_LE(work(found), 2 * work(expected));
                EXPECT_LE(found.statistics.members, 2 * expected.statistics.members);
                EXPECT_EQ(found.statistics.triangles, expected.statistics.triangles + copies);
                EXPECT_EQ(found.hit.size(), soup.triangles.size());
                EXPECT_EQ(other.any(soup.view(), queries[q]), !found.pairs.empty());
            }
        }
    }
}

TEST(DuplicateDegenerates, duplicates_at_most_about_double_the_work_between_two_meshes) {
    const auto a = sheet(), b = test::wavy_sheet(30, 0.4);
    for (const auto& kind : kinds) {
        const auto padded_a = padded(a, kind), padded_b = padded(b, kind);
        for (const bool weld : {false, true}) {
            Detector detector;
            const std::int64_t expected = work(detector.find({a.view(), b.view()}, {.weld = weld}));
            const Intersections& found = detector.find({padded_a.view(), padded_b.view()}, {.weld = weld});
            EXPECT_LE(work(found), 2 * expected + 10000) << weld;
        }
    }
}

TEST(DuplicateDegenerates, duplicates_at_most_double_the_work_of_parts) {
    const auto plain = sheet();
    Detector detector;
    for (const auto& kind : kinds) {
        const auto soup = padded(plain, kind);
        std::int64_t expected = 0, found = 0;
        for (const Part& part : detector.partition(plain.view(), {}, 3)) expected += work(detector.find(part));
        for (const Part& part : detector.partition(soup.view(), {}, 3)) found += work(detector.find(part));
        EXPECT_LE(found, 2 * expected);
    }
}

/// Random triangles and, among their vertices, many copies of points and segments, in random order.
test::Soup<float> crowded(unsigned seed) {
    std::mt19937 engine(seed);
    test::Soup<float> soup = test::random_soup(30, 0.6, seed);
    const auto vertex = [&] { return static_cast<std::int32_t>(engine() % 90); };
    std::vector<Corners> degenerate;
    for (int i = 0; i < 8; ++i) {
        const std::int32_t a = vertex(), b = vertex();
        for (const Corners& c : {Corners{a, a, b}, Corners{b, a, b}, Corners{a, a, a}}) degenerate.push_back(c);
    }
    for (int i = 0; i < 100; ++i) soup.triangles.push_back(degenerate[engine() % degenerate.size()]);
    std::shuffle(soup.triangles.begin(), soup.triangles.end(), engine);
    // Some positions occur twice, for welding.
    for (std::size_t v = 0; v < 90; v += 9) soup.vertices[v] = soup.vertices[v + 1];
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
        soup.groups.push_back(static_cast<std::int32_t>(engine() % 2));
    return soup;
}

void expect_reference(const std::function<const Intersections&(Detector&)>& find) {
    Detector reference({.backend = Backend::reference});
    const Intersections& expected = find(reference);
    const std::int64_t enough = test::sufficient_limit({}, find, 4);
    for (const Options& options :
         {Options{.threads = 2, .clusters = 5, .leaf_size = 20}, Options{.threads = 1, .memory_limit = enough}}) {
        Detector detector(options);
        const Intersections& found = find(detector);
        EXPECT_EQ(difference(pairs_of(expected), pairs_of(found)), "");
        EXPECT_TRUE(std::equal(found.offsets.begin(), found.offsets.end(), expected.offsets.begin()));
        EXPECT_TRUE(std::equal(found.hit.begin(), found.hit.end(), expected.hit.begin()));
        EXPECT_EQ(found.contacts.points.size(), expected.contacts.points.size());
    }
}

TEST(DuplicateDegenerates, scenes_with_duplicates_give_the_pairs_of_brute_force) {
    static const std::vector<GroupPair> excluded{{0, 1}};
    for (unsigned seed = 1; seed <= (thorough() ? 6u : 3u); ++seed) {
        SCOPED_TRACE(seed);
        const auto soup = crowded(seed), other = crowded(seed + 100);
        const test::Halves half(soup.view());
        for (const bool weld : {false, true}) {
            for (const PairScope scope : {PairScope::both, PairScope::between, PairScope::within}) {
                const IntersectionQuery query{.output = Output::contacts, .weld = weld, .filter = {.groups = scope}};
                expect_reference([&](Detector& d) -> const Intersections& { return d.find(soup.view(), query); });
                expect_reference([&](Detector& d) -> const Intersections& { return d.find({half.a, half.b}, query); });
                expect_reference([&](Detector& d) -> const Intersections& {
                    return d.find({soup.view(), other.view()}, query);
                });
            }
            const IntersectionQuery query{
                .neighbours = Neighbours::skip, .weld = weld, .filter = {.excluded_groups = excluded}};
            expect_reference([&](Detector& d) -> const Intersections& { return d.find(soup.view(), query); });
        }
    }
}

TEST(DuplicateDegenerates, parts_with_duplicates_give_the_pairs_of_brute_force) {
    for (unsigned seed = 1; seed <= (thorough() ? 6u : 3u); ++seed) {
        const auto soup = crowded(seed);
        for (const int count : {3, 70})
            for (const Part& part : Detector().partition(soup.view(), {}, count))
                expect_reference([&](Detector& d) -> const Intersections& { return d.find(part); });
    }
}

TEST(DuplicateDegenerates, repeated_corners_are_detected_at_any_index) {
    for (const cpu::StageKernels* kernels : cpu::all_stage_kernels()) {
        for (std::int64_t n = 0; n < 70; ++n) {
            std::vector<std::int32_t> corners;
            for (std::int32_t i = 0; i < 3 * n; ++i) corners.push_back(i / 3 + i % 3);  // triangles share vertices
            EXPECT_FALSE(kernels->repeats_corner(corners.data(), 0, n)) << kernels->name;
            for (std::int64_t t = 0; t < n; ++t) {
                for (const int corner : {0, 1, 2}) {
                    const auto at = [&](int k) -> std::int32_t& {
                        return corners[static_cast<std::size_t>(3 * t + k % 3)];
                    };
                    const std::int32_t before = std::exchange(at(corner), at(corner + 1));
                    EXPECT_TRUE(kernels->repeats_corner(corners.data(), 0, n)) << kernels->name << ' ' << t;
                    EXPECT_FALSE(kernels->repeats_corner(corners.data(), t + 1, n)) << kernels->name << ' ' << t;
                    at(corner) = before;
                }
            }
        }
    }
}

}  // namespace
}  // namespace crumple
