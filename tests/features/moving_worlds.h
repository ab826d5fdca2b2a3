#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "worlds/random_worlds.h"

namespace crumple::test {

/// Random bodies. Most shapes have positions at the end of the step, and most worlds have poses at the end.
struct MovingWorld {
    std::unique_ptr<RandomWorld> world;
    std::vector<std::vector<std::array<float, 3>>> float_ends;
    std::vector<std::vector<std::array<double, 3>>> double_ends;
    std::vector<Pose> end_poses;

    World view() const { return {world->shapes, world->bodies, world->poses, end_poses}; }
};

inline std::unique_ptr<MovingWorld> moving_world(unsigned seed, const WorldKind& kind) {
    auto moving = std::make_unique<MovingWorld>();
    moving->world = random_world(seed, kind);
    Dice dice(seed + 1000);
    for (Shape& shape : moving->world->shapes) {
        if (dice.chance(0.4)) continue;
        const auto move = [&](const auto& soups, auto& ends) {
            for (const auto& soup : soups) {
                if (soup.view().vertices.data != shape.vertices.data) continue;
                auto end = soup.vertices;
                for (auto& p : end)
                    for (auto& x : p) x += static_cast<std::decay_t<decltype(x)>>(dice.between(-0.3, 0.3));
                ends.push_back(std::move(end));
                shape.end = MeshView(ends.back(), soup.triangles).vertices;
            }
        };
        if (shape.vertices.rows == 0) continue;
        move(moving->world->floats, moving->float_ends);
        move(moving->world->doubles, moving->double_ends);
    }
    if (dice.chance(0.7))
        for (std::size_t b = 0; b < moving->world->bodies.size(); ++b)
            moving->end_poses.push_back(dice.chance(0.3) && !moving->world->poses.empty()
                                            ? moving->world->poses[b]
                                            : random_pose(dice, kind.reach));
    return moving;
}

}  // namespace crumple::test
