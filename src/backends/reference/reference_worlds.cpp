#include "backends/reference/reference_worlds.h"

#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "exact/intersection/decide_intersection.h"
#include "exact/intersection/exact_intersection.h"
#include "results/world_output.h"
#include "scene/body_filter.h"
#include "scene/world_scene.h"

namespace crumple {
namespace {

struct PosedTriangle {
    Triangle triangle;
    Bounds box;
    BodyClass of;
    std::int32_t index;  ///< within its body
};

// All posed triangles of all bodies, in order.
class AllTriangles {
   public:
    AllTriangles(const WorldOutline& outline, bool weld) : weld_(weld) {
        for (std::int32_t b = 0; b < outline.bodies(); ++b) add(outline, b);
    }
    const std::vector<PosedTriangle>& elements() const { return elements_; }

   private:
    void add(const WorldOutline& outline, std::int32_t b) {
        const Shape& shape = outline.shape(b);
        const VertexReader position = reader_of(shape);
        const Placement place = outline.placement(b);
        std::vector<Vec3d> posed;
        std::vector<std::int32_t> id;
        for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
            posed.push_back(place(position(v)));
            if (!all_finite(posed.back())) fail_body_not_finite(outline, b);
            id.push_back(name(posed.back()));
        }
        with_corner_reader(shape, [&](auto corner) {
            for (std::int64_t t = 0; t < shape.triangles.rows; ++t) {
                PosedTriangle e{};
                e.index = static_cast<std::int32_t>(t);
                e.of = {b, shape.groups.empty() ? outline.body(b).group : shape.groups[static_cast<std::size_t>(t)],
                        outline.body(b).self, false};
                e.box = no_bounds;
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::int64_t v = corner(t, static_cast<int>(k));
                    if (v < 0 || v >= shape.vertices.rows) fail_index(WorldOutline::name(b), t, v, shape.vertices.rows);
                    e.triangle.point[k] = posed[static_cast<std::size_t>(v)];
                    e.triangle.vertex[k] = id[static_cast<std::size_t>(v)];
                    e.box.widen(e.triangle.point[k]);
                }
                elements_.push_back(e);
            }
        });
    }

    std::int32_t name(const Vec3d& p) {
        if (!weld_) return next_++;
        const auto [entry, fresh] = known_.emplace(std::tuple(p.x + 0.0, p.y + 0.0, p.z + 0.0), next_);
        next_ += fresh;
        return entry->second;
    }

    bool weld_;
    std::int32_t next_ = 0;
    std::map<std::tuple<double, double, double>, std::int32_t> known_;
    std::vector<PosedTriangle> elements_;
};

void add_contact(const Triangle& a, const Triangle& b, Intersections& result) {
    const Contact c = contact(a, b);
    std::vector<std::array<double, 3>> points;
    points.reserve(static_cast<std::size_t>(c.count));
    for (std::size_t k = 0; k < static_cast<std::size_t>(c.count); ++k)
        points.push_back({c.points[k].x, c.points[k].y, c.points[k].z});
    add_contact(c.kind(), points, result);
}

}  // namespace

void find_by_brute_force(const World& world, const IntersectionQuery& query, MemoryMeter& meter,
                         Cancellation& cancellation, Intersections& result, const WorldBlocks* blocks) {
    WorldOutline outline(&meter);
    outline.read(world, query.filter);
    BodyFilter rules(&meter);
    rules.prepare(query.filter);
    clear(result, outline, query);
    result.statistics.backend = "reference";
    result.statistics.simd = "scalar";
    const AllTriangles everything(outline, query.weld);
    const std::vector<PosedTriangle>& all = everything.elements();
    for (std::size_t i = 0; i < all.size(); ++i) {
        cancellation.check();
        const std::int32_t world_a = outline.body(all[i].of.body).world;
        for (std::size_t j = i + 1; j < all.size(); ++j) {
            const std::int32_t world_b = outline.body(all[j].of.body).world;
            if (world_b != world_a && world_b != -1) continue;
            if (!overlap(all[i].box, all[j].box) || !rules(all[i].of, all[j].of)) continue;
            ++result.statistics.box_overlaps;
            const RationalIntersection intersection = intersect_rationally(all[i].triangle, all[j].triangle);
            if (!collide(intersection, query.neighbours, query.kind)) continue;
            add_pair(outline, query, world_a == -1 ? outline.worlds() : world_a, {all[i].of.body, all[j].of.body},
                     {all[i].index, all[j].index}, result);
            if (query.output == Output::contacts) add_contact(all[i].triangle, all[j].triangle, result);
            if (blocks) blocks->deliver_if_full(result);
        }
    }
    if (blocks)
        blocks->deliver_if_full(result, true);
    else
        finish(outline, query, result);
}

}  // namespace crumple
