// A robot arm among posts: checks many configurations in one call, and counts the configurations that are free of
// collisions. Adjacent links of the arm may touch.
//
// The links of configuration c are bodies of world c; posts are in all worlds (-1). Shapes have names, so the detector
// reads them once, and caches what it computes from them.

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "crumple/crumple.h"

namespace {

struct Mesh {
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

/// Returns a closed tube along z from 0 to `length`.
Mesh tube(double radius, double length) {
    constexpr std::int32_t sides = 24;
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, length}};
    for (std::int32_t i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides, x = radius * std::cos(angle),
                     y = radius * std::sin(angle);
        mesh.vertices.push_back({x, y, 0});
        mesh.vertices.push_back({x, y, length});
        const std::int32_t a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % sides);
        for (const auto& t : {std::array{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}})
            mesh.triangles.push_back(t);
    }
    return mesh;
}

/// Returns the pose `before`, moved by `along` in its z direction, then turned about z by `a` and about the new y by
/// `b`.
crumple::Pose joint(const crumple::Pose& before, double a, double b, double along) {
    const std::array<double, 12> step{std::cos(a) * std::cos(b),
                                      -std::sin(a),
                                      std::cos(a) * std::sin(b),
                                      0,
                                      std::sin(a) * std::cos(b),
                                      std::cos(a),
                                      std::sin(a) * std::sin(b),
                                      0,
                                      -std::sin(b),
                                      0,
                                      std::cos(b),
                                      0};
    crumple::Pose after;
    for (std::size_t i = 0; i < 3; ++i) {
        const double* const row = &before.rows[4 * i];
        for (std::size_t j = 0; j < 3; ++j)
            after.rows[4 * i + j] = row[0] * step[j] + row[1] * step[4 + j] + row[2] * step[8 + j];
        after.rows[4 * i + 3] = row[3] + along * row[2];
    }
    return after;
}

}  // namespace

int main() {
    constexpr std::int32_t links = 4, posts = 5, configurations = 300;
    constexpr double length = 1;
    const Mesh link = tube(0.15, length), post = tube(0.1, 3);
    const std::vector<crumple::Shape> shapes{crumple::Shape({link.vertices, link.triangles}, 1),
                                             crumple::Shape({post.vertices, post.triangles}, 2)};

    std::vector<crumple::Body> bodies;
    std::vector<crumple::Pose> poses;
    crumple::IntersectionQuery question{.output = crumple::Output::any_by_world};
    std::mt19937 random(1);
    const auto angle = [&](double most) { return most * (static_cast<double>(random()) / 0x8000'0000 - 1); };
    for (std::int32_t c = 0; c < configurations; ++c) {
        const double turn = angle(3), tilt = angle(0.5);
        crumple::Pose pose = joint({}, turn, tilt, 0);
        for (std::int32_t i = 0; i < links; ++i) {
            const auto body = static_cast<std::int32_t>(bodies.size());
            // A link begins where the last one ends: these two may touch.
            if (i > 0) question.filter.excluded_bodies.push_back({body - 1, body});
            bodies.push_back({.shape = 0, .world = c});
            poses.push_back(pose);
            pose = joint(pose, 0, angle(1.5), length);
        }
    }
    for (std::int32_t i = 0; i < posts; ++i) {
        const double around = 2 * std::numbers::pi * i / posts;
        bodies.push_back({.shape = 1, .group = 1, .world = -1});
        poses.push_back({{1, 0, 0, 1.5 * std::cos(around), 0, 1, 0, 1.5 * std::sin(around), 0, 0, 1, -0.5}});
    }
    question.filter.excluded_groups = {{1, 1}};  // no pairs of posts

    try {
        crumple::Detector detector;
        const crumple::Intersections& found = detector.find(crumple::World{shapes, bodies, poses}, question);
        int free = 0;
        for (const std::uint8_t hit : found.world_hit) free += hit == 0;
        std::printf("%d of %d configurations are free\n", free, configurations);

        question.output = crumple::Output::body_pairs;
        const auto& [first, second] = detector.find(crumple::World{shapes, bodies, poses}, question).bodies[0];
        std::printf("in configuration %d, link %d hits ", first / links, first % links);
        if (second < links * configurations)
            std::printf("link %d\n", second % links);
        else
            std::printf("post %d\n", second - links * configurations);
        return free > 0 && free < configurations ? 0 : 1;
    } catch (const crumple::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
