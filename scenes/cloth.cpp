// A sheet of cloth sinks over a ball, gathers beneath it and crumples until its wrinkles pass through each other: the
// look and the numbers of UNC Cloth on Ball, whose frame 92 has 92,230 triangles in 63,602 colliding pairs.
//
// The sheet is a square grid with jittered vertices and random diagonals, in two steps: the drape, of one form at every
// resolution (scenes/drape.h), then wrinkles laid along the drape's own normal in a belt around the ball. Wrinkles
// measure a fixed number of grid cells, so that pairs per triangle depend little on the resolution (1.4 at 10,000
// triangles, 0.7 at two million), and the ball is cut finer with the sheet.

#include "scenes/cloth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "scenes/arithmetic.h"
#include "scenes/drape.h"
#include "scenes/list.h"
#include "scenes/random.h"

namespace crumple::scenes {
namespace {

constexpr double ball_share = 1.0 / 121;  // of all triangles

// Lengths in grid cells.
constexpr double jitter = 0.2;
constexpr double wavelength = 20, wander = 20;     // of a wrinkle; size of its irregularities
constexpr double rise = 1, swing = 2.3;            // of a wrinkle: height and sideways, in wavelengths / 2 pi
constexpr double crumple_size = 6, crumple = 0.6;  // random dents on top: size and depth

struct Sheet {
    int cells;
    double spacing;
    std::vector<std::array<double, 2>> flat;  // (u, v) of each vertex
    std::vector<Vec3d> draped;

    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(cells + 1) + static_cast<std::size_t>(i);
    }
    Vec3d at(int i, int j) const { return draped[index(std::clamp(i, 0, cells), std::clamp(j, 0, cells))]; }
};

Sheet make_sheet(int cells, double folded, std::uint64_t seed, Random& random) {
    Sheet sheet{cells, 2 * Drape::half_width / cells, {}, {}};
    const Drape drape(folded, 0.02 + 0.5 * sheet.spacing, seed);
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double u = (i - 0.5 * cells + random.uniform(-jitter, jitter)) * sheet.spacing;
            const double v = (j - 0.5 * cells + random.uniform(-jitter, jitter)) * sheet.spacing;
            sheet.flat.push_back({u, v});
            sheet.draped.push_back(drape(u, v));
        }
    }
    return sheet;
}

/// Vertex (i, j) with wrinkles and dents.
Vec3d wrinkled(const Sheet& sheet, int i, int j, double folded, std::uint64_t seed) {
    const double u = sheet.flat[sheet.index(i, j)][0], v = sheet.flat[sheet.index(i, j)][1];
    const double distance = std::sqrt(u * u + v * v), h = sheet.spacing;
    const double belt = smooth_step(5.5, 8.5, distance) * (1 - smooth_step(10, 13, distance));
    const double patches = smooth_step(-0.5, 0.3, noise(seed + 1, u / 4, v / 4));
    const double strength = folded * belt * patches;
    if (strength == 0) return sheet.at(i, j);

    const Vec3d along_u = sheet.at(i + 1, j) - sheet.at(i - 1, j), along_v = sheet.at(i, j + 1) - sheet.at(i, j - 1);
    const Vec3d normal = normalised(cross(along_u, along_v));
    const Vec3d across = normalised(u * along_v - v * along_u);  // around the axis
    const double belt_wrinkles = std::floor(2 * pi * 11 / (wavelength * h) + 0.5);
    const double phase = belt_wrinkles * angle(v, u) + 0.1 * noise(seed + 2, u / (wander * h), v / (wander * h));
    const double unit = strength * wavelength * h / (2 * pi);

    const auto dent = [&](std::uint64_t axis) {
        return noise(seed + 3 + axis, u / (crumple_size * h), v / (crumple_size * h));
    };
    const Vec3d free = sheet.at(i, j) + (unit * rise * (1 - cosine(phase))) * normal +
                       (unit * swing * sine(2 * phase)) * across +
                       (strength * crumple * h) * Vec3d{dent(0), dent(1), dent(2)};
    // What would lie in the ball is pushed out of it.
    const Vec3d from_ball = free - Drape::ball_centre;
    const double nearest = Drape::ball_radius + h;
    return length(from_ball) < nearest ? Drape::ball_centre + nearest * normalised(from_ball) : free;
}

}  // namespace

void add_cloth(Soup& soup, const Parameters& parameters) {
    const auto triangles = static_cast<double>(parameters.triangles);
    const int cells = std::max(8, static_cast<int>(std::lround(std::sqrt(triangles * (1 - ball_share) / 2))));
    const int slices = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles * ball_share / 2))));
    const double folded = smooth_step(0, 1, static_cast<double>(parameters.frame) / (cloth_frames - 1));
    const std::uint64_t seed = mix(parameters.seed);

    Random random(seed);
    const Sheet sheet = make_sheet(cells, folded, seed, random);
    soup.reserve(static_cast<std::int64_t>(sheet.flat.size()) + slices * slices,
                 2LL * (cells * cells + slices * slices));
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) soup.vertex(wrinkled(sheet, i, j, folded, seed));
    }
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
            if (random.bits() & 1) {
                soup.triangle({a, b, d});
                soup.triangle({a, d, c});
            } else {
                soup.triangle({a, b, c});
                soup.triangle({b, d, c});
            }
        }
    }
    soup.group(0);
    add_globe(soup, slices, slices, {.origin = Drape::ball_centre, .scale = Drape::ball_radius});
    soup.group(1);
}

io::TriangleMesh make_cloth(const Parameters& parameters) {
    Soup soup;
    add_cloth(soup, parameters);
    return soup.take();
}

}  // namespace crumple::scenes
