#pragma once

// Random worlds of a few small bodies: every kind of pose, pair filter and precision, shapes with and without names.

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "soups.h"

namespace crumple::test {

class Dice {
   public:
    explicit Dice(unsigned seed) : engine_(seed) {}
    double number() { return static_cast<double>(engine_()) * 0x1p-32; }
    double between(double low, double high) { return low + (high - low) * number(); }
    int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
    bool chance(double p) { return number() < p; }

   private:
    std::mt19937 engine_;
};

/// Returns a rotation by a random quaternion, then a translation of at most `extent` along each axis.
inline Pose random_motion(Dice& dice, double extent) {
    double q[4], length = 0;
    for (double& c : q) c = dice.between(-1, 1), length += c * c;
    length = std::sqrt(length) + 1e-9;
    const double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), dice.between(-extent, extent),
             2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), dice.between(-extent, extent),
             2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), dice.between(-extent, extent)}};
}

/// Returns a random pose: mostly a rigid motion; also the identity, a scaled reflection, a singular map to a plane or a
/// point, or a translation by −1, 0 or 1 along each axis.
inline Pose random_pose(Dice& dice, double extent) {
    Pose pose = random_motion(dice, extent);
    switch (dice.below(10)) {
        case 0:
            return {};
        case 1:  // a reflection, and a scale
            for (std::size_t i = 0; i < 12; i += 4)
                for (std::size_t k = 0; k < 3; ++k) pose.rows[i + k] *= i == 0 ? -1.5 : 1.5;
            return pose;
        case 2:  // flattened to a plane, or to a point
            for (std::size_t k = 0; k < (dice.chance(0.3) ? 3u : 1u); ++k)
                for (std::size_t i = 0; i < 12; i += 4) pose.rows[i + k] = 0;
            return pose;
        case 3:  // translated by integers, so that vertices coincide
            pose = {};
            for (std::size_t i = 3; i < 12; i += 4) pose.rows[i] = dice.below(3) - 1;
            return pose;
        default:
            return pose;
    }
}

/// Owner of the arrays of a World.
struct RandomWorld {
    std::vector<Soup<float>> floats;
    std::vector<Soup<double>> doubles;
    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses;

    World view() const { return {shapes, bodies, poses}; }
};

struct WorldKind {
    int shapes = 3, bodies = 6, worlds = 1;
    int triangles = 40;
    double named = 0.5, everywhere = 0.2, reach = 0.6;
    double gaps = 0;  ///< share of worlds without bodies
    bool mixed_precision = true;
};

inline std::unique_ptr<RandomWorld> random_world(unsigned seed, const WorldKind& kind) {
    Dice dice(seed);
    auto world = std::make_unique<RandomWorld>();
    world->floats.reserve(static_cast<std::size_t>(kind.shapes));
    world->doubles.reserve(static_cast<std::size_t>(kind.shapes));
    for (int s = 0; s < kind.shapes; ++s) {
        const int triangles = dice.chance(0.1) ? 0 : 1 + dice.below(kind.triangles);
        const std::uint64_t name = dice.chance(kind.named) ? static_cast<std::uint64_t>(s) + 1 : 0;
        const auto add = [&](auto& soups, auto soup) {
            if (dice.chance(0.3))
                for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(dice.below(3));
            // Makes some triangles degenerate, and lets some share vertices.
            for (auto& t : soup.triangles) {
                if (dice.chance(0.1)) t[1] = t[0];
                if (dice.chance(0.2)) t[2] = dice.below(static_cast<int>(soup.vertices.size()));
            }
            soups.push_back(std::move(soup));
            world->shapes.push_back(Shape(soups.back().view(), name));
        };
        const unsigned inner = seed * 31 + static_cast<unsigned>(s);
        if (kind.mixed_precision && dice.chance(0.4))
            add(world->doubles, random_soup<double>(triangles, 0.4, inner));
        else
            add(world->floats, random_soup<float>(triangles, 0.4, inner));
    }
    std::int32_t in = 0;
    for (int b = 0; b < kind.bodies; ++b) {
        if (in >= 0 && dice.chance(kind.worlds > 1 ? 0.5 : 0) && in + 1 < kind.worlds) ++in;
        while (kind.gaps > 0 && in >= 0 && in + 1 < kind.worlds && dice.chance(kind.gaps)) ++in;
        if (in >= 0 && b >= kind.bodies * (1 - kind.everywhere)) in = -1;
        world->bodies.push_back({dice.below(kind.shapes), dice.below(3), in, dice.chance(0.5)});
        world->poses.push_back(random_pose(dice, kind.reach));
    }
    if (dice.chance(0.1)) world->poses.clear();
    return world;
}

inline IntersectionQuery random_query(unsigned seed, int bodies) {
    Dice dice(seed);
    const auto scope = [&] { return static_cast<PairScope>(dice.chance(0.5) ? 0 : dice.below(3)); };
    IntersectionQuery query;
    constexpr Output outputs[] = {Output::any,   Output::any_by_world, Output::body_pairs,
                                  Output::count, Output::pairs,        Output::contacts};
    query.output = outputs[dice.below(6)];
    query.neighbours = dice.chance(0.2) ? Neighbours::skip : Neighbours::geometric;
    query.kind = dice.chance(0.2) ? IntersectionKind::proper : IntersectionKind::all;
    query.weld = dice.chance(0.3);
    query.index = dice.chance(0.5);
    query.filter.bodies = scope();
    query.filter.groups = scope();
    for (int i = dice.below(3); i > 0 && bodies > 0; --i)
        query.filter.excluded_bodies.push_back({dice.below(bodies), dice.below(bodies)});
    for (int i = dice.below(3); i > 0; --i) query.filter.excluded_groups.push_back({dice.below(3), dice.below(3)});
    return query;
}

}  // namespace crumple::test
