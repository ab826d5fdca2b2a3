// Tests of the lists of feature tests, the pairs of features that must be decided for pairs of triangles: over all
// pairs of triangles of a scene, each pair of features without a common vertex is listed exactly once.

#include "filters/features/tests_of_pair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "scene/scene_features.h"
#include "soups.h"

namespace crumple {
namespace {

/// Ids of a pair of features, and the four vertices of both.
using Line = std::array<std::int32_t, 6>;

Line line_of(const FeatureTest& test) {
    return {test.pair.a, test.pair.b, test.vertex[0], test.vertex[1], test.vertex[2], test.vertex[3]};
}

/// Returns triangles over so few vertices that they share them, use one twice or thrice, or coincide; some vertices
/// have equal positions.
test::Soup<float> tangle(unsigned seed, int vertices, int triangles) {
    std::mt19937 engine(seed);
    const auto below = [&](int n) { return static_cast<std::int32_t>(engine() % static_cast<unsigned>(n)); };
    test::Soup<float> soup;
    for (int v = 0; v < vertices; ++v)
        soup.vertices.push_back(
            {static_cast<float>(below(3)), static_cast<float>(below(3)), static_cast<float>(below(2))});
    for (int t = 0; t < triangles; ++t) {
        soup.triangles.push_back({below(vertices), below(vertices), below(vertices)});
        if (below(8) == 0) soup.triangles.push_back(soup.triangles.front());
    }
    return soup;
}

/// A scene, and sorted lists of its feature tests, by brute force and by the code under test.
class Tangle {
   public:
    Tangle(const test::Soup<float>& soup, bool weld) : features(nullptr) {
        ParallelFor serial;
        scene = prepare_scene(soup.view(), nullptr, false, serial, buffers_);
        features.prepare(scene, weld, serial);
    }

    std::vector<Line> vertex_faces() const {
        std::set<std::int32_t> used(scene.corners, scene.corners + 3 * scene.triangle_count());
        std::vector<Line> lines;
        for (const std::int32_t v : used)
            for (std::int32_t t = 0; t < scene.triangle_count(); ++t) {
                const std::int32_t* c = scene.corners + 3 * t;
                if (!same(v, c[0]) && !same(v, c[1]) && !same(v, c[2])) lines.push_back({v, t, v, c[0], c[1], c[2]});
            }
        return lines;
    }

    std::vector<Line> edge_edges() const {
        std::set<Edge> all;
        for (std::int64_t side = 0; side < 3 * scene.triangle_count(); ++side) {
            const std::int32_t *c = scene.corners + side / 3 * 3, a = c[side % 3], b = c[(side + 1) % 3];
            if (a != b) all.insert({std::min(a, b), std::max(a, b)});
        }
        const std::vector<Edge> edges(all.begin(), all.end());
        std::vector<Line> lines;
        for (std::size_t i = 0; i < edges.size(); ++i)
            for (std::size_t j = i + 1; j < edges.size(); ++j) {
                const Edge e = edges[i], f = edges[j];
                if (same(e.a, f.a) || same(e.a, f.b) || same(e.b, f.a) || same(e.b, f.b)) continue;
                lines.push_back({static_cast<std::int32_t>(i), static_cast<std::int32_t>(j), e.a, e.b, f.a, f.b});
            }
        return lines;
    }

    /// Lists the tests for one pair of triangles after another, with the lower triangle as the first or second one.
    std::array<std::vector<Line>, feature_kinds> listed(bool lower_first) const {
        std::array<std::vector<Line>, feature_kinds> lines;
        const auto name = [&](std::int32_t vertex) { return features.name(vertex); };
        for (std::int32_t i = 0; i < scene.triangle_count(); ++i)
            for (std::int32_t j = i + 1; j < scene.triangle_count(); ++j) {
                FeatureTest face[6], edge[9], *next_face = face, *next_edge = edge;
                const auto a = record(lower_first ? i : j), b = record(lower_first ? j : i);
                list_tests_of_pair(a, b, name, next_face, next_edge);
                std::transform(face, next_face, std::back_inserter(lines[0]), line_of);
                std::transform(edge, next_edge, std::back_inserter(lines[1]), line_of);
            }
        for (auto& list : lines) std::sort(list.begin(), list.end());
        return lines;
    }

    /// Lists the tests for all pairs of triangles in one batch, by the kernels of a table.
    std::array<std::vector<Line>, feature_kinds> listed_by(const cpu::FeatureTables& table) const {
        const std::int64_t n = scene.triangle_count();
        std::vector<FeatureRecord<1>> records;
        for (std::int32_t t = 0; t < n; ++t) records.push_back(record(t));
        std::vector<std::uint32_t> packed;
        for (std::uint32_t i = 0; i < n; ++i)
            for (std::uint32_t j = i + 1; j < n; ++j) packed.push_back((i + j) % 2 ? j << 16 | i : i << 16 | j);
        const cpu::PairsLeft<1> pairs{records.data(), records.data(), packed.data(), packed.size()};
        std::vector<std::uint32_t> storage[2];
        cpu::TestList tests[2];
        for (std::size_t k = 0; k < 2; ++k) {
            storage[k].resize(9 * packed.size() + cpu::padding);
            tests[k].test = storage[k].data();
        }
        table.at_rest.list(pairs, features.is_welded() ? features.names().data() : nullptr, tests[0], tests[1]);
        std::array<std::vector<Line>, feature_kinds> lines;
        FeatureTest test;
        for (std::size_t i = 0; i < tests[0].count; ++i) {
            cpu::write_test<FeatureKind::vertex_face>(pairs, tests[0], i, test);
            lines[0].push_back(line_of(test));
        }
        for (std::size_t i = 0; i < tests[1].count; ++i) {
            cpu::write_test<FeatureKind::edge_edge>(pairs, tests[1], i, test);
            lines[1].push_back(line_of(test));
        }
        for (auto& list : lines) std::sort(list.begin(), list.end());
        return lines;
    }

    PreparedScene scene;
    SceneFeatures features;

   private:
    bool same(std::int32_t v, std::int32_t w) const {
        return v == w || (features.is_welded() && scene.position(v) == scene.position(w));
    }
    FeatureRecord<1> record(std::int32_t t) const {
        FeatureRecord<1> r{};
        for (std::size_t k = 0; k < 3; ++k) {
            r.vertex[k] = scene.corners[3 * t + static_cast<std::int32_t>(k)];
            r.edge[k] = features.edges_of(t)[k];
        }
        r.triangle = t;
        r.owned = features.owned(t);
        return r;
    }

    SceneBuffers buffers_;
};

TEST(FeatureTestLists, each_feature_pair_without_a_common_vertex_is_listed_once) {
    std::size_t faces = 0, edges = 0;
    for (unsigned seed = 1; seed <= 40; ++seed)
        for (const bool weld : {false, true}) {
            const test::Soup<float> soup = tangle(seed, 6 + static_cast<int>(seed), 25);
            const Tangle tangle(soup, weld);
            const auto vertex_faces = tangle.vertex_faces(), edge_edges = tangle.edge_edges();
            for (const bool lower_first : {true, false}) {
                const auto listed = tangle.listed(lower_first);
                ASSERT_EQ(listed[0], vertex_faces) << seed;
                ASSERT_EQ(listed[1], edge_edges) << seed;
            }
            for (const auto* table : cpu::all_feature_kernels()) {
                const auto listed = tangle.listed_by(*table);
                ASSERT_EQ(listed[0], vertex_faces) << seed;
                ASSERT_EQ(listed[1], edge_edges) << seed;
            }
            faces += vertex_faces.size(), edges += edge_edges.size();
        }
    EXPECT_GT(faces, 10'000U);
    EXPECT_GT(edges, 10'000U);
}

}  // namespace
}  // namespace crumple
