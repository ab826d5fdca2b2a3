// Counts the checks for cancellation of each query: their number must grow with the work, so that a call of any size
// ends soon after a stop request.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "crumple/crumple.h"
#include "detector/each_check_polls.h"
#include "overlaps/closed_bodies.h"
#include "worlds/random_worlds.h"

namespace crumple::test {
namespace {

/// Scenes of about n triangles: a mesh that moves, two meshes, and worlds of small bodies. Their density does not
/// depend on n.
struct Scenes {
    explicit Scenes(int n)
        : size(4 * std::pow(n, -1.0 / 3)),
          soup(random_soup<double>(n, size)),
          other(random_soup<double>(n / 2, size, 2)),
          end(soup.vertices) {
        Dice dice(1);
        for (auto& p : end)
            for (double& x : p) x += dice.between(-size, size) / 4;
        step = soup.view().moving_to(MeshView(end, soup.triangles).vertices);
        for (int b = 0; b < 3; ++b) {
            small.push_back(random_soup<double>(60, 0.5, static_cast<unsigned>(b)));
            add_box(dice, false, 0.5, closed.emplace_back());
        }
        for (std::size_t b = 0; b < 3; ++b) {
            unnamed.push_back(Shape(small[b].view()));
            named.push_back(Shape(small[b].view(), b + 1));
            boxes.push_back(Shape(closed[b].view()));
        }
        for (int w = 0; w < n / 200; ++w)
            for (int b = 0; b < 3; ++b) {
                bodies.push_back({b, 0, w, false});
                poses.push_back(random_motion(dice, 0.5));
            }
    }
    World of(const std::vector<Shape>& shapes) const { return {shapes, bodies, poses}; }
    World moving(const std::vector<Shape>& shapes) const { return {shapes, bodies, poses, poses}; }

    double size;
    Soup<double> soup, other;
    std::vector<std::array<double, 3>> end;
    MeshView step;
    std::vector<Soup<double>> small, closed;
    std::vector<Shape> unnamed, named, boxes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;
};

struct Call {
    const char* name;
    std::function<void(Detector&, const Scenes&)> run;
};

std::vector<Call> calls() {
    const auto each = Output::any_by_world;
    return {
        {"pairs", [](Detector& d, const Scenes& s) { d.find(s.soup.view()); }},
        {"contacts",
         [](Detector& d, const Scenes& s) { d.find(s.soup.view(), IntersectionQuery{.output = Output::contacts}); }},
        {"two meshes",
         [](Detector& d, const Scenes& s) {
             d.find({s.soup.view(), s.other.view()});
         }},
        {"worlds", [](Detector& d, const Scenes& s) { d.find(s.of(s.unnamed)); }},
        {"flags of named worlds",
         [](Detector& d, const Scenes& s) { d.find(s.of(s.named), IntersectionQuery{.output = each}); }},
        {"impacts",
         [](Detector& d, const Scenes& s) { d.find(s.step, ImpactQuery{.index = true, .triangle_pairs = true}); }},
        {"impacts within a share",
         [](Detector& d, const Scenes& s) { d.find(s.step, ImpactQuery{.min_distance_share = 0.2}); }},
        {"first impact", [](Detector& d, const Scenes& s) { d.find(s.step, FirstImpactQuery()); }},
        {"free step", [](Detector& d, const Scenes& s) { d.find(s.step, FreeStepQuery()); }},
        {"impacts of worlds", [](Detector& d, const Scenes& s) { d.find(s.moving(s.unnamed), ImpactQuery()); }},
        {"flags of impacts of named worlds",
         [](Detector& d, const Scenes& s) { d.find(s.moving(s.named), ImpactQuery{.output = each}); }},
        {"near pairs",
         [](Detector& d, const Scenes& s) { d.find(s.soup.view(), ProximityQuery{.radius = s.size / 8}); }},
        {"details of near pairs",
         [](Detector& d, const Scenes& s) {
             d.find(s.soup.view(), ProximityQuery{.radius = s.size / 8, .closest = true, .least = true, .index = true});
         }},
        {"near pairs without 3 rings",
         [](Detector& d, const Scenes& s) { d.find(s.soup.view(), ProximityQuery{.radius = s.size / 8, .rings = 3}); }},
        {"flags of near pairs of named worlds",
         [](Detector& d, const Scenes& s) { d.find(s.of(s.named), ProximityQuery{.output = each, .radius = 0.01}); }},
        {"candidates",
         [](Detector& d, const Scenes& s) { d.find(s.soup.view(), CandidateQuery{.inflation = s.size / 16}); }},
        {"stream of near pairs",
         [](Detector& d, const Scenes& s) {
             d.stream(
                 s.soup.view(), ProximityQuery{.radius = s.size / 8}, [](const Proximities&) {}, 1000);
         }},
        {"distances", [](Detector& d, const Scenes& s) { d.find(s.of(s.named), DistanceQuery()); }},
        {"clearances",
         [](Detector& d, const Scenes& s) { d.find(s.of(s.unnamed), DistanceQuery{.output = Output::nearest}); }},
        {"overlaps", [](Detector& d, const Scenes& s) { d.find(s.of(s.boxes), OverlapQuery()); }},
    };
}

TEST(Cancellation, number_of_checks_grows_with_the_work_of_each_query) {
    const EachCheckPolls each_check_polls;
    constexpr int n = 2000;
    const Scenes few(n), many(4 * n);
    for (const Call& call : calls()) {
        SCOPED_TRACE(call.name);
        const auto checks = [&](const Scenes& scenes) {
            Detector detector({.threads = 1});
            std::int64_t count = 0;
            detector.set_poll([&] { ++count; });
            call.run(detector, scenes);
            return count;
        };
        const std::int64_t few_checks = checks(few), many_checks = checks(many);
        EXPECT_GE(few_checks, n / 200);
        EXPECT_GE(many_checks, 2 * few_checks);
    }
}

}  // namespace
}  // namespace crumple::test
