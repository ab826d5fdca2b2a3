// A thousand small worlds in the same place, searched in one call: bodies of different worlds never collide. Each world
// has five rings in a box, as in a simulator that tries many initial states at once.

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "crumple/crumple.h"

namespace {

struct Mesh {
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::int32_t, 3>> triangles;
};

Mesh ring(double radius, double thickness) {
    constexpr std::int32_t around = 24, across = 12;
    Mesh mesh;
    for (std::int32_t i = 0; i < around; ++i)
        for (std::int32_t j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
            const double out = radius + thickness * std::cos(b);
            mesh.vertices.push_back({static_cast<float>(out * std::cos(a)), static_cast<float>(out * std::sin(a)),
                                     static_cast<float>(thickness * std::sin(b))});
            const auto at = [](std::int32_t u, std::int32_t v) { return across * (u % around) + v % across; };
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

/// Returns a random pose: turned about x, then about z, and moved to a place in a box.
crumple::Pose random_pose(std::mt19937& random, double side) {
    const auto number = [&](double most) { return most * static_cast<double>(random()) * 0x1p-32; };
    const double a = number(2 * std::numbers::pi), b = number(2 * std::numbers::pi);
    const double ca = std::cos(a), sa = std::sin(a), cb = std::cos(b), sb = std::sin(b);
    const double x = number(side), y = number(side), z = number(side);
    return {{cb, -sb * ca, sb * sa, x, sb, cb * ca, -cb * sa, y, 0, sa, ca, z}};
}

}  // namespace

int main() {
    constexpr std::int32_t worlds = 1000, rings = 5;
    const Mesh mesh = ring(0.8, 0.2);
    // The shape has a name (1), so the detector reads it once, and caches what it computes from it.
    const std::vector<crumple::Shape> shapes{crumple::Shape({mesh.vertices, mesh.triangles}, 1)};
    std::vector<crumple::Body> bodies;
    std::vector<crumple::Pose> poses;
    std::mt19937 random(1);
    for (std::int32_t world = 0; world < worlds; ++world)
        for (std::int32_t i = 0; i < rings; ++i) {
            bodies.push_back({.shape = 0, .world = world});
            poses.push_back(random_pose(random, 3.5));
        }

    crumple::Detector detector;
    const crumple::Intersections& any =
        detector.find(crumple::World{shapes, bodies, poses}, {.output = crumple::Output::any_by_world});
    int collide = 0;
    for (const std::uint8_t hit : any.world_hit) collide += hit;
    std::printf("%zu bodies in %d worlds: something collides in %d of them\n", bodies.size(), worlds, collide);

    const crumple::Intersections& met =
        detector.find(crumple::World{shapes, bodies, poses}, {.output = crumple::Output::body_pairs});
    std::vector<int> pairs(worlds, 0);
    for (const crumple::BodyPair& pair : met.bodies)
        ++pairs[static_cast<std::size_t>(bodies[static_cast<std::size_t>(pair.first)].world)];
    std::map<int, int> times;
    int with_pairs = 0;
    for (const int count : pairs) {
        ++times[count];
        with_pairs += count > 0;
    }
    for (const auto& [count, how_often] : times) std::printf("%3d pairs of rings in %4d worlds\n", count, how_often);
    return with_pairs == collide ? 0 : 1;
}
