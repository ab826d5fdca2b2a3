// A sheet of cloth sinks over a ball, gathers beneath it and crumples until its wrinkles pass through each other. It
// resembles the UNC benchmark Cloth on Ball in looks and numbers: frame 92 of that has 92,230 triangles and 63,602
// colliding pairs.
//
// The sheet is a square grid with jittered vertices and random diagonals. Its shape is made in two steps: first the
// drape, which has the same form at every resolution (scenes/drape.h), then wrinkles, which displace vertices along the
// normal of the drape in a belt around the ball. The size of a wrinkle is a fixed number of grid cells, so that the
// number of colliding pairs per triangle depends little on the resolution (1.4 at 10,000 triangles, 0.7 at two
// million). A finer sheet has a finer ball.

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

// Lengths in grid cells, unless another unit is given.
constexpr double jitter = 0.2;
constexpr double wavelength = 20, wander = 20;  // length of a wrinkle; size of its irregularities
constexpr double rise = 1, swing = 2.3;         // height and sideways swing of a wrinkle, in wavelengths / 2 pi
constexpr double dent_size = 6, crumple = 0.6;  // size and depth of random dents, added to wrinkles

/// Generator of the sheet, row by row. Stores three rows of vertices at a time, because wrinkles depend on adjacent
/// vertices.
class Sheet {
   public:
    Sheet(int cells, double folded, std::uint64_t seed)
        : cells_(cells),
          spacing_(2 * Drape::half_width / cells),
          folded_(folded),
          seed_(seed),
          drape_(folded, 0.02 + 0.5 * spacing_, seed) {}

    std::int64_t vertex_count() const { return std::int64_t{cells_ + 1} * (cells_ + 1); }
    /// Adds rows [begin, end) of vertices.
    void add_vertices(Soup& soup, int begin, int end);
    /// Adds the triangles of rows [begin, end) of cells. The soup's vertices must begin with row `begin`.
    void add_triangles(Soup& soup, int begin, int end) const;

   private:
    struct Row {
        std::vector<std::array<double, 2>> flat;  // (u, v) of each vertex
        std::vector<Vec3d> draped;
    };
    const Row& row(int j) const { return rows_[static_cast<std::size_t>(j % 3)]; }
    Vec3d at(int i, int j) const {
        return row(std::clamp(j, 0, cells_)).draped[static_cast<std::size_t>(std::clamp(i, 0, cells_))];
    }
    void make_row(int j);
    Vec3d wrinkled(int i, int j) const;

    int cells_;
    double spacing_, folded_;
    std::uint64_t seed_;
    Drape drape_;
    std::array<Row, 3> rows_;
};

// Uses two random numbers per vertex, row by row.
void Sheet::make_row(int j) {
    Random random(seed_);
    random.skip(2 * static_cast<std::uint64_t>(j) * static_cast<std::uint64_t>(cells_ + 1));
    Row& row = rows_[static_cast<std::size_t>(j % 3)];
    row.flat.clear();
    row.draped.clear();
    for (int i = 0; i <= cells_; ++i) {
        const double u = (i - 0.5 * cells_ + random.uniform(-jitter, jitter)) * spacing_;
        const double v = (j - 0.5 * cells_ + random.uniform(-jitter, jitter)) * spacing_;
        row.flat.push_back({u, v});
        row.draped.push_back(drape_(u, v));
    }
}

/// Returns vertex (i, j) with wrinkles and dents.
Vec3d Sheet::wrinkled(int i, int j) const {
    const auto [u, v] = row(j).flat[static_cast<std::size_t>(i)];
    const double distance = std::sqrt(u * u + v * v), h = spacing_;
    const double belt = smooth_step(5.5, 8.5, distance) * (1 - smooth_step(10, 13, distance));
    const double patches = smooth_step(-0.5, 0.3, noise(seed_ + 1, u / 4, v / 4));
    const double strength = folded_ * belt * patches;
    if (strength == 0) return at(i, j);

    const Vec3d along_u = at(i + 1, j) - at(i - 1, j), along_v = at(i, j + 1) - at(i, j - 1);
    const Vec3d normal = normalised(cross(along_u, along_v));
    const Vec3d across = normalised(u * along_v - v * along_u);  // along circles around the vertical axis
    const double belt_wrinkles = std::floor(2 * pi * 11 / (wavelength * h) + 0.5);
    const double phase = belt_wrinkles * angle(v, u) + 0.1 * noise(seed_ + 2, u / (wander * h), v / (wander * h));
    const double unit = strength * wavelength * h / (2 * pi);

    const double x = u / (dent_size * h), y = v / (dent_size * h);
    const auto dent = [&](std::uint64_t axis) { return noise(seed_ + 3 + axis, x, y); };
    const Vec3d free = at(i, j) + (unit * rise * (1 - cosine(phase))) * normal +
                       (unit * swing * sine(2 * phase)) * across +
                       (strength * crumple * h) * Vec3d{dent(0), dent(1), dent(2)};
    // Points that would lie in the ball are pushed out of it.
    const Vec3d from_ball = free - Drape::ball_centre;
    const double nearest = Drape::ball_radius + h;
    return length(from_ball) < nearest ? Drape::ball_centre + nearest * normalised(from_ball) : free;
}

void Sheet::add_vertices(Soup& soup, int begin, int end) {
    for (int j = std::max(0, begin - 1); j <= begin; ++j) make_row(j);
    for (int j = begin; j < end; ++j) {
        if (j < cells_) make_row(j + 1);
        for (int i = 0; i <= cells_; ++i) soup.vertex(wrinkled(i, j));
    }
}

// Uses one random bit per cell, after the numbers of all vertices.
void Sheet::add_triangles(Soup& soup, int begin, int end) const {
    Random random(seed_);
    random.skip(2 * static_cast<std::uint64_t>(vertex_count()) +
                static_cast<std::uint64_t>(begin) * static_cast<std::uint64_t>(cells_));
    for (int j = begin; j < end; ++j) {
        for (int i = 0; i < cells_; ++i) {
            const int a = (j - begin) * (cells_ + 1) + i, b = a + 1, c = a + cells_ + 1, d = c + 1;
            if (random.bits() & 1) {
                soup.triangle({a, b, d});
                soup.triangle({a, d, c});
            } else {
                soup.triangle({a, b, c});
                soup.triangle({b, d, c});
            }
        }
    }
}

/// Adds a block of the scene. Returns the number of the sheet's vertices that precede it.
std::int64_t add_cloth(Soup& soup, const Parameters& parameters, int block, int blocks) {
    const auto triangles = static_cast<double>(parameters.triangles);
    const int cells = std::max(8, static_cast<int>(std::lround(std::sqrt(triangles * (1 - ball_share) / 2))));
    const int slices = std::max(4, static_cast<int>(std::lround(std::sqrt(triangles * ball_share / 2))));
    const double folded = smooth_step(0, 1, static_cast<double>(parameters.frame) / (cloth_frames - 1));

    const auto row = [&](int b) { return static_cast<int>(std::int64_t{cells} * b / blocks); };
    const int begin = row(block), end = row(block + 1);
    const bool with_ball = block + 1 == blocks;
    const std::int64_t ball = with_ball ? std::int64_t{slices} * slices : 0;
    soup.reserve((end - begin + 1) * std::int64_t{cells + 1} + ball, 2 * ((end - begin) * std::int64_t{cells} + ball));
    Sheet sheet(cells, folded, mix(parameters.seed));
    sheet.add_vertices(soup, begin, end + 1);
    sheet.add_triangles(soup, begin, end);
    soup.group(0);
    if (with_ball) add_uv_sphere(soup, slices, slices, {.origin = Drape::ball_centre, .scale = Drape::ball_radius});
    soup.group(1);
    return begin * std::int64_t{cells + 1};
}

}  // namespace

void add_cloth(Soup& soup, const Parameters& parameters) { add_cloth(soup, parameters, 0, 1); }

MeshBlock cloth_block(const Parameters& parameters, int block, int blocks) {
    Soup soup;
    MeshBlock made;
    made.first_vertex = add_cloth(soup, parameters, block, blocks);
    made.mesh = soup.take();
    return made;
}

io::TriangleMesh make_cloth(const Parameters& parameters) {
    Soup soup;
    add_cloth(soup, parameters);
    return soup.take();
}

}  // namespace crumple::scenes
