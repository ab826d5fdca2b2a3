// Independent random triangles in the unit cube: of equal size (`soup`), long and thin (`needles`), or of all sizes
// (`five_decades`). Their sizes shrink as their number grows, so that the box of a triangle always overlaps about as
// many others: 4 in `soup`, some 15 in the other scenes. In a crumpled cloth the numbers are similar, so costs per
// overlap can be compared.

#include <array>
#include <cmath>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/random.h"
#include "scenes/soup.h"

namespace crumple::scenes {
namespace {

/// Returns the cube root of a number below 1, by Newton's method, because the last bit of std::cbrt may differ between
/// machines.
double cube_root(double x) {
    double r = 1;
    for (int i = 0; i < 100; ++i) r -= (r - x / (r * r)) / 3;
    return r;
}

/// Returns 10 to the power -decades * u with u uniform in [0, 1), to 20 bits of u.
double power_of_tenth(Random& random, int decades) {
    const std::uint64_t u = random.bits() >> 44;
    double power = 1, factor = 1;
    for (int i = 0; i < decades; ++i) factor *= 0.1;
    for (int bit = 19; bit >= 0; --bit) {
        factor = std::sqrt(factor);
        if (u >> bit & 1) power *= factor;
    }
    return power;
}

/// Adds a triangle at a random place and in a random orientation: an equilateral triangle of circumradius `size`,
/// scaled by `width` in one direction.
void add_triangle(Soup& soup, Random& random, double size, double width) {
    const Vec3d centre = random.in_cube(0, 1);
    const Vec3d along = random.direction(), side = random.direction();
    const Vec3d across = normalised(side - dot(side, along) * along);
    const double half_root_3 = 0.8660254037844386;
    soup.triangle(centre + size * along, centre - (0.5 * size) * along + (half_root_3 * width * size) * across,
                  centre - (0.5 * size) * along - (half_root_3 * width * size) * across);
}

template <class Size>
io::TriangleMesh random_triangles(const Parameters& parameters, double width, Size size) {
    Random random(parameters.seed);
    Soup soup;
    soup.reserve(3 * parameters.triangles, parameters.triangles);
    for (std::int64_t i = 0; i < parameters.triangles; ++i) add_triangle(soup, random, size(random), width);
    return soup.take();
}

}  // namespace

io::TriangleMesh make_soup(const Parameters& parameters) {
    const double size = cube_root(0.5 / static_cast<double>(parameters.triangles + 1));
    return random_triangles(parameters, 1, [&](Random&) { return size; });
}

io::TriangleMesh make_needles(const Parameters& parameters) {
    const double size = cube_root(12 / static_cast<double>(parameters.triangles + 12));
    return random_triangles(parameters, 0.01, [&](Random&) { return size; });
}

io::TriangleMesh make_five_decades(const Parameters& parameters) {
    const double size = cube_root(200 / static_cast<double>(parameters.triangles + 200));
    return random_triangles(parameters, 1, [&](Random& random) { return size * power_of_tenth(random, 5); });
}

}  // namespace crumple::scenes
