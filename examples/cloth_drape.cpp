// A simulation loop that calls Crumple in every step, warm-started: cloth falls on a ball that begins to turn, folds on
// the floor, and never passes through itself or anything else.
//
//   example_cloth_drape [cells [frames [drape.glb]]]
//
// Prints for every step of the solver the number of near pairs of features, the share of the step that is free of
// impacts, the number of points held back to prevent impacts, and the number of pairs of triangles that intersect after
// it. Exits with 1 unless the number of intersecting pairs is always 0. Writes an animation if a file name is given.
// The solver is that of scenes/; scenes/simulation/near_contact.cpp shows how it uses queries about nearness and
// motion.

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <variant>

#include "crumple/crumple.h"
#include "crumple/io.h"
#include "scenes/arithmetic.h"
#include "scenes/simulation/cloth_solver.h"
#include "scenes/soup.h"

using namespace crumple;
using scenes::Fabric;

namespace {

constexpr double frame_time = 1.0 / 30;
constexpr int steps = 2, substeps = 15;  // steps per frame, substeps per step
constexpr double width = 4;              // side of the square sheet; the ball has the radius 1
constexpr double start_of_turn = 1.2, turns_a_second = 0.5;

struct Solid {
    std::vector<Vec3d> points;
    std::vector<Fabric::Corners> triangles;
};

Solid make_ball(double height) {
    scenes::Soup soup;
    scenes::add_uv_sphere(soup, 32, 24, {.origin = {0, 0, height}});
    const io::TriangleMesh mesh = soup.take();
    const auto& xyz = std::get<std::vector<float>>(mesh.vertices);
    const auto& corners = mesh.triangles;
    Solid ball;
    for (std::size_t i = 0; i < xyz.size(); i += 3) ball.points.push_back({xyz[i], xyz[i + 1], xyz[i + 2]});
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        ball.triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    }
    return ball;
}

Solid make_floor() {
    constexpr double half = 4;
    return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// Scene of cloth, ball and floor. The solver holds the points of all three, one after another.
class Drape {
   public:
    explicit Drape(int cells) : fabric_(weave(cells)), ball_(make_ball(1.05)), solver_(fabric_, properties()) {
        for (std::size_t i = 0; i < fabric_.flat.size(); ++i) {
            solver_.points[i] = {fabric_.flat[i][0], fabric_.flat[i][1], 2.1 + fabric_.spacing};
        }
        add(fabric_.triangles, 0);
        add_obstacle(ball_, 1);
        add_obstacle(make_floor(), 2);
    }

    template <class Watch>
    void advance(int frame, Watch watch) {
        solver_.advance_freely((frame - 1) * frame_time, frame_time, steps, substeps,
                               [&](double time, std::span<Vec3d> obstacles) { turn_ball(time, obstacles); }, watch);
    }

    /// Returns a view of the solver's own array: nothing is copied, and nothing is registered with the detector.
    MeshView view() const {
        return {&solver_.points[0].x, static_cast<std::int64_t>(solver_.points.size()), triangles_[0].data(),
                static_cast<std::int64_t>(triangles_.size()), groups_};
    }

    /// Returns a copy of the mesh, for the animation.
    io::TriangleMesh mesh() const {
        std::vector<double> xyz;
        for (const Vec3d& p : solver_.points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
        std::vector<std::int32_t> corners;
        for (const auto& t : triangles_) corners.insert(corners.end(), t.begin(), t.end());
        return {xyz, corners, groups_};
    }

   private:
    static Fabric weave(int cells) {
        scenes::Random random(1);
        return scenes::weave(cells, cells, width / cells, random);
    }

    scenes::ClothProperties properties() const {
        scenes::ClothProperties properties;
        properties.shear_speed = 6;
        properties.bend_speed = 2;
        properties.thickness = 0.4 * fabric_.spacing;
        properties.separation_speed = 0.3;
        return properties;
    }

    void add_obstacle(const Solid& solid, std::int32_t group) {
        const auto first = static_cast<std::int32_t>(solver_.points.size());
        solver_.add_obstacle(solid.points, solid.triangles, 0.4);
        std::vector<Fabric::Corners> triangles;
        for (const auto& [a, b, c] : solid.triangles) triangles.push_back({first + a, first + b, first + c});
        add(triangles, group);
    }

    void add(const std::vector<Fabric::Corners>& triangles, std::int32_t group) {
        triangles_.insert(triangles_.end(), triangles.begin(), triangles.end());
        groups_.resize(triangles_.size(), group);
    }

    void turn_ball(double time, std::span<Vec3d> obstacles) const {
        const double turns = turns_a_second * std::max(0.0, time - start_of_turn);
        const double c = scenes::cosine(turns), s = scenes::sine(turns);
        for (std::size_t i = 0; i < ball_.points.size(); ++i) {
            const Vec3d p = ball_.points[i];
            obstacles[i] = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        }
    }

    Fabric fabric_;
    Solid ball_;
    scenes::ClothSolver solver_;
    std::vector<Fabric::Corners> triangles_;
    std::vector<std::int32_t> groups_;
};

/// Runs the simulation and returns the number of intersecting pairs of triangles, over all steps.
std::size_t run(int cells, int frames, const std::string& output) {
    Drape drape(cells);

    // One detector for the whole simulation. It keeps its buffers and its cluster centres from call to call, so after
    // the first frame it allocates next to nothing and starts from the last frame's clusters.
    Detector detector;
    std::optional<io::ColouredAnimation> animation;
    if (!output.empty()) animation.emplace(1 / frame_time);

    std::printf("frame  contacts  free share  held back  colliding pairs       ms\n");
    std::size_t intersecting = 0;
    for (int frame = 1; frame <= frames; ++frame) {
        drape.advance(frame, [&](const scenes::StepLength& step) {
            // The result belongs to the detector and is valid until its next call.
            const Intersections& found = detector.find(drape.view());
            std::printf("%5d  %8zu  %10.4f  %9zu  %15zu  %7.2f\n", frame, step.contacts, step.toi, step.held_back,
                        found.pairs.size(), found.statistics.milliseconds);
            intersecting += found.pairs.size();
        });
        if (animation) animation->add(drape.mesh(), nullptr, detector.find(drape.view()));
    }
    if (animation) animation->write(output);
    return intersecting;
}

}  // namespace

int main(int argc, char** argv) {
    const int cells = argc > 1 ? std::atoi(argv[1]) : 40, frames = argc > 2 ? std::atoi(argv[2]) : 60;
    if (cells < 2 || cells > 2000 || frames < 1) {
        std::fprintf(stderr, "usage: %s [cells [frames [drape.glb]]]\n", argv[0]);
        return 2;
    }
    try {
        return run(cells, frames, argc > 3 ? argv[3] : "") == 0 ? 0 : 1;
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
