// Cutting: a sheet hangs from a rod that swings. It is torn from the left and the right side in turn, from the bottom
// to the top, into one long ribbon, which falls on a ball and on the floor. The number of triangles grows from frame to
// frame, which a detector that only updates an existing hierarchy cannot handle ([MZ] sec. 2.1).

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/simulation/cut.h"
#include "scenes/soup.h"

namespace crumple::scenes {
namespace {

constexpr double width = 12, rod_height = 17.5;
constexpr double frame_time = 1.0 / 30;
constexpr int steps = 20, contact_interval = 4;  // steps per frame; steps per search for contacts
constexpr double cloth_share = 0.96;
constexpr int first_cut = 5, frames_of_a_cut = 14;
constexpr double ball_radius = 2.5;

class Cutting : public Simulation {
   public:
    explicit Cutting(const Parameters& parameters) : seed_(mix(parameters.seed)) {
        const auto triangles = static_cast<double>(parameters.triangles);
        cells_ = cells_of_square(triangles * cloth_share);
        slices_ = std::max(4, static_cast<int>(std::lround(std::sqrt(0.5 * triangles * (1 - cloth_share)) + 0.5)));
        cuts_ = std::clamp(cells_ / 4, 1, 6);
        Random random(seed_);
        uncut_ = weave(cells_, cells_, width / cells_, random);
    }

    Fabric fabric(int frame) const override { return cut_at(frame).fabric; }

    ClothSolver begin() const override {
        const double h = uncut_.spacing;
        ClothProperties p;
        p.gravity = 30;
        p.drag = 0.7;
        p.shear_speed = 25;
        p.bend_speed = 8;
        p.thickness = 0.4 * h;
        p.clearance = 0.4 * h;
        p.separation_speed = 1.5;
        p.self_friction = 0.3;
        ClothSolver solver(uncut_, p);
        for (std::size_t i = 0; i < uncut_.flat.size(); ++i) {
            const auto [u, v] = uncut_.flat[i];
            solver.points[i] = {u, 0, rod_height - 0.5 * width + v};
        }
        return solver;
    }

    void advance(ClothSolver& solver, int frame) const override {
        switch_fabric(solver, cut_at(frame - 1), cut_at(frame));
        const auto cells = static_cast<std::size_t>(cells_), top = cells * (cells + 1);
        for (std::size_t i = top; i <= top + cells; ++i) solver.held[i] = 1;
        MovingBall ball;
        ball.centre = {0, 0, ball_radius};
        ball.radius = ball_radius;
        Floor floor(0);
        const std::array<const Collider*, 2> bodies{&ball, &floor};
        solver.advance((frame - 1) * frame_time, frame_time, steps, contact_interval, bodies, [&](double time) {
            constexpr double reach = 2.5, period = 2.2;
            const Vec3d swing{0, reach * 2 * pi / period * cosine(time / period), 0};
            for (std::size_t i = top; i <= top + static_cast<std::size_t>(cells_); ++i) solver.velocities[i] = swing;
        });
    }

    io::TriangleMesh mesh(int frame, std::span<const float> points) const override {
        Soup soup;
        for (std::size_t i = 0; i < points.size(); i += 3) soup.vertex({points[i], points[i + 1], points[i + 2]});
        for (const Fabric::Corners& corners : fabric(frame).triangles) soup.triangle(corners);
        soup.group(0);
        add_uv_sphere(soup, slices_, slices_, {.origin = {0, 0, ball_radius}, .scale = ball_radius});
        soup.group(1);
        return soup.take();
    }

   private:
    /// Returns the fabric at a frame. Cuts follow one after another, from the bottom to the top, from the left and from
    /// the right in turn.
    CutFabric cut_at(int frame) const {
        std::vector<Cut> cuts;
        const double rows = width / (cuts_ + 1);
        for (int k = 0; k < cuts_; ++k) {
            const double done = static_cast<double>(frame - first_cut - k * frames_of_a_cut) / frames_of_a_cut;
            if (done <= 0) break;
            const double level = (k + 1) * rows - 0.5 * width;
            const double from = k % 2 ? 0.5 * width + uncut_.spacing : -0.5 * width - uncut_.spacing;
            const double to = k % 2 ? -0.5 * width + 0.7 * rows : 0.5 * width - 0.7 * rows;
            cuts.push_back({[=, this](double u) {
                                return level +
                                       0.15 * rows * noise(seed_ + static_cast<std::uint64_t>(k), 1.5 * u / rows, 0);
                            },
                            from, from + std::min(1.0, done) * (to - from)});
        }
        return cut(uncut_, cuts);
    }

    std::uint64_t seed_;
    int cells_, slices_, cuts_;
    Fabric uncut_;
};

}  // namespace

std::unique_ptr<Simulation> simulate_cutting(const Parameters& parameters) {
    return std::make_unique<Cutting>(parameters);
}

}  // namespace crumple::scenes
