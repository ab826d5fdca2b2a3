#include "backends/reference/reference_distances.h"

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "exact/distance/exact_nearest.h"
#include "results/nearest_output.h"
#include "scene/body_filter.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"

namespace crumple {
namespace {

struct PosedTriangle {
    TrianglePoints point;
    BodyClass of;
    std::int32_t index;  ///< within its body
};

std::vector<PosedTriangle> triangles_of(const WorldOutline& outline, std::int32_t b) {
    const Shape& shape = outline.shape(b);
    const VertexReader position = reader_of(shape);
    const Placement place = outline.placement(b);
    std::vector<Vec3d> posed;
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        posed.push_back(place(position(v)));
        if (!all_finite(posed.back())) fail_body_not_finite(outline, b);
    }
    std::vector<PosedTriangle> triangles;
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < shape.triangles.rows; ++t) {
            const std::int32_t group =
                shape.groups.empty() ? outline.body(b).group : shape.groups[static_cast<std::size_t>(t)];
            PosedTriangle triangle{{}, {.body = b, .group = group}, static_cast<std::int32_t>(t)};
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int64_t v = corner(t, static_cast<int>(k));
                if (v < 0 || v >= shape.vertices.rows) fail_index(WorldOutline::name(b), t, v, shape.vertices.rows);
                triangle.point[k] = posed[static_cast<std::size_t>(v)];
            }
            triangles.push_back(triangle);
        }
    });
    return triangles;
}

void add_bodies(const std::vector<PosedTriangle>& all_a, const std::vector<PosedTriangle>& all_b,
                const BodyFilter& rules, double radius, Cancellation& cancellation, Distances& answer) {
    std::optional<RationalNearest> least;
    Pair triangles{};
    for (const PosedTriangle& a : all_a) {
        cancellation.check();
        for (const PosedTriangle& b : all_b) {
            if (!rules(a.of, b.of)) continue;
            ++answer.statistics.box_overlaps;
            RationalNearest nearest(a.point, b.point);
            if (least && compare(nearest, *least) >= 0) continue;
            least = std::move(nearest);
            triangles = {a.index, b.index};
        }
    }
    if (!least || (std::isfinite(radius) && !least->within(radius))) return;
    answer.bodies.push_back({all_a[0].of.body, all_b[0].of.body});
    make_rows(answer);
    put_row(answer, answer.bodies.size() - 1, {least->squared(), least->touching(), triangles, least->points()});
}

/// Keeps the row of the nearest pair of bodies of each world, the first one if several are equally near, and fills
/// world_rows.
void keep_nearest(const World& world, std::int32_t worlds, Distances& answer) {
    const std::size_t none = answer.bodies.size();
    std::vector<std::size_t> nearest(static_cast<std::size_t>(worlds), none);
    for (std::size_t row = 0; row < none; ++row) {
        std::size_t& least =
            nearest[static_cast<std::size_t>(world.bodies[static_cast<std::size_t>(answer.bodies[row].first)].world)];
        if (least == none || answer.squared_distance[row] < answer.squared_distance[least]) least = row;
    }
    Array<std::uint8_t> kept;
    kept.assign(none, 0);
    std::int64_t rows = 0;
    for (const std::size_t row : nearest) {
        answer.world_rows.push_back(row == none ? -1 : rows++);
        if (row != none) kept[row] = 1;
    }
    keep_rows(answer, kept);
}

}  // namespace

void find_nearest_by_brute_force(const World& world, const DistanceQuery& query, MemoryMeter& meter,
                                 Cancellation& cancellation, Distances& answer) {
    WorldOutline outline(&meter);
    outline.read(world, query.filter);
    BodyFilter rules(&meter);
    rules.prepare(query.filter);
    clear(answer);
    answer.statistics.backend = "reference";
    answer.statistics.simd = "scalar";
    answer.statistics.triangles = outline.triangles();
    const bool nearest = query.output == Output::nearest;
    std::vector<std::vector<PosedTriangle>> bodies;
    bodies.reserve(static_cast<std::size_t>(outline.bodies()));
    for (std::int32_t b = 0; b < outline.bodies(); ++b) bodies.push_back(triangles_of(outline, b));
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = a + 1; b < bodies.size(); ++b) {
            const std::int32_t world_a = world.bodies[a].world, world_b = world.bodies[b].world;
            if (nearest && world_a == -1) continue;
            if (world_b == world_a || world_b == -1)
                add_bodies(bodies[a], bodies[b], rules, query.radius, cancellation, answer);
        }
    }
    if (nearest) keep_nearest(world, outline.worlds(), answer);
}

}  // namespace crumple
