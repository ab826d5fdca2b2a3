// Tumbling bodies, convex (balls, boxes) and not (rings), about 320 triangles each, every one a group of its own. They
// drift through a cube that wraps around and pass through each other; at any time most meet one or two others.

#include <algorithm>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/random.h"
#include "scenes/soup.h"

namespace crumple::scenes {
namespace {

/// Rotation by `turns` about a unit vector.
std::array<Vec3d, 3> rotation(Vec3d axis, double turns) {
    const double c = cosine(turns), s = sine(turns);
    const auto rotate = [&](Vec3d p) { return c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis; };
    return {rotate({1, 0, 0}), rotate({0, 1, 0}), rotate({0, 0, 1})};
}

}  // namespace

io::TriangleMesh make_bodies(const Parameters& parameters) {
    const auto count = static_cast<int>(std::max<std::int64_t>(2, (parameters.triangles + 156) / 313));
    double cells = 1;  // bodies along one edge of the cube
    while (cells * cells * cells < count) ++cells;
    const double width = 3 * cells;

    Soup soup;
    for (int body = 0; body < count; ++body) {
        Random random(parameters.seed ^ mix(static_cast<std::uint64_t>(body)));
        const Vec3d start = random.in_cube(0, width), velocity = random.in_cube(-0.05, 0.05), axis = random.direction();
        const double time = parameters.frame, spin = random.uniform(-0.01, 0.01),
                     turns = random.uniform() + spin * time;
        Pose pose{.axes = rotation(axis, turns), .scale = random.uniform(0.7, 1.3)};
        for (int k = 0; k < 3; ++k) {
            const double x = start[k] + time * velocity[k];
            pose.origin[k] = x - width * std::floor(x / width);
        }
        switch (random.integer(3)) {
            case 0:
                add_icosphere(soup, 4, pose);
                break;
            case 1:
                add_box(soup, 5, random.in_cube(0.4, 0.9), pose);
                break;
            default:
                add_torus(soup, 20, 8, 0.35, pose);
                break;
        }
        soup.group(body);
    }
    return soup.take();
}

}  // namespace crumple::scenes
