// Tests of cloth that passes through nothing: contacts from proximity queries, and steps shortened by motion queries.

#include "scenes/simulation/near_contact.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "crumple/crumple.h"
#include "crumple/error.h"
#include "scenes/arithmetic.h"
#include "scenes/simulation/cloth_solver.h"

namespace crumple::scenes {
namespace {

using Triangles = std::vector<Fabric::Corners>;

std::vector<std::uint8_t> none_held(const std::vector<Vec3d>& points) {
    return std::vector<std::uint8_t>(points.size());
}

MeshView view(const std::vector<Vec3d>& points, const Triangles& triangles) {
    return {&points[0].x, static_cast<std::int64_t>(points.size()), triangles[0].data(),
            static_cast<std::int64_t>(triangles.size())};
}

/// A large triangle in the plane z = 0, and one above it, whose lowest corner is point 3, above (0.2, 0.3).
const Triangles two{{0, 1, 2}, {3, 4, 5}};
std::vector<Vec3d> one_above(double height) {
    return {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}, {0.2, 0.3, height}, {0.2, 0.3, height + 1}, {0.4, 0.3, height + 1}};
}

TEST(NearContact, gives_the_shortest_vector_from_face_to_vertex) {
    const std::vector<Vec3d> points = one_above(0.05);
    NearContactFinder finder(two, {});
    const Stencils& found = finder.find(points, 0.1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found.vertices[0], (std::array<std::int32_t, 4>{3, 0, 1, 2}));
    EXPECT_EQ(found.normals[0], (std::array<double, 3>{0, 0, 1}));
    EXPECT_DOUBLE_EQ(found.distance[0], 0.05);
}

TEST(NearContact, gives_the_shortest_vector_between_two_edges) {
    // Two triangles that stand on edge, crosswise, 0.05 apart.
    const std::vector<Vec3d> points{{-1, 0, 0}, {1, 0, 0}, {0, 0, -1}, {0.5, -1, 0.05}, {0.5, 1, 0.05}, {0.5, 0, 1}};
    NearContactFinder finder(two, {});
    const Stencils& found = finder.find(points, 0.1);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found.vertices[0], (std::array<std::int32_t, 4>{0, 1, 3, 4}));
    EXPECT_EQ(found.weights[0], (std::array<double, 4>{0.25, 0.75, -0.5, -0.5}));
    EXPECT_EQ(found.normals[0], (std::array<double, 3>{0, 0, -1}));
    EXPECT_DOUBLE_EQ(found.distance[0], 0.05);
}

TEST(NearContact, is_not_found_between_obstacles) {
    const std::vector<Vec3d> points = one_above(0.05);
    EXPECT_EQ(NearContactFinder(Triangles{two[0]}, Triangles{two[1]}).find(points, 0.1).size(), 1u);
    EXPECT_EQ(NearContactFinder({}, two).find(points, 0.1).size(), 0u);
}

TEST(NearContact, touching_features_without_a_direction_are_an_error) {
    NearContactFinder finder(two, {});
    try {
        finder.find(one_above(0), 0.1);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("points 3, 0, 1 and 2"), std::string::npos) << error.what();
    }
    EXPECT_EQ(finder.find(one_above(0.05), 0.1).size(), 1u);
}

TEST(FreePath, is_the_whole_step_if_nothing_is_met) {
    const std::vector<Vec3d> start = one_above(0.5), end = one_above(0.25);
    std::vector<Vec3d> reached = end;
    const auto way = NearContactFinder(two, {}).shorten(start, reached, none_held(start));
    EXPECT_EQ(way.toi, 1);
    EXPECT_EQ(way.share, 1);
    EXPECT_EQ(reached, end);
}

TEST(FreePath, is_shortened_only_for_points_that_would_collide) {
    // The upper triangle falls through the lower one; a third one falls beside them.
    Triangles triangles = two;
    triangles.push_back({6, 7, 8});
    const auto scene = [&](double height) {
        std::vector<Vec3d> points = one_above(height);
        for (const Vec3d p : {Vec3d{5, 5, height}, {6, 5, height}, {5, 6, height}}) points.push_back(p);
        return points;
    };
    const std::vector<Vec3d> start = scene(0.5), end = scene(-2);
    std::vector<Vec3d> reached = end;
    const auto way = NearContactFinder(triangles, {}).shorten(start, reached, none_held(start));
    EXPECT_NEAR(way.toi, 0.45 / 2.5, 1e-12);  // a tenth of the distance, 0.05, remains
    EXPECT_EQ(way.share, 1);
    Detector reference({.backend = Backend::reference});
    EXPECT_FALSE(reference.any((view(start, triangles)).moving_to(view(reached, triangles).vertices), ImpactQuery()));
    EXPECT_TRUE(reference.any((view(start, triangles)).moving_to(view(end, triangles).vertices), ImpactQuery()));
    EXPECT_GT(reached[3].z, 0);
    EXPECT_LT(reached[3].z, 0.5);
    for (std::size_t i = 6; i < 9; ++i) EXPECT_EQ(reached[i], end[i]) << i;
}

TEST(FreePath, is_shortened_for_all_if_driven_points_would_meet) {
    const std::vector<Vec3d> start = one_above(0.5);
    std::vector<Vec3d> reached = one_above(-0.5);
    const std::vector<std::uint8_t> held(start.size(), 1);
    const auto way = NearContactFinder(two, {}).shorten(start, reached, held);
    EXPECT_NEAR(way.toi, 0.45, 1e-12);
    EXPECT_GT(way.share, 0.44);
    EXPECT_LE(way.share, way.toi);
    EXPECT_NEAR(reached[3].z, 0.05, 1e-4);
    EXPECT_GE(reached[3].z, 0.05);
    for (std::size_t i = 3; i < 6; ++i) EXPECT_NEAR(reached[i].z, start[i].z - way.share, 1e-12) << i;
}

TEST(FreePath, is_shortened_if_the_distance_reaches_a_tenth_at_its_very_end) {
    const std::vector<Vec3d> start = one_above(0.5), end = one_above(0.05);  // ends exactly at a tenth of the distance
    std::vector<Vec3d> reached = end;
    const auto way = NearContactFinder(two, {}).shorten(start, reached, none_held(start));
    EXPECT_EQ(way.toi, 1);
    EXPECT_EQ(way.share, 1);
    EXPECT_GT(reached[3].z, 0.05);
}

TEST(FreePath, holds_back_a_face_that_hits_a_vertex) {
    const std::vector<Vec3d> start = one_above(0.5);
    std::vector<Vec3d> reached = start;
    for (std::size_t i = 0; i < 3; ++i) reached[i].z = 1;
    const auto way = NearContactFinder(two, {}).shorten(start, reached, none_held(start));
    EXPECT_NEAR(way.toi, 0.45, 1e-12);
    EXPECT_EQ(way.share, 1);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(reached[i].z, 0.225, 1e-12);
    EXPECT_EQ(reached[3], start[3]);
}

TEST(FreePath, does_not_run_into_points_that_are_held_back) {
    // The second of three triangles falls on the first and is held back. So the third, which could take its whole step
    // if the second took its own, falls on the second.
    const Triangles three{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    const auto stack = [](double second, double third) {
        std::vector<Vec3d> points;
        for (const double z : {0.0, second, third}) {
            for (const Vec3d p : {Vec3d{-1, -1, z}, {2, -1, z}, {-1, 2, z}}) points.push_back(p);
        }
        return points;
    };
    const std::vector<Vec3d> start = stack(0.5, 3);
    std::vector<Vec3d> reached = stack(-2, 0.35);
    const auto way = NearContactFinder(three, {}).shorten(start, reached, none_held(start));
    EXPECT_NEAR(way.toi, 0.45 / 2.5, 1e-12);
    EXPECT_EQ(way.share, 1);
    Detector reference({.backend = Backend::reference});
    EXPECT_FALSE(reference.any((view(start, three)).moving_to(view(reached, three).vertices), ImpactQuery()));
    EXPECT_GT(reached[6].z, reached[3].z);
    EXPECT_GT(reached[3].z, 0);
}

/// Simulation of a sheet that falls on a pyramid on a floor and folds about it.
class Fall {
   public:
    /// `springs`: scale of the elastic springs; at 0, energy is only potential and kinetic.
    explicit Fall(int cells, double speed = 0, double springs = 1)
        : fabric_(weave(cells)), springs_(springs), solver_(fabric_, properties()) {
        for (std::size_t i = 0; i < fabric_.flat.size(); ++i) {
            solver_.points[i] = {fabric_.flat[i][0] + 0.11, fabric_.flat[i][1] - 0.07, 0.8};
            solver_.velocities[i] = {0, 0, -speed};
        }
        cloth_ = solver_.points.size();
        triangles_ = fabric_.triangles;
        add(std::vector<Vec3d>{{-0.5, -0.4, 0.1}, {0.5, -0.4, 0.1}, {0, 0.5, 0.1}, {0, 0, 0.7}},
            Triangles{{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}});
        add(std::vector<Vec3d>{{-3, -3, 0}, {3, -3, 0}, {0, 4, 0}}, Triangles{{0, 1, 2}});
    }

    template <class Watch>
    void advance(int frame, int steps, int substeps, Watch watch) {
        solver_.advance_freely((frame - 1) / 30.0, 1 / 30.0, steps, substeps, [](double, std::span<Vec3d>) {}, watch);
    }

    MeshView mesh() const { return view(solver_.points, triangles_); }
    const std::vector<Vec3d>& points() const { return solver_.points; }

    /// Returns the mean potential and kinetic energy of a point of the cloth.
    double energy() const {
        double sum = 0;
        for (std::size_t i = 0; i < cloth_; ++i) {
            sum += gravity * solver_.points[i].z + 0.5 * dot(solver_.velocities[i], solver_.velocities[i]);
        }
        return sum / static_cast<double>(cloth_);
    }

   private:
    static constexpr double gravity = 9.81;

    static Fabric weave(int cells) {
        Random random(5);
        return scenes::weave(cells, cells, 2.4 / cells, random);
    }
    ClothProperties properties() const {
        return {.gravity = gravity,
                .shear_speed = springs_ * 5,
                .bend_speed = springs_,
                .thickness = 0.4 * fabric_.spacing,
                .separation_speed = 0.3};
    }
    void add(const std::vector<Vec3d>& points, const Triangles& triangles) {
        const auto first = static_cast<std::int32_t>(solver_.points.size());
        solver_.add_obstacle(points, triangles, 0.3);
        for (const auto& [a, b, c] : triangles) triangles_.push_back({first + a, first + b, first + c});
    }

    Fabric fabric_;
    double springs_;
    ClothSolver solver_;
    std::size_t cloth_ = 0;
    Triangles triangles_;
};

TEST(FreeCloth, falls_on_a_pyramid_without_passing_through_it_or_itself) {
    Fall fall(40);
    Detector detector;
    std::vector<Vec3d> last = fall.points();
    int cut = 0;
    for (int frame = 1; frame <= 30; ++frame) {
        fall.advance(frame, 1, 20, [&](const StepLength& step) {
            EXPECT_GT(step.toi, 0) << "frame " << frame;
            EXPECT_LE(step.toi, 1) << "frame " << frame;
            EXPECT_EQ(step.share, 1) << "frame " << frame;  // no point is driven: only single ones are held back
            EXPECT_EQ(step.held_back > 0, step.toi < 1) << "frame " << frame;
            cut += step.toi < 1;
            const VertexView now = fall.mesh().vertices;
            MeshView before = fall.mesh();
            before.vertices = rows_of_three(&last[0].x, static_cast<std::int64_t>(last.size()));
            EXPECT_FALSE(detector.any(before.moving_to(now), ImpactQuery())) << "frame " << frame;
            EXPECT_FALSE(detector.any(fall.mesh())) << "frame " << frame;
            last = fall.points();
        });
    }
    EXPECT_GT(cut, 0);  // otherwise the test has shown nothing
    EXPECT_TRUE(Detector({.backend = Backend::reference}).find(fall.mesh()).pairs.empty());
}

TEST(FreeCloth, stops_at_an_obstacle_even_at_high_speed) {
    Fall fall(8, 300);  // 10 units per frame; the floor is 0.8 units below
    Detector detector;
    double first = 1;
    for (int frame = 1; frame <= 3; ++frame) {
        fall.advance(frame, 1, 5, [&](const StepLength& step) { first = std::min(first, step.toi); });
        EXPECT_FALSE(detector.any(fall.mesh())) << "frame " << frame;
        for (const Vec3d& p : fall.points()) EXPECT_GE(p.z, 0) << "frame " << frame;
    }
    EXPECT_LT(first, 0.1);
}

TEST(FreeCloth, gains_no_energy) {
    for (const double springs : {0.0, 1.0}) {
        Fall fall(16, 0, springs);
        const double start = fall.energy();
        double last = start;
        for (int frame = 1; frame <= 45; ++frame) {
            fall.advance(frame, 2, 10, [](const StepLength&) {});
            const double most = springs > 0 ? start : last + 1e-5 * start;  // springs return their energy
            EXPECT_LE(fall.energy(), most) << "frame " << frame << ", springs " << springs;
            last = fall.energy();
        }
        EXPECT_LT(last, 0.3 * start) << springs;
    }
}

std::uint64_t bits_after(int frames) {
    Fall fall(12);
    for (int frame = 1; frame <= frames; ++frame) fall.advance(frame, 2, 10, [](const StepLength&) {});
    std::uint64_t hash = 0;
    for (const Vec3d& p : fall.points()) {
        for (int axis = 0; axis < 3; ++axis) hash = mix(hash ^ std::bit_cast<std::uint64_t>(p[axis]));
    }
    return hash;
}

TEST(FreeCloth, has_the_same_bits_in_two_runs) { EXPECT_EQ(bits_after(20), bits_after(20)); }

TEST(FreeCloth, is_carried_by_a_moving_obstacle) {
    // A sheet on a plate that rises by 1 and then moves sideways by 0.5.
    Random random(2);
    const Fabric fabric = weave(6, 6, 0.1, random);
    ClothSolver solver(fabric, {.shear_speed = 3, .bend_speed = 1, .thickness = 0.04, .separation_speed = 0.3});
    for (std::size_t i = 0; i < fabric.flat.size(); ++i) {
        solver.points[i] = {fabric.flat[i][0], fabric.flat[i][1], 0.03};
    }
    const std::vector<Vec3d> plate{{-2, -2, 0}, {2, -2, 0}, {0, 3, 0}};
    solver.add_obstacle(plate, Triangles{{0, 1, 2}}, 0.8);
    const auto place = [&](double time, std::span<Vec3d> at) {
        const Vec3d way = time < 1 ? Vec3d{0, 0, time} : Vec3d{0.5 * (time - 1), 0, 1};
        for (std::size_t i = 0; i < 3; ++i) at[i] = plate[i] + way;
    };
    for (int frame = 0; frame < 60; ++frame) {
        solver.advance_freely(frame / 30.0, 1 / 30.0, 2, 10, place, [](const StepLength&) {});
    }
    EXPECT_LT(length(solver.points.back() - (plate[2] + Vec3d{0.5, 0, 1})), 1e-9);
    Vec3d middle{};
    for (std::size_t i = 0; i < fabric.flat.size(); ++i) {
        EXPECT_GT(solver.points[i].z, 1) << i;
        EXPECT_LT(solver.points[i].z, 1.1) << i;
        middle = middle + (1.0 / static_cast<double>(fabric.flat.size())) * solver.points[i];
    }
    EXPECT_NEAR(middle.x, 0.5, 0.1);
}

TEST(FreeCloth, leaves_a_too_near_obstacle_at_the_separation_speed) {
    Random random(2);
    const Fabric fabric = weave(6, 6, 0.1, random);
    ClothSolver solver(fabric, {.gravity = 0, .drag = 0, .thickness = 0.04, .separation_speed = 0.3});
    for (std::size_t i = 0; i < fabric.flat.size(); ++i) {
        solver.points[i] = {fabric.flat[i][0], fabric.flat[i][1], 0.01};
    }
    solver.add_obstacle(std::vector<Vec3d>{{-2, -2, 0}, {2, -2, 0}, {0, 3, 0}}, Triangles{{0, 1, 2}}, 0.1);
    solver.advance_freely(
        0, 0.01, 1, 10, [](double, std::span<Vec3d>) {}, [](const StepLength&) {});
    for (std::size_t i = 0; i < fabric.flat.size(); ++i) EXPECT_NEAR(solver.points[i].z, 0.01 + 0.003, 1e-9) << i;
}

TEST(FreeCloth, has_no_obstacles_after_a_change_of_fabric) {
    Random random(2);
    const Fabric large = weave(4, 4, 0.1, random), small = weave(2, 2, 0.1, random);
    ClothSolver solver(large, {.thickness = 0.04, .separation_speed = 0.3});
    solver.points.assign(large.flat.size(), {});
    solver.add_obstacle(std::vector<Vec3d>{{-2, -2, 0}, {2, -2, 0}, {0, 3, 0}}, Triangles{{0, 1, 2}}, 0.1);
    solver.set_fabric(small);
    ASSERT_EQ(solver.points.size(), small.flat.size());
    for (std::size_t i = 0; i < small.flat.size(); ++i) solver.points[i] = {small.flat[i][0], small.flat[i][1], 0.01};
    solver.advance_freely(
        0, 0.1, 10, 2, [](double, std::span<Vec3d> at) { EXPECT_TRUE(at.empty()); },
        [](const StepLength& step) { EXPECT_EQ(step.contacts, 0u); });
    for (const Vec3d& p : solver.points) EXPECT_LT(p.z, 0);
}

TEST(FreeCloth, has_the_velocity_of_the_shortened_step) {
    // One triangle moves towards a held one, at a speed of ten times their distance per step. It stops at about half of
    // the distance.
    Fabric fabric{1, {{-1, -1}, {1, -1}, {0, 1}, {-1, -1}, {1, -1}, {0, 1}}, two};
    ClothSolver solver(fabric, {.gravity = 0, .drag = 0, .thickness = 0.001});
    for (std::size_t i = 0; i < 6; ++i) {
        solver.points[i] = {fabric.flat[i][0], fabric.flat[i][1], i < 3 ? 0 : 0.1};
        solver.held[i] = i < 3;
        if (i >= 3) solver.velocities[i] = {0, 0, -1};
    }
    StepLength taken{};
    solver.advance_freely(
        0, 1, 1, 1, [](double, std::span<Vec3d>) {}, [&](const StepLength& step) { taken = step; });
    EXPECT_NEAR(taken.toi, 0.09, 1e-9);
    EXPECT_EQ(taken.held_back, 3u);
    for (std::size_t i = 3; i < 6; ++i) {
        EXPECT_NEAR(solver.points[i].z, 0.1 - 0.045, 1e-9) << i;
        EXPECT_NEAR(solver.velocities[i].z, -0.045, 1e-9) << i;
    }
}

TEST(FreeCloth, is_not_pierced_by_a_driven_spike) {
    // A spike is driven through a sheet whose points are all held: it must stop just before the sheet.
    Random random(2);
    const Fabric fabric = weave(6, 6, 0.1, random);
    ClothSolver solver(fabric, {.shear_speed = 3, .bend_speed = 1, .thickness = 0.04, .separation_speed = 0.3});
    for (std::size_t i = 0; i < fabric.flat.size(); ++i) {
        solver.points[i] = {fabric.flat[i][0], fabric.flat[i][1], 0};
        solver.held[i] = 1;
    }
    const std::vector<Vec3d> spike{{0.02, 0.01, 0.1}, {-0.03, 0.05, 1}, {0.04, -0.02, 1}};
    solver.add_obstacle(spike, Triangles{{0, 1, 2}}, 0.1);
    double share = 1;
    const auto place = [&](double time, std::span<Vec3d> at) {
        for (std::size_t i = 0; i < 3; ++i) at[i] = spike[i] - Vec3d{0, 0, time};
    };
    for (int frame = 0; frame < 8; ++frame) {
        solver.advance_freely(frame / 30.0, 1 / 30.0, 1, 5, place,
                              [&](const StepLength& step) { share = std::min(share, step.share); });
    }
    EXPECT_GT(share, 0);
    EXPECT_LT(share, 1);
    EXPECT_GT(solver.points[fabric.flat.size()].z, 0);
    EXPECT_LT(solver.points[fabric.flat.size()].z, 0.01);
}

}  // namespace
}  // namespace crumple::scenes
