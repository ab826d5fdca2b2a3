// Cloth on Ball: a square sheet falls on a ball that stands on a floor, drapes, and is wound up as the ball begins to
// turn. Modelled on the UNC benchmark of that name ([MZ] fig. 5): the same sizes, frames and numbers of triangles.

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/soup.h"

namespace crumple::scenes {
namespace {

constexpr double width = 38.8, ball_radius = 5, ball_height = 6.5;
constexpr double frame_time = 1.0 / 30;
constexpr int steps = 30, contact_interval = 10;  // steps per frame; steps per search for contacts
constexpr double ball_share = 760.0 / 92'230;

class ClothOnBall : public Simulation {
   public:
    explicit ClothOnBall(const Parameters& parameters) {
        const auto triangles = static_cast<double>(parameters.triangles);
        slices_ = std::max(4, static_cast<int>(std::lround(std::sqrt(0.5 * triangles * ball_share) + 0.5)));
        const int cells = cells_of_square(triangles * (1 - ball_share));
        Random random(mix(parameters.seed));
        fabric_ = weave(cells, cells, width / cells, random);
    }

    Fabric fabric(int) const override { return fabric_; }

    ClothSolver begin() const override {
        const double h = fabric_.spacing;
        ClothProperties p;
        p.gravity = 40;
        p.drag = 0.5;
        p.shear_speed = 40;
        p.bend_speed = 15;
        p.thickness = 0.4 * h;
        p.clearance = 0.4 * h;
        p.separation_speed = 2;
        p.self_friction = 0.3;
        ClothSolver solver(fabric_, p);
        for (std::size_t i = 0; i < fabric_.flat.size(); ++i) {
            const auto [u, v] = fabric_.flat[i];
            solver.points[i] = {u, v, ball_height + ball_radius + 0.4};
        }
        return solver;
    }

    void advance(ClothSolver& solver, int frame) const override {
        MovingBall ball;
        ball.centre = {0, 0, ball_height};
        ball.radius = ball_radius;
        ball.friction = 0.6;
        Floor floor(0);
        floor.friction = 0.3;
        const std::array<const Collider*, 2> bodies{&ball, &floor};
        solver.advance((frame - 1) * frame_time, frame_time, steps, contact_interval, bodies, [&](double time) {
            ball.spin = {0, 0, speed(time)};
        });
    }

    io::TriangleMesh mesh(int frame, std::span<const float> points) const override {
        Soup soup;
        soup.reserve(static_cast<std::int64_t>(points.size() / 3) + slices_ * slices_,
                     static_cast<std::int64_t>(fabric_.triangles.size()) + 2 * slices_ * slices_);
        for (std::size_t i = 0; i < points.size(); i += 3) soup.vertex({points[i], points[i + 1], points[i + 2]});
        for (const Fabric::Corners& corners : fabric_.triangles) soup.triangle(corners);
        soup.group(0);
        const double a = turns(frame * frame_time);
        add_uv_sphere(soup, slices_, slices_,
                      {.axes = {Vec3d{cosine(a), sine(a), 0}, Vec3d{-sine(a), cosine(a), 0}, Vec3d{0, 0, 1}},
                       .origin = {0, 0, ball_height},
                       .scale = ball_radius});
        soup.group(1);
        return soup.take();
    }

   private:
    // The ball stands still until `start`, turns faster and faster until `even`, and then turns at constant speed.
    static constexpr double start = 40 * frame_time, even = 55 * frame_time, top_speed = 3;
    static double speed(double time) { return top_speed * std::clamp((time - start) / (even - start), 0.0, 1.0); }
    static double turns(double time) {
        const double ramp = std::clamp(time - start, 0.0, even - start), rest = std::max(0.0, time - even);
        return top_speed * (0.5 * ramp * ramp / (even - start) + rest) / (2 * pi);
    }

    int slices_;
    Fabric fabric_;
};

}  // namespace

std::unique_ptr<Simulation> simulate_cloth_on_ball(const Parameters& parameters) {
    return std::make_unique<ClothOnBall>(parameters);
}

}  // namespace crumple::scenes
