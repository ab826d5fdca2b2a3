// Bodies that pass through themselves: tubes along a trefoil knot, which are so thick that they intersect themselves
// where strands of the knot cross. The scene `knots` has many tumbling bodies, convex (balls, boxes) and not (rings,
// knots), of about 480 triangles each; each body is a group. They intersect each other, and knots intersect themselves.
// The scene `model` is one large body, a knot with a wrinkled surface: one connected, closed mesh, like scanned and
// segmented models ([MZ] fig. 3 has some of 200,000 triangles), with few collisions.

#include <algorithm>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/random.h"
#include "scenes/soup.h"
#include "scenes/tumbling.h"

namespace crumple::scenes {
namespace {

/// Radius of the tube. Strands cross at a distance of 2/3 of the knot's scale.
constexpr double tube = 0.35;

/// Adds a closed tube along the trefoil knot (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t) / 3. It has 2 * along *
/// across triangles. `wrinkles`: depth of wrinkles in its surface, as a fraction of the tube's radius.
void add_knot(Soup& soup, int along, int across, double wrinkles, const ScaledPose& pose) {
    std::int32_t first = -1;
    for (int i = 0; i < along; ++i) {
        const double t = static_cast<double>(i) / along;  // turns
        const Vec3d centre{(sine(t) + 2 * sine(2 * t)) / 3, (cosine(t) - 2 * cosine(2 * t)) / 3, -sine(3 * t) / 3};
        const Vec3d tangent =
            normalised({cosine(t) + 4 * cosine(2 * t), 4 * sine(2 * t) - sine(t), -3 * cosine(3 * t)});
        const Vec3d side = normalised(cross(tangent, {0, 0, 1})),
                    up = cross(side, tangent);  // the tangent is nowhere vertical
        for (int j = 0; j < across; ++j) {
            const double a = static_cast<double>(j) / across;
            const double wrinkle = sine(37 * t + 2 * a) * cosine(5 * a - 11 * t);
            const double radius = tube * (1 + wrinkles * wrinkle);
            const Vec3d p = centre + (radius * cosine(a)) * side + (radius * sine(a)) * up;
            const std::int32_t made = soup.vertex(pose(p));
            if (first < 0) first = made;
        }
    }
    for (int i = 0; i < along; ++i) {
        for (int j = 0; j < across; ++j) {
            const auto at = [&](int k, int l) { return first + k % along * across + l % across; };
            soup.triangle({at(i, j), at(i + 1, j), at(i, j + 1)});
            soup.triangle({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
        }
    }
}

}  // namespace

io::TriangleMesh make_model(const Parameters& parameters) {
    constexpr double slenderness = 3.9;  // length of the tube divided by its circumference
    const double half = 0.5 * static_cast<double>(parameters.triangles);
    const int across = std::max(8, static_cast<int>(std::lround(std::sqrt(half / slenderness))));
    const int along = std::max(30, static_cast<int>(std::lround(half / across)));
    Random random(parameters.seed);
    const double turn = random.uniform();  // evaluated first: the order of evaluating arguments is unspecified
    const ScaledPose pose{.axes = rotation(random.direction(), turn)};
    Soup soup;
    soup.reserve(static_cast<std::int64_t>(along) * across, 2LL * along * across);
    add_knot(soup, along, across, 0.12, pose);
    return soup.take();
}

io::TriangleMesh make_knots(const Parameters& parameters) {
    const auto count = static_cast<int>(std::max<std::int64_t>(2, (parameters.triangles + 240) / 480));
    double cells = 1;  // bodies along one edge of the cube
    while (cells * cells * cells < count) ++cells;
    const double width = 3 * cells;
    Soup soup;
    for (int body = 0; body < count; ++body) {
        Random random(parameters.seed ^ mix(static_cast<std::uint64_t>(body)));
        const ScaledPose pose = tumbling(random, width, parameters.frame);
        switch (body % 4) {
            case 0:
                add_knot(soup, 30, 8, 0, pose);
                break;
            case 1:
                add_box(soup, 6, random.in_cube(0.4, 0.9), pose);
                break;
            case 2:
                add_torus(soup, 24, 10, 0.35, pose);
                break;
            default:
                add_icosphere(soup, 5, pose);
                break;
        }
        soup.group(body);
    }
    return soup.take();
}

}  // namespace crumple::scenes
