// Compares vertices and edges of scenes with a plain listing, and tests the balls of moving triangles.

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "base/parallel_for.h"
#include "features/moving_soups.h"
#include "geometry/ball.h"
#include "geometry/exact.h"
#include "scene/scene_features.h"

namespace crumple::test {
namespace {

/// Runs tasks on the calling thread in reverse order.
class Backwards : public ParallelFor {
   public:
    void parallel_for(std::size_t n, Task task) override {
        for (std::size_t i = n; i-- > 0;) task(i);
    }
};

void expect_listing(const MovingSoup<>& soup, const PreparedScene& scene, const SceneFeatures& features) {
    std::map<Edge, std::pair<std::size_t, std::size_t>> owner;  // triangle and side
    std::set<std::int32_t> seen;
    std::vector<std::uint8_t> owned(soup.triangles.size());
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = soup.triangles[t][k], w = soup.triangles[t][(k + 1) % 3];
            if (seen.insert(v).second) owned[t] = static_cast<std::uint8_t>(owned[t] | 1 << k);
            if (v != w && owner.emplace(Edge{std::min(v, w), std::max(v, w)}, std::pair(t, k)).second)
                owned[t] = static_cast<std::uint8_t>(owned[t] | 8 << k);
        }
    ASSERT_EQ(features.edges().size(), owner.size());
    std::map<Edge, std::int32_t> index;
    for (const auto& [edge, by] : owner) {
        const auto i = static_cast<std::int32_t>(index.size());
        EXPECT_EQ(features.edges()[i], edge) << "edge " << i;
        index[edge] = i;
    }
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
        const auto triangle = static_cast<std::int64_t>(t);
        EXPECT_EQ(features.owned(triangle), owned[t]) << "triangle " << t;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t v = soup.triangles[t][k], w = soup.triangles[t][(k + 1) % 3];
            EXPECT_EQ(features.edges_of(triangle)[k], v == w ? -1 : index.at({std::min(v, w), std::max(v, w)}));
        }
    }
    for (std::int32_t v = 0; v < scene.vertex_count(); ++v) {
        std::int32_t lowest = v;
        for (std::int32_t w = v; features.is_welded() && w-- > 0;)
            if (scene.position(w) == scene.position(v) && scene.end_position(w) == scene.end_position(v)) lowest = w;
        EXPECT_EQ(features.name(v), lowest);
    }
}

TEST(SceneFeatures, features_match_a_plain_listing) {
    MemoryMeter meter;
    SceneBuffers buffers(&meter);
    SceneFeatures features(&meter);
    Backwards workers;
    std::vector<NamedMove<double>> soups = moving_soups<double>();
    soups.push_back({"many", moving_grid(4, 5000, 9000, 30)});  // too many vertices for one task (a chunk)
    soups.push_back({"one fan", {}});
    for (std::int32_t i = 0; i < 6000; ++i) soups.back().soup.vertex({}, {});
    for (std::int32_t i = 2; i < 6000; ++i) soups.back().soup.triangles.push_back({i, 0, i - 1});
    for (const NamedMove<double>& move : soups)
        for (const bool weld : {false, true, false}) {
            SCOPED_TRACE(move.name + (weld ? ", welded" : ""));
            if (weld && move.soup.start.size() > 1000) continue;  // the listing compares all pairs
            PreparedScene scene = prepare_scene(move.soup.view(), nullptr, false, workers, buffers);
            add_motion(move.soup.end_view(), workers, buffers, scene);
            features.prepare(scene, weld, workers);
            ASSERT_NO_FATAL_FAILURE(expect_listing(move.soup, scene, features));
            if (HasFailure()) return;
        }
    features.release();
    EXPECT_EQ(meter.used, static_cast<std::int64_t>(buffers.checks.capacity() * sizeof(ChunkCheck)))
        << "all memory is given back";
}

TEST(SceneFeatures, features_match_a_plain_listing_after_triangles_changed) {
    MemoryMeter meter;
    SceneBuffers buffers(&meter);
    SceneFeatures features(&meter);
    Backwards workers;
    MovingSoup<> soup = moving_grid(4, 30, 20, 31);
    const auto update = [&] {
        const PreparedScene scene = prepare_scene(soup.view(), nullptr, false, workers, buffers);
        features.prepare(scene, false, workers);
        expect_listing(soup, scene, features);
    };
    update();
    std::swap(soup.triangles[3], soup.triangles[7]);
    update();
    soup.triangles[5][1] = (soup.triangles[5][1] + 1) % 30;
    update();
    soup.vertex({}, {});
    update();
    soup.triangles.pop_back();
    update();
    // A call that exceeds a limit leaves no partial state that later calls would use.
    soup = moving_grid(4, 3000, 2000, 32);
    meter.limit = meter.used + 20000;
    EXPECT_THROW(update(), MemoryMeter::Exceeded);
    meter.limit = 0;
    update();
}

Rational squared(const Vec3<Rational>& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

/// Checks the corners of random moving triangles, at the start and at the end.
TEST(SweptBalls, balls_hold_their_triangles_throughout_the_step) {
    Draw draw(33);
    for (int i = 0; i < 3000; ++i) {
        const double size = std::ldexp(1, -draw.below(40)), way = std::ldexp(1, -draw.below(40));
        const Vec3f at{static_cast<float>(draw.number()), static_cast<float>(draw.number()),
                       static_cast<float>(draw.number())};
        const auto offset = [&](double by) {
            return Vec3f{static_cast<float>(by * (draw.number() - 0.5)), static_cast<float>(by * (draw.number() - 0.5)),
                         static_cast<float>(by * (draw.number() - 0.5))};
        };
        Vec3f start[3], end[3];
        for (int k = 0; k < 3; ++k) {
            start[k] = 0.5f * at + offset(size);
            end[k] = start[k] + offset(way);
        }
        const Inflation inflation{draw.below(2) ? 0 : static_cast<float>(std::ldexp(draw.number(), -draw.below(30))),
                                  draw.below(2) ? 0 : static_cast<float>(std::ldexp(draw.number(), draw.below(20)))};
        const Ball ball = swept_ball(start, end, inflation);
        const auto value = [](const Vec3f& p) { return Vec3<Rational>{Rational(p.x), Rational(p.y), Rational(p.z)}; };
        const Vec3<Rational> centre = value({ball.x, ball.y, ball.z});
        Rational longest = 0;
        for (int k = 0; k < 3; ++k) longest = std::max(longest, squared(value(end[k]) - value(start[k])));
        // The radius must be at least the distance |p - c| of a corner p from the centre c, plus the inflation: a
        // constant part, and `share` times the longest path `way` of a corner. `beyond`: the radius without the
        // constant part.
        for (int k = 0; k < 3; ++k)
            for (const Vec3f& p : {start[k], end[k]}) {
                const Rational beyond = Rational(ball.r) - Rational(inflation.half);
                const Rational share(inflation.path_share);
                const bool capped = ball.r >= 4;  // so large a ball holds the whole scene
                // |p - c| + share * way <= beyond, without roots: compare squares twice.
                const Rational d2 = squared(value(p) - centre), w2 = share * share * longest;
                const Rational remainder = beyond * beyond - d2 - w2;
                const bool holds = beyond >= 0 && remainder >= 0 && remainder * remainder >= 4 * d2 * w2;
                ASSERT_TRUE(capped || holds) << "step " << i << ", corner " << k;
            }
    }
}

}  // namespace
}  // namespace crumple::test
