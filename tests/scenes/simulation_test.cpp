// Checks the promises of the cloth simulation: of the solver, the cut, the contacts and the cache.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>

#include "crumple/crumple.h"
#include "rounds.h"
#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/scenes.h"
#include "scenes/simulation/cut.h"
#include "scenes/simulation/self_contact.h"
#include "scenes/simulation/simulated_frames.h"

namespace crumple::scenes {
namespace {

namespace fs = std::filesystem;

Fabric square(int cells, double spacing = 1) {
    Random random(3);
    return weave(cells, cells, spacing, random);
}

std::vector<Vec3d> level(const Fabric& fabric, double height) {
    std::vector<Vec3d> points;
    for (const auto& [u, v] : fabric.flat) points.push_back({u, v, height});
    return points;
}

double area(const Fabric& fabric) {
    double sum = 0;
    for (const auto& [a, b, c] : fabric.triangles) {
        const auto* const flat = fabric.flat.data();
        const auto &p = flat[a], &q = flat[b], &r = flat[c];
        const double twice = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        EXPECT_GT(twice, 0) << "triangle " << a << ", " << b << ", " << c;
        sum += twice / 2;
    }
    return sum;
}

int components(const Fabric& fabric) {
    std::vector<std::int32_t> sets(fabric.flat.size());
    std::iota(sets.begin(), sets.end(), 0);
    std::int32_t* const root = sets.data();
    const auto find = [&](std::int32_t i) {
        while (root[i] != i) i = root[i] = root[root[i]];
        return i;
    };
    for (const auto& t : fabric.triangles) {
        for (const std::int32_t corner : t) root[find(corner)] = find(t[0]);
    }
    std::set<std::int32_t> used;
    for (const auto& t : fabric.triangles) used.insert(find(t[0]));
    return static_cast<int>(used.size());
}

double wave(double u) { return 0.37 + 0.8 * sine(u / 7); }

TEST(Cut, keeps_the_area_and_orientation) {
    const Fabric whole = square(12);
    for (const double tip : {-5.0, -0.3, 4.1, 7.0}) {
        const Cut one{wave, -7, tip};
        EXPECT_NEAR(area(cut(whole, std::span(&one, 1)).fabric), area(whole), 1e-9) << tip;
    }
}

TEST(Cut, separates_the_sheet_only_if_it_crosses_it_completely) {
    const Fabric whole = square(12);
    std::size_t last = whole.triangles.size();
    for (const double tip : {-5.0, -2.0, 0.0, 5.0}) {
        const Cut one{wave, -7, tip};
        const Fabric fabric = cut(whole, std::span(&one, 1)).fabric;
        EXPECT_EQ(components(fabric), 1) << tip;
        EXPECT_GT(fabric.triangles.size(), last) << tip;
        last = fabric.triangles.size();
    }
    const Cut through{wave, -7, 7};
    EXPECT_EQ(components(cut(whole, std::span(&through, 1)).fabric), 2);
}

TEST(Cut, leaves_no_point_unused_and_no_edge_with_three_triangles) {
    const Cut one{wave, -7, 2.6};
    const Fabric fabric = cut(square(12), std::span(&one, 1)).fabric;
    std::set<std::int32_t> used;
    std::map<std::pair<std::int32_t, std::int32_t>, int> directed;
    for (const auto& t : fabric.triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            used.insert(t[k]);
            EXPECT_EQ(++directed[std::pair(t[k], t[(k + 1) % 3])], 1) << t[k] << ", " << t[(k + 1) % 3];
        }
    }
    EXPECT_EQ(used.size(), fabric.flat.size());
}

TEST(Cut, points_made_by_a_cut_start_at_their_place_in_the_fabric) {
    const Fabric whole = square(8);
    ClothSolver solver(whole, {});
    solver.points = level(whole, 2);
    const std::array cuts{Cut{wave, -5, -1}, Cut{wave, -5, 2}};
    const CutFabric none = cut(whole, {}), some = cut(whole, std::span(cuts.data(), 1)),
                    more = cut(whole, std::span(&cuts[1], 1));
    switch_fabric(solver, none, some);
    switch_fabric(solver, some, more);
    ASSERT_EQ(solver.points.size(), more.fabric.flat.size());
    for (std::size_t i = 0; i < solver.points.size(); ++i) {
        const auto [u, v] = more.fabric.flat[i];
        EXPECT_LT(length(solver.points[i] - Vec3d{u, v, 2}), 1e-12) << i;
    }
}

TEST(SelfContact, has_the_side_distance_and_projection_of_the_point) {
    // A sheet, and a triangle above or below it, whose first corner is close to the sheet.
    Fabric fabric = square(4);
    std::vector<Vec3d> points = level(fabric, 0);
    const auto first = static_cast<std::int32_t>(points.size());
    const auto sheet = fabric.triangles.size();
    fabric.triangles.push_back({first, first + 1, first + 2});
    for (const double height : {0.05, -0.05}) {
        points.resize(static_cast<std::size_t>(first));
        for (const Vec3d p : {Vec3d{0.3, 0.2, height}, {0.9, 0.2, 10 * height}, {0.3, 0.8, 10 * height}})
            points.push_back(p);
        SelfContactFinder finder;
        std::vector<SelfContact> of_corner;
        for (const SelfContact& contact : finder.find(points, fabric.triangles, 0.1)) {
            if (contact.point == first) of_corner.push_back(contact);
        }
        ASSERT_EQ(of_corner.size(), 1u) << height;
        const SelfContact& contact = of_corner[0];
        EXPECT_EQ(contact.side, height > 0 ? 1 : -1);
        EXPECT_NEAR(contact.distance, 0.05, 1e-12);
        Vec3d meet{};
        for (std::size_t k = 0; k < 3; ++k) {
            meet = meet + contact.weights[k] * points[static_cast<std::size_t>(contact.triangle[k])];
        }
        // Contacts are found by whiskers, thin triangles along the normals of points. The corner's whisker is not
        // vertical, since the corner's triangle is inclined. But `meet`, its projection to the sheet, is vertically
        // below.
        EXPECT_LT(length(meet - Vec3d{0.3, 0.2, 0}), 1e-6);
        EXPECT_TRUE(std::find(fabric.triangles.begin(), fabric.triangles.begin() + static_cast<std::ptrdiff_t>(sheet),
                              contact.triangle) != fabric.triangles.end());
    }
    EXPECT_TRUE(SelfContactFinder().find(level(square(4), 0), square(4).triangles, 0.3).empty());
}

TEST(ClothSolver, falls_freely_under_gravity) {
    const Fabric fabric = square(5);
    ClothProperties properties{.gravity = 10, .drag = 0, .thickness = 0.1};
    ClothSolver solver(fabric, properties);
    solver.points = level(fabric, 0);
    solver.advance(0, 0.5, 1000, 1000, {}, [](double) {});
    for (const Vec3d p : solver.points) EXPECT_NEAR(p.z, -1.25, 0.01);
}

TEST(ClothSolver, held_corner_stays_and_first_row_stretches_by_at_most_a_quarter) {
    const Fabric fabric = square(10, 0.1);
    ClothSolver solver(fabric, {.shear_speed = 3, .bend_speed = 1, .thickness = 0.04});
    solver.points = level(fabric, 0);
    solver.held[0] = 1;
    const Vec3d corner = solver.points[0];
    solver.advance(0, 2, 2400, 10, {}, [](double) {});
    EXPECT_EQ(solver.points[0], corner);
    double lowest = 0;
    for (const Vec3d p : solver.points) lowest = std::min(lowest, p.z);
    EXPECT_LT(lowest, -1);  // it hangs by the corner
    for (std::size_t i = 0; i < 10; ++i) {
        EXPECT_NEAR(length(solver.points[i + 1] - solver.points[i]) / 0.1, 1, 0.25) << "warp " << i;
    }
}

TEST(ClothSolver, keeps_cloth_above_the_floor_and_outside_the_ball) {
    const auto farther = [](std::string_view scene, int frame, const Collider& body) {
        const io::TriangleMesh mesh = make(scene, {.triangles = 1500, .frame = frame});
        const auto& xyz = std::get<std::vector<float>>(mesh.vertices);
        std::set<std::int32_t> cloth;
        for (std::size_t t = 0; t < mesh.groups.size(); ++t) {
            if (mesh.groups[t] != 0) continue;
            for (std::size_t k = 0; k < 3; ++k) cloth.insert(mesh.triangles[3 * t + k]);
        }
        double nearest = 1;
        for (const std::int32_t i : cloth) {
            const float* const p = &xyz[3 * static_cast<std::size_t>(i)];
            nearest = std::min(nearest, body.nearest({p[0], p[1], p[2]}).distance);
        }
        return nearest;
    };
    MovingBall ball;
    ball.centre = {0, 0, 6.5};
    ball.radius = 5;
    for (const int frame : {10, 40, 93}) EXPECT_GT(farther("cloth_on_ball", frame, ball), 0) << frame;
    for (const int frame : {20, 60}) EXPECT_GT(farther("cloth_on_ball", frame, Floor(0)), -1e-6) << frame;
}

TEST(Funnel, gives_distance_and_normal_inside_and_outside) {
    const Funnel funnel({{1, 0.5}, {0.2, 0}, {0.2, -1}}, 0.3);
    EXPECT_NEAR(funnel.nearest({0, 0, -0.5}).distance, 0.2, 1e-12);
    EXPECT_NEAR(funnel.nearest({0.15, 0, -0.5}).distance, 0.05, 1e-12);
    EXPECT_LT(length(funnel.nearest({0.15, 0, -0.5}).normal - Vec3d{-1, 0, 0}), 1e-12);
    EXPECT_NEAR(funnel.nearest({0, 0.25, -0.5}).distance, -0.05, 1e-12);
    EXPECT_LT(length(funnel.nearest({0, 0.25, -0.5}).normal - Vec3d{0, -1, 0}), 1e-12);
    EXPECT_GT(funnel.nearest({0.6, 0, 0.5}).normal.z, 0.5);
    EXPECT_TRUE(std::isinf(funnel.nearest({0.6, 0, -0.5}).distance));  // a point behind the funnel
    EXPECT_GT(funnel.nearest({0.1, 0, -1.2}).distance, 0.2);           // a point below its spout
}

TEST(ClothOnBall, pairs_more_than_double_from_frame_60_to_93) {
    if (sanitized) GTEST_SKIP() << "what a scene is like is no matter of memory";
    SimulatedFrames frames(simulate_cloth_on_ball({.triangles = 24'000}), "");
    Detector detector;
    std::map<int, std::size_t> pairs;
    for (const int frame : {0, 20, 60, 93}) pairs[frame] = detector.find(frames.frame(frame, {}).view()).pairs.size();
    EXPECT_EQ(pairs[0], 0u);
    EXPECT_LE(pairs[20], 20u);
    EXPECT_GT(pairs[93], 2 * pairs[60]);
}

TEST(Cutting, warm_detector_stays_exact_as_topology_changes) {
    Animation animation("cutting", {.triangles = 400});
    Detector warm({.backend = Backend::cpu}), reference({.backend = Backend::reference});
    std::set<std::int64_t> counts;
    std::int64_t last = 0;
    for (int frame = 0; frame < animation.description().frames; ++frame) {
        const io::TriangleMesh mesh = animation.frame(frame);
        EXPECT_GE(mesh.triangle_count(), last);
        last = mesh.triangle_count();
        counts.insert(last);
        const Intersections& found = warm.find(mesh.view());
        if (frame % 5) continue;
        const Intersections& expected = reference.find(mesh.view());
        EXPECT_TRUE(std::equal(found.pairs.begin(), found.pairs.end(), expected.pairs.begin(), expected.pairs.end()))
            << "frame " << frame;
    }
    EXPECT_GT(counts.size(), 15u);
}

/// Fixture with a cache of its own.
class SimulationCache : public testing::Test {
   protected:
    SimulationCache() {
        std::string name = (fs::temp_directory_path() / "crumple-cache-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        folder_ = name;
        setenv("XDG_CACHE_HOME", name.c_str(), 1);
    }
    ~SimulationCache() override { fs::remove_all(folder_); }

    static SimulatedFrames frames(const std::string& key) { return {simulate_cutting({.triangles = 300}), key}; }
    fs::path file(const char* name) const { return folder_ / "crumple" / "sheet" / name; }

    static std::vector<float> points(const io::TriangleMesh& mesh) {
        return std::get<std::vector<float>>(mesh.vertices);
    }
    static std::vector<float> expected(int frame) { return points(SimulatedFrames(frames("")).frame(frame, {})); }

    /// Returns a frame, and how many had to be simulated for it.
    std::pair<std::vector<float>, int> request(int frame) const {
        int simulated = 0;
        SimulatedFrames cached_frames = frames("sheet");
        return {points(cached_frames.frame(frame, [&](int) { ++simulated; })), simulated};
    }

    fs::path folder_;
};

TEST_F(SimulationCache, frames_are_simulated_once) {
    EXPECT_EQ(request(30), std::pair(expected(30), 30));
    EXPECT_EQ(request(30), std::pair(expected(30), 0));
    EXPECT_EQ(request(12), std::pair(expected(12), 0));
}

TEST_F(SimulationCache, simulation_resumes_from_the_last_frame_bit_by_bit) {
    request(30);
    EXPECT_EQ(request(45), std::pair(expected(45), 15));
}

TEST_F(SimulationCache, damaged_frames_are_simulated_again) {
    request(20);
    for (const char* name : {"frame20", "state"}) {
        std::fstream damaged(file(name), std::ios::binary | std::ios::in | std::ios::out);
        damaged.seekp(100);
        damaged.put('x');
    }
    EXPECT_EQ(request(20), std::pair(expected(20), 20));
    fs::resize_file(file("frame20"), 50);
    EXPECT_EQ(request(20), std::pair(expected(20), 0 /* from the state */));
    fs::remove(file("frame7"));
    EXPECT_EQ(request(7), std::pair(expected(7), 7));
}

TEST_F(SimulationCache, frames_do_not_need_a_writable_cache) {
    setenv("XDG_CACHE_HOME", "/dev/null", 1);
    EXPECT_EQ(request(5), std::pair(expected(5), 5));
}

}  // namespace
}  // namespace crumple::scenes
