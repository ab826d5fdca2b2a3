// Funnel: a square sheet falls into a funnel and slides a little; a ball that grows comes down and pushes it through
// the spout, crumpled. Modelled on the UNC benchmark of that name ([MZ] fig. 5): the same frames and numbers of
// triangles.

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/soup.h"

namespace crumple::scenes {
namespace {

constexpr double frame_time = 0.01;
constexpr int steps = 20, contact_interval = 10;  // steps per frame; steps per search for contacts
constexpr double cloth_share = 0.7824;
constexpr double sheet_height = 0.9, ground = -1.5;

/// Returns a profile of rim, cone, rounded neck and slightly narrowing spout, in `rings` circles.
Funnel::Profile profile_of(int rings) {
    constexpr double rim = 0.75, neck = 0.16, throat = 0.085, spout = 0.075;
    constexpr double rim_height = 0.17, neck_height = 0.03, throat_height = -0.1, end = -0.55;
    Funnel::Profile profile;
    for (int i = 0; i < rings; ++i) {
        const double t = 3.0 * i / (rings - 1);  // one unit each for cone, neck and spout
        if (t <= 1) {
            profile.push_back({rim + t * (neck - rim), rim_height + t * (neck_height - rim_height)});
        } else if (t < 2) {
            const double turn = (t - 1) / 4;
            profile.push_back(
                {neck + (throat - neck) * sine(turn), throat_height + (neck_height - throat_height) * cosine(turn)});
        } else {
            profile.push_back({throat + (t - 2) * (spout - throat), throat_height + (t - 2) * (end - throat_height)});
        }
    }
    return profile;
}

class ClothInFunnel : public Simulation {
   public:
    explicit ClothInFunnel(const Parameters& parameters) {
        const auto triangles = static_cast<double>(parameters.triangles);
        const auto scaled = [&](double number, int least) {
            return std::max(least, static_cast<int>(std::lround(number * std::sqrt(triangles / 18'470))));
        };
        around_ = scaled(40, 8);
        profile_ = profile_of(scaled(26, 9) + 1);
        slices_ = scaled(30, 6);
        tiles_ = scaled(10, 1);
        const int cells = cells_of_square(triangles * cloth_share);
        Random random(mix(parameters.seed));
        fabric_ = weave(cells, cells, 1.0 / cells, random);
    }

    Fabric fabric(int) const override { return fabric_; }

    ClothSolver begin() const override {
        const double h = fabric_.spacing;
        ClothProperties p;
        p.gravity = 4;
        p.drag = 3;
        p.shear_speed = 2;
        p.bend_speed = 0.75;
        p.thickness = 0.4 * h;
        p.clearance = 0.35 * h;
        p.separation_speed = 0.1;
        p.self_friction = 0.2;
        ClothSolver solver(fabric_, p);
        for (std::size_t i = 0; i < fabric_.flat.size(); ++i) {
            solver.points[i] = {fabric_.flat[i][0], fabric_.flat[i][1], sheet_height};
        }
        return solver;
    }

    void advance(ClothSolver& solver, int frame) const override {
        Funnel funnel(profile_, 3 * fabric_.spacing);
        funnel.friction = 0.2;
        MovingBall ball;
        ball.friction = 0.4;
        Floor floor(ground);
        const std::array<const Collider*, 3> bodies{&ball, &funnel, &floor};
        solver.advance((frame - 1) * frame_time, frame_time, steps, contact_interval, bodies,
                       [&](double time) { place(ball, time); });
    }

    io::TriangleMesh mesh(int frame, std::span<const float> points) const override {
        Soup soup;
        for (std::size_t i = 0; i < points.size(); i += 3) soup.vertex({points[i], points[i + 1], points[i + 2]});
        for (const Fabric::Corners& corners : fabric_.triangles) soup.triangle(corners);
        soup.group(0);
        add_funnel(soup);
        soup.group(1);
        MovingBall ball;
        place(ball, frame * frame_time);
        add_uv_sphere(soup, slices_, slices_, {.origin = ball.centre, .scale = ball.radius});
        soup.group(2);
        add_ground(soup);
        soup.group(3);
        return soup.take();
    }

   private:
    /// Places the ball, which comes down evenly and reaches the neck at frame 345.
    static void place(MovingBall& ball, double time) {
        constexpr double speed = 0.42, neck = -0.1, smallest = 0.03, growth = 0.005;
        ball.centre = {0, 0, neck + speed * (345 * frame_time - time)};
        ball.velocity = {0, 0, -speed};
        ball.growth = growth;
        ball.radius = smallest + growth * time;
    }

    void add_funnel(Soup& soup) const {
        const auto ring_size = static_cast<std::int32_t>(around_);
        std::int32_t ring = 0;
        for (std::size_t j = 0; j < profile_.size(); ++j) {
            const auto [radius, height] = profile_[j];
            for (int i = 0; i < around_; ++i) {
                const double turns = static_cast<double>(i) / around_;
                const std::int32_t id = soup.vertex({radius * cosine(turns), radius * sine(turns), height});
                if (j == 0 && i == 0) ring = id;
            }
        }
        for (std::size_t j = 0; j + 1 < profile_.size(); ++j, ring += ring_size) {
            for (std::int32_t i = 0; i < ring_size; ++i) {
                const std::int32_t next = (i + 1) % ring_size;
                soup.triangle({ring + i, ring + next, ring + ring_size + i});
                soup.triangle({ring + next, ring + ring_size + next, ring + ring_size + i});
            }
        }
    }

    void add_ground(Soup& soup) const {
        constexpr double half = 1.25;
        const auto at = [&](int i) { return half * (2.0 * i / tiles_ - 1); };
        std::int32_t first = -1;
        for (int j = 0; j <= tiles_; ++j) {
            for (int i = 0; i <= tiles_; ++i) {
                const std::int32_t id = soup.vertex({at(i), at(j), ground});
                if (first < 0) first = id;
            }
        }
        for (int j = 0; j < tiles_; ++j) {
            for (int i = 0; i < tiles_; ++i) {
                const std::int32_t a = first + j * (tiles_ + 1) + i, b = a + 1, c = b + tiles_, d = c + 1;
                soup.triangle({a, b, d});
                soup.triangle({a, d, c});
            }
        }
    }

    int around_, slices_, tiles_;
    Funnel::Profile profile_;
    Fabric fabric_;
};

}  // namespace

std::unique_ptr<Simulation> simulate_funnel(const Parameters& parameters) {
    return std::make_unique<ClothInFunnel>(parameters);
}

}  // namespace crumple::scenes
