#include "detector/free_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <variant>
#include <vector>

#include "base/float_environment.h"
#include "queries/feature_request.h"
#include "scene/world_outline.h"

namespace crumple {
namespace {

/// Posed vertices of a scene at the start and the end of a step, and the scene with other end positions.
class Step {
   public:
    explicit Step(const Scene& scene) {
        const auto* mesh = std::get_if<MeshView>(&scene.source());
        const auto* two = std::get_if<TwoMeshes>(&scene.source());
        if (mesh) {
            lone_mesh_ = *mesh;
            shapes_.emplace_back(*mesh);
            bodies_.emplace_back();
        } else if (two) {
            shapes_ = {Shape(two->a), Shape(two->b)};
            bodies_ = {{.shape = 0}, {.shape = 1}};
        } else {
            read(std::get<World>(scene.source()));
            return;
        }
        read(World{shapes_, bodies_, {}});
    }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;

    bool lone_mesh() const { return lone_mesh_.has_value(); }
    std::int64_t vertices() const { return first_vertex_.back(); }
    const std::vector<std::int64_t>& first_vertex() const { return first_vertex_; }
    std::size_t bodies() const { return bodies_.size(); }
    std::int32_t world_of(std::size_t body) const { return bodies_[body].world; }
    /// Returns the number of worlds, which are numbered from 0.
    std::size_t worlds() const { return worlds_; }

    /// Writes the position that vertex v has after a share of the step to `positions`, rounded to the precision of its
    /// body.
    void go(std::int64_t v, std::size_t body, double share, Array<double>& positions) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double a = start_[3 * v + axis], b = end_[3 * v + axis];
            // Exact at both ends. In between, a form that cannot overflow.
            const double x = share == 0 ? a : share == 1 ? b : (1 - share) * a + share * b;
            positions[3 * v + axis] = float32_[body] ? static_cast<double>(static_cast<float>(x)) : x;
        }
    }

    /// Returns the scene with these end positions; valid until the next call.
    Scene moving_to(const Array<double>& positions) {
        if (lone_mesh_) return lone_mesh_->moving_to(rows(positions, 0));
        for (std::size_t b = 0; b < shapes_.size(); ++b) shapes_[b].end = rows(positions, b);
        return World{shapes_, bodies_, {}};
    }

    /// Calls visit(v) with the vertices of a feature of a body.
    template <class Visit>
    void for_vertices(FeatureType type, std::int32_t index, std::size_t body, const Impacts& found, Visit visit) const {
        const auto b = static_cast<std::int64_t>(body);
        const std::int64_t first = first_vertex_[body];
        if (type == FeatureType::vertex) {
            const bool listed = !found.points.empty() && found.first_point[b] < found.first_point[b + 1];
            visit(first + (listed ? found.points[found.first_point[b] + index] : index));
        } else if (type == FeatureType::edge) {
            const Edge& edge = found.edges[found.first_edge[b] + index];
            visit(first + edge.a);
            visit(first + edge.b);
        } else {
            with_corner_reader(shapes_[body], [&](auto corner) {
                for (int k = 0; k < 3; ++k) visit(first + corner(index, k));
            });
        }
    }

   private:
    void read(const World& world) {
        WorldOutline outline(nullptr);
        outline.read(world, {});
        worlds_ = static_cast<std::size_t>(outline.worlds());
        const std::int32_t count = outline.bodies();
        first_vertex_ = {0};
        for (std::int32_t b = 0; b < count; ++b) first_vertex_.push_back(vertices() + outline.shape(b).vertices.rows);
        start_.resize_discard(static_cast<std::size_t>(3 * vertices()));
        end_.resize_discard(static_cast<std::size_t>(3 * vertices()));
        std::vector<Shape> shapes;
        std::vector<Body> bodies;
        for (std::int32_t b = 0; b < count; ++b) {
            const Shape& shape = outline.shape(b);
            const VertexReader from = reader_of(shape), to = end_reader_of(shape);
            const Placement at_start = outline.placement(b), at_end = outline.end_placement(b);
            for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
                const std::int64_t row = 3 * (first_vertex_[static_cast<std::size_t>(b)] + v);
                const Vec3d a = at_start(from(v)), z = at_end(to(v));
                for (int axis = 0; axis < 3; ++axis) start_[row + axis] = a[axis], end_[row + axis] = z[axis];
            }
            float32_.push_back(shape.vertices.type == ScalarType::float32 &&
                               (!shape.end.data || shape.end.type == ScalarType::float32));
            Shape own = shape;  // used by this body alone, since each body has its own posed vertices
            own.name = 0;
            own.vertices = rows(start_, static_cast<std::size_t>(b));
            shapes.push_back(own);
            bodies.push_back(outline.body(b));
            bodies.back().shape = b;
        }
        shapes_ = std::move(shapes);
        bodies_ = std::move(bodies);
    }

    VertexView rows(const Array<double>& all, std::size_t body) const {
        const std::int64_t first = first_vertex_[body];
        return rows_of_three(all.data() + 3 * first, first_vertex_[body + 1] - first);
    }

    std::optional<MeshView> lone_mesh_;
    std::vector<Shape> shapes_;
    std::vector<Body> bodies_;
    std::size_t worlds_ = 0;
    std::vector<std::int64_t> first_vertex_;  ///< first vertex of each body, then the number of vertices
    std::vector<bool> float32_;               ///< per body: true if its positions are float32
    Array<double> start_, end_;
};

/// Units that are held back together (worlds, bodies or vertices), with the share of the step that each takes.
class Units {
   public:
    Units(const Step& step, Held held) : step_(step), held_(held) {
        // A body that is in all worlds is a unit of its own.
        const std::size_t count = held == Held::vertices ? static_cast<std::size_t>(step.vertices())
                                  : held == Held::bodies ? step.bodies()
                                                         : step.worlds() + step.bodies();
        share_.assign(count, 1);
        earliest_.assign(count, 2);
        cuts_.assign(count, 0);
        blocked_at_start_.assign(step.bodies(), 0);
    }

    double share(std::size_t body, std::int64_t vertex) const { return share_[unit(body, vertex)]; }

    /// Records the impacts that the next cut() has to avoid. Ignores impacts of worlds that are held at the start.
    /// Returns false if there are no others.
    bool record_impacts(const Impacts& found) {
        bool any = false;
        if (found.count == 0 && held_ == Held::worlds) {
            for (const FirstImpact& first : found.world_first) any |= record_impacts(first, found);
            return any;
        }
        for (int kind = 0; kind < feature_kinds; ++kind) {
            const ImpactList& list = found.lists[static_cast<std::size_t>(kind)];
            for (std::size_t i = 0; i < list.pairs.size(); ++i) {
                const BodyPair bodies = list.bodies.empty() ? BodyPair{} : list.bodies[i];
                any |= record_impacts({true, static_cast<FeatureKind>(kind), list.pairs[i], bodies, list.toi[i], false},
                                      found);
            }
        }
        return any;
    }

    /// Shortens the steps of the units that take part in recorded impacts.
    void cut() {
        // Cut n of a unit, counted from 0, multiplies its share by (1 - 2^-bits[n]) times the time of contact; cuts
        // after the last element of `bits` multiply it by half the time of contact.
        constexpr std::array<int, 4> bits{16, 8, 4, 2};
        constexpr std::size_t most_cuts = 40;
        constexpr double least_share = 0x1p-40;
        for (std::size_t u = 0; u < share_.size(); ++u) {
            if (earliest_[u] > 1) continue;
            const std::size_t cuts = cuts_[u]++;
            share_[u] *= earliest_[u] * (cuts < bits.size() ? 1 - std::ldexp(1.0, -bits[cuts]) : 0.5);
            if (share_[u] < least_share || cuts == most_cuts) share_[u] = 0;
            earliest_[u] = 2;
        }
    }

    /// Holds the world of two bodies at the start of the step, together with bodies that are in all worlds. Holds all
    /// worlds if both bodies are in all worlds.
    void hold_worlds_of(const BodyPair& bodies) {
        const auto first = static_cast<std::size_t>(bodies.first), second = static_cast<std::size_t>(bodies.second);
        if (blocked_at_start_[first] || blocked_at_start_[second]) return;
        const std::int32_t world = std::max(step_.world_of(first), step_.world_of(second));
        for (std::size_t b = 0; b < step_.bodies(); ++b) {
            const std::int32_t its = step_.world_of(b);
            if (world >= 0 && its != world && its >= 0) continue;
            if (world < 0 || its == world) blocked_at_start_[b] = 1;
            for (std::int64_t v = step_.first_vertex()[b]; v < step_.first_vertex()[b + 1]; ++v) share_[unit(b, v)] = 0;
        }
    }

   private:
    std::size_t unit(std::size_t body, std::int64_t vertex) const {
        if (held_ == Held::vertices) return static_cast<std::size_t>(vertex);
        if (held_ == Held::bodies) return body;
        const std::int32_t world = step_.world_of(body);
        return world < 0 ? step_.worlds() + body : static_cast<std::size_t>(world);
    }

    bool record_impacts(const FirstImpact& impact, const Impacts& found) {
        const auto first = static_cast<std::size_t>(impact.bodies.first);
        const auto second = static_cast<std::size_t>(impact.bodies.second);
        if (!impact.found || blocked_at_start_[first] || blocked_at_start_[second]) return false;
        bool goes = false;
        const auto cut = [&](std::size_t u) {
            goes |= share_[u] > 0;
            earliest_[u] = std::min(earliest_[u], impact.toi);
        };
        if (held_ == Held::vertices) {
            const FeatureTypes types = types_of(impact.kind);
            const auto vertex = [&](std::int64_t v) { cut(static_cast<std::size_t>(v)); };
            step_.for_vertices(types.first, impact.pair.a, first, found, vertex);
            step_.for_vertices(types.second, impact.pair.b, second, found, vertex);
        } else {
            cut(unit(first, 0));
            cut(unit(second, 0));
        }
        if (!goes) hold_worlds_of(impact.bodies);  // they touch at the start
        return true;
    }

    const Step& step_;
    Held held_;
    std::vector<double> share_, earliest_;
    std::vector<std::size_t> cuts_;
    std::vector<std::uint8_t> blocked_at_start_;  ///< per body: 1 if its world is held at the start
};

/// True if bodies that are in all worlds can have impacts among themselves. Such an impact belongs to no world, so
/// Impacts::world_first does not contain it, and an impact of a world may precede it in Impacts::first; only the lists
/// always contain it.
bool needs_lists(const Scene& scene) {
    const auto* world = std::get_if<World>(&scene.source());
    if (!world) return false;
    std::size_t in_all = 0;
    for (const Body& body : world->bodies) in_all += body.world != -1 ? 0 : body.self ? 2 : 1;
    return in_all > 1;
}

/// Holds worlds in which triangles intersect at the start, since no share of the step avoids that. Returns false if
/// there are none.
template <class Find>
bool hold_what_intersects(Step& step, ImpactQuery query, Find find, Units& units, FreeStep& result) {
    query.triangle_pairs = true;
    query.output = Output::any;
    if (!find(step.moving_to(result.positions), query).any) return false;
    query.output = Output::pairs;
    const ImpactList& pairs = find(step.moving_to(result.positions), query).triangle_pairs;
    result.intersects = !pairs.pairs.empty();
    if (!result.intersects) return false;
    result.intersecting = pairs.pairs[0];
    for (std::size_t i = 0; i < pairs.pairs.size(); ++i) {
        const BodyPair bodies = pairs.bodies.empty() ? BodyPair{} : pairs.bodies[i];
        if (i == 0) result.intersecting_bodies = bodies;
        units.hold_worlds_of(bodies);
    }
    return true;
}

}  // namespace

void find_free_step(const Scene& scene, const FreeStepQuery& query,
                    FunctionRef<const Impacts&(const Scene&, const ImpactQuery&)> find, FreeStep& result) {
    ImpactQuery impacts = query;
    impacts.output = query.held == Held::worlds && !needs_lists(scene) ? Output::first : Output::pairs;
    impacts.index = impacts.triangle_pairs = false;
    const Impacts& whole = find(scene, impacts);  // checks the scene, too
    const FloatEnvironment environment;
    Step step(scene);
    Units units(step, query.held);
    bool free = !units.record_impacts(whole);
    result = {};
    result.first = whole.first;
    result.positions.resize_discard(static_cast<std::size_t>(3 * step.vertices()));
    const auto for_each_vertex = [&](auto visit) {
        for (std::size_t b = 0; b < step.bodies(); ++b)
            for (std::int64_t v = step.first_vertex()[b]; v < step.first_vertex()[b + 1]; ++v) visit(v, b);
    };
    if (query.triangle_pairs) {
        for_each_vertex([&](std::int64_t v, std::size_t b) { step.go(v, b, 0, result.positions); });
        if (hold_what_intersects(step, impacts, find, units, result)) free = false;
    }
    for (;; free = !units.record_impacts(find(step.moving_to(result.positions), impacts))) {
        units.cut();
        for_each_vertex([&](std::int64_t v, std::size_t b) { step.go(v, b, units.share(b, v), result.positions); });
        if (free) break;
    }

    result.share = 1;
    const bool by_vertex = query.held == Held::vertices;
    if (by_vertex) result.vertex_shares.resize_discard(static_cast<std::size_t>(step.vertices()));
    for_each_vertex([&](std::int64_t v, std::size_t b) {
        result.share = std::min(result.share, units.share(b, v));
        if (by_vertex) result.vertex_shares[v] = units.share(b, v);
    });
    if (step.lone_mesh()) return;
    for (const std::int64_t first : step.first_vertex()) result.first_vertex.push_back(first);
    if (by_vertex) return;
    for (std::size_t b = 0; b < step.bodies(); ++b)
        result.body_shares.push_back(units.share(b, step.first_vertex()[b]));
}

}  // namespace crumple
