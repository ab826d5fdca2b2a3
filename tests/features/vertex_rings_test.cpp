// Compares rings about a vertex, the vertices within a number of edges from it, with a plain walk along edges. Tests
// when rings are recomputed.

#include "scene/vertex_rings.h"

#include <gtest/gtest.h>

#include <set>

#include "features/moving_soups.h"

namespace crumple::test {
namespace {

/// Runs tasks on the calling thread in reverse order, and counts them.
class Backwards : public ParallelFor {
   public:
    void parallel_for(std::size_t n, Task task) override {
        tasks += n;
        for (std::size_t i = n; i-- > 0;) task(i);
    }
    std::size_t tasks = 0;
};

class RingsOfVertices : public testing::Test {
   protected:
    void prepare(const MovingSoup<>& soup, std::int32_t count, bool weld = false) {
        const PreparedScene scene = prepare_scene(soup.view(), nullptr, false, workers, buffers);
        features.prepare(scene, weld, workers);
        const std::size_t before = workers.tasks;
        rings.prepare(features, scene.vertex_count(), count, workers, cancellation);
        recomputed = workers.tasks > before;
    }
    /// Compares rings with sets that grow edge by edge.
    void expect_rings(const MovingSoup<>& soup, std::int32_t count, bool weld = false) {
        prepare(soup, count, weld);
        EXPECT_EQ(rings.rings(), count);
        std::vector<std::set<std::int32_t>> next(soup.start.size());
        for (const auto& corner : soup.triangles)
            for (const std::int32_t v : corner)
                for (const std::int32_t w : corner)
                    next[static_cast<std::size_t>(features.name(v))].insert(features.name(w));
        for (std::int32_t v = 0; v < static_cast<std::int32_t>(soup.start.size()); ++v) {
            if (features.name(v) != v) continue;
            std::set<std::int32_t> within{v};
            for (std::int32_t step = 0; step < count; ++step)
                for (const std::int32_t w : std::set(within))
                    within.insert(next[static_cast<std::size_t>(w)].begin(), next[static_cast<std::size_t>(w)].end());
            for (const std::int32_t w : within) ASSERT_EQ(rings.joined(v, w), v != w) << v << " and " << w;
            within.erase(v);
            const auto about = rings.about(v);
            ASSERT_EQ(std::vector(about.begin(), about.end()), std::vector(within.begin(), within.end()))
                << "vertex " << v << ", " << count << " rings";
        }
    }

    MemoryMeter meter;
    SceneBuffers buffers{&meter};
    SceneFeatures features{&meter};
    VertexRings rings{&meter};
    Backwards workers;
    Cancellation cancellation;
    bool recomputed = false;
};

TEST_F(RingsOfVertices, rings_match_a_walk_along_edges) {
    std::vector<NamedMove<double>> soups = moving_soups<double>();
    soups.push_back({"many", moving_grid(4, 5000, 1500, 30)});  // too many vertices for one task (a chunk)
    for (const NamedMove<double>& move : soups)
        for (const std::int32_t count : {1, 2, 3, 6, 1})
            for (const bool weld : {false, true}) {
                if (move.soup.start.size() > 1000 && (weld || count > 3)) continue;
                SCOPED_TRACE(move.name + (weld ? ", welded" : ""));
                expect_rings(move.soup, count, weld);
                if (HasFailure()) return;
            }
}

TEST_F(RingsOfVertices, rings_are_reused_after_motion_and_recomputed_for_new_triangles) {
    MovingSoup<> soup = moving_grid(4, 30, 20, 31);
    prepare(soup, 2);
    EXPECT_TRUE(recomputed);
    for (auto& p : soup.start) p[0] += 1;
    prepare(soup, 2);
    EXPECT_FALSE(recomputed) << "vertices may move";
    std::swap(soup.triangles[3], soup.triangles[7]);
    prepare(soup, 2);
    EXPECT_TRUE(recomputed) << "other triangles, though their edges are the same";
    expect_rings(soup, 3);
    EXPECT_TRUE(recomputed) << "another number of rings";
    expect_rings(soup, 3, true);
    EXPECT_TRUE(recomputed) << "other names";
    for (auto& p : soup.start) p[0] = -p[0];
    prepare(soup, 3, true);
    EXPECT_FALSE(recomputed) << "the same ones";
    soup.start[7] = soup.start[21];
    expect_rings(soup, 3, true);
    soup.triangles[5][1] = (soup.triangles[5][1] + 1) % 30;
    expect_rings(soup, 3);
    soup.vertex({}, {});
    expect_rings(soup, 3);
    soup.triangles.pop_back();
    expect_rings(soup, 3);
}

TEST_F(RingsOfVertices, rings_are_complete_after_a_memory_error_and_release_frees_them) {
    const MovingSoup<> few = moving_grid(4, 30, 20, 31), many = moving_grid(4, 3000, 2000, 32);
    expect_rings(few, 2);
    prepare(many, 1);
    rings.release();
    meter.limit = meter.used + 50000;  // enough for the edges of each vertex, not for all rings
    EXPECT_THROW(prepare(many, 3), MemoryMeter::Exceeded);
    meter.limit = 0;
    expect_rings(many, 3);
    const std::int64_t with = meter.used;
    rings.release();
    features.release();
    EXPECT_LT(meter.used, with);
    EXPECT_EQ(meter.used, static_cast<std::int64_t>(buffers.checks.capacity() * sizeof(ChunkCheck)))
        << "all memory is given back";
}

}  // namespace
}  // namespace crumple::test
