// Tumbling bodies, convex (balls, boxes) and not (rings), of about 320 triangles each; each body is a group. They drift
// through a cube with periodic boundaries, and pass through each other; at any time most of them meet one or two
// others.

#include <algorithm>

#include "scenes/list.h"
#include "scenes/random.h"
#include "scenes/soup.h"
#include "scenes/tumbling.h"

namespace crumple::scenes {
io::TriangleMesh make_bodies(const Parameters& parameters) {
    const auto count = static_cast<int>(std::max<std::int64_t>(2, (parameters.triangles + 156) / 313));
    double cells = 1;  // bodies along one edge of the cube
    while (cells * cells * cells < count) ++cells;
    const double width = 3 * cells;

    Soup soup;
    for (int body = 0; body < count; ++body) {
        Random random(parameters.seed ^ mix(static_cast<std::uint64_t>(body)));
        const ScaledPose pose = tumbling(random, width, parameters.frame);
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
