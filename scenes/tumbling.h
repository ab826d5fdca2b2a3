#pragma once

// Poses of rigid bodies that drift through a cube with periodic boundaries, and turn at constant speed.

#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/random.h"
#include "scenes/soup.h"

namespace crumple::scenes {

/// Returns the images of the x, y and z axes under a rotation by `turns` about the unit vector `axis`.
inline std::array<Vec3d, 3> rotation(Vec3d axis, double turns) {
    const double c = cosine(turns), s = sine(turns);
    const auto rotate = [&](Vec3d p) { return c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis; };
    return {rotate({1, 0, 0}), rotate({0, 1, 0}), rotate({0, 0, 1})};
}

/// Returns the pose of a body at a frame. The next numbers of `random` determine the body's initial position and
/// orientation, its velocity, spin and scale (0.7 to 1.3). `width`: length of the cube's edges.
inline ScaledPose tumbling(Random& random, double width, int frame) {
    const Vec3d start = random.in_cube(0, width), velocity = random.in_cube(-0.05, 0.05), axis = random.direction();
    const double time = frame, spin = random.uniform(-0.01, 0.01), turns = random.uniform() + spin * time;
    ScaledPose pose{.axes = rotation(axis, turns), .scale = random.uniform(0.7, 1.3)};
    for (int k = 0; k < 3; ++k) {
        const double x = start[k] + time * velocity[k];
        pose.origin[k] = x - width * std::floor(x / width);
    }
    return pose;
}

}  // namespace crumple::scenes
