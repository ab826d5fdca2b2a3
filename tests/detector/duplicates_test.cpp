// The lower bound on the number of pairs: never above brute force, and exact where all triangles are the same.

#include "backends/duplicates.h"

#include <gtest/gtest.h>

#include "partition/parts_of_scene.h"
#include "soups.h"

namespace crumple {
namespace {

template <class Scalar>
using Soup = test::Soup<Scalar>;

std::int64_t bound(const MeshView& a, const MeshView* b, const Query& query, const Part* part = nullptr) {
    ParallelFor serial;
    SceneBuffers buffers;
    const Scene scene = prepare_scene(a, b, query.weld, serial, buffers);
    GroupRule rule;
    rule.prepare(query);
    return count_duplicates(scene, query, rule, Levels(part), nullptr);
}

/// Faces on a small grid, most of them several times, by index and by position, in any order of corners.
Soup<double> crowded(unsigned seed) {
    std::mt19937 engine(seed);
    const auto below = [&](std::size_t n) { return static_cast<std::int32_t>(engine() % n); };
    Soup<double> soup;
    for (int i = 0; i < 30; ++i)
        soup.vertices.push_back({below(2) * (below(2) ? 1.0 : -0.0), below(2) + 0.0, below(3) + 0.0});
    for (int i = 0; i < 60; ++i) {
        std::array<std::int32_t, 3> face{below(30), below(30), below(30)};
        for (int copies = below(3); copies >= 0; --copies) {
            soup.triangles.push_back(face);
            std::swap(face[0], face[static_cast<std::size_t>(below(3))]);
        }
    }
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(below(2));
    return soup;
}

TEST(Duplicates, are_a_lower_bound_for_every_query) {
    static const std::vector<GroupPair> excluded{{0, 0}};
    std::int64_t found = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const auto soup = crowded(seed), other = crowded(seed + 100);
        const MeshView a = soup.view(), b = other.view();
        Detector detector;
        for (const Neighbours neighbours : {Neighbours::geometric, Neighbours::skip}) {
            for (const Intersections intersections : {Intersections::all, Intersections::proper}) {
                for (const bool weld : {false, true}) {
                    for (const Wanted wanted : {Wanted::both, Wanted::within, Wanted::between}) {
                        for (const bool exclude : {false, true}) {
                            Query query{neighbours, intersections, weld, false, wanted, {}};
                            if (exclude) query.excluded_groups = excluded;
                            SCOPED_TRACE(testing::Message() << seed << ' ' << static_cast<int>(neighbours) << weld
                                                            << static_cast<int>(wanted) << exclude);
                            const std::int64_t self = bound(a, nullptr, query), both = bound(a, &b, query);
                            EXPECT_LE(self, detector.find_self(a, query).statistics.pairs);
                            EXPECT_LE(both, detector.find_between(a, b, query).statistics.pairs);
                            found += self + both;
                            for (const Part& part : detector.partition(a, 3))
                                EXPECT_LE(bound(part.mesh.view(), nullptr, query, &part),
                                          detector.find(part, query).statistics.pairs);
                        }
                    }
                }
            }
        }
    }
    EXPECT_GT(found, 1000);
}

TEST(Duplicates, are_all_pairs_of_one_face) {
    Soup<float> by_index, by_position, segments;
    by_index.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (std::int32_t i = 0; i < 20; ++i) {
        by_index.triangles.push_back({i % 3, (i + 1) % 3, (i + 2) % 3});
        by_position.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
        by_position.vertices.insert(by_position.vertices.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, -0.0f}});
    }
    segments = by_position;
    for (std::size_t v = 2; v < segments.vertices.size(); v += 3) segments.vertices[v] = {2, 0, 0};
    Query skip;
    skip.neighbours = Neighbours::skip;
    EXPECT_EQ(bound(by_index.view(), nullptr, {}), 190);
    EXPECT_EQ(bound(by_position.view(), nullptr, {}), 190);
    EXPECT_EQ(bound(segments.view(), nullptr, {}), 190);
    EXPECT_EQ(bound(by_index.view(), nullptr, skip), 0);
    EXPECT_EQ(bound(by_position.view(), nullptr, skip), 190);
    const MeshView second = by_position.view();
    EXPECT_EQ(bound(by_index.view(), &second, {}), 400);
}

}  // namespace
}  // namespace crumple
