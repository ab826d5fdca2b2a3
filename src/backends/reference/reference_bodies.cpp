#include "backends/reference/reference_bodies.h"

#include <algorithm>
#include <tuple>

#include "scene/world_scene.h"

namespace crumple {
namespace {

void find_open_edges(const std::vector<Vec3d>& given, bool weld, PosedBody& body) {
    std::map<std::tuple<double, double, double>, std::int32_t> first_at;
    auto& name = body.name;
    for (std::size_t v = 0; v < given.size(); ++v) {
        const auto at = std::tuple(given[v].x + 0.0, given[v].y + 0.0, given[v].z + 0.0);  // -0 + 0 is +0
        const auto own = static_cast<std::int32_t>(v);
        name.push_back(weld ? first_at.try_emplace(at, own).first->second : own);
    }
    std::map<Edge, int> directions;
    for (std::size_t t = 0; t < body.face.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto v = [&](std::size_t corner) { return name[static_cast<std::size_t>(body.face[t][corner])]; };
            const std::int32_t a = v(k), b = v((k + 1) % 3);
            if (a == b) continue;
            body.used.insert({a, b});
            const Edge edge{std::min(a, b), std::max(a, b)};
            directions[edge] += a < b ? 1 : -1;
            body.open.try_emplace(edge, OpenEdge{edge, static_cast<std::int32_t>(t)});
        }
    for (const auto& [edge, sum] : directions)
        if (sum == 0) body.open.erase(edge);
}

PosedBody posed_body(const WorldOutline& outline, std::int32_t b, bool weld) {
    const Shape& shape = outline.shape(b);
    const VertexReader position = reader_of(shape);
    const Placement place = outline.placement(b);
    PosedBody body;
    std::vector<Vec3d> given;
    for (std::int64_t v = 0; v < shape.vertices.rows; ++v) {
        given.push_back(position(v));
        body.point.push_back(place(given.back()));
        if (!all_finite(body.point.back())) fail_body_not_finite(outline, b);
        body.box.widen(body.point.back());
    }
    with_corner_reader(shape, [&](auto corner) {
        for (std::int64_t t = 0; t < shape.triangles.rows; ++t) {
            std::array<std::int32_t, 3>& face = body.face.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int64_t v = corner(t, static_cast<int>(k));
                if (v < 0 || v >= shape.vertices.rows) fail_index(WorldOutline::name(b), t, v, shape.vertices.rows);
                face[k] = static_cast<std::int32_t>(v);
            }
        }
    });
    if (body.face.empty()) body.box = no_bounds;  // a body without faces occupies no space
    find_open_edges(given, weld, body);
    return body;
}

}  // namespace

PosedBodies::PosedBodies(const World& world, const PairFilter& filter, bool weld, MemoryMeter& meter)
    : outline_(&meter), body_filter_(&meter) {
    outline_.read(world, filter);
    body_filter_.prepare(filter);
    bodies_.reserve(static_cast<std::size_t>(outline_.bodies()));
    for (std::int32_t b = 0; b < outline_.bodies(); ++b) bodies_.push_back(posed_body(outline_, b, weld));
}

bool PosedBodies::is_selected(std::int32_t a, std::int32_t b, bool self) const {
    const Body &one = outline_.body(a), &other = outline_.body(b);
    if (one.world != other.world && other.world != -1) return false;
    return (a == b ? body_filter_.within(a, self) : body_filter_.between(a, b)) &&
           body_filter_.groups(one.group, other.group);
}

std::vector<BodyPair> PosedBodies::near_pairs(bool self) const {
    std::vector<BodyPair> pairs;
    for (std::int32_t a = 0; a < outline_.bodies(); ++a)
        for (std::int32_t b = self ? a : a + 1; b < outline_.bodies(); ++b)
            if (is_selected(a, b, self) && (a == b || overlap((*this)[a].box, (*this)[b].box))) pairs.push_back({a, b});
    return pairs;
}

std::vector<std::int32_t> PosedBodies::open_bodies(const BodyPair& pair, OpenSurfaces open, const char* query) const {
    std::vector<std::int32_t> bodies;
    for (const std::int32_t b : {pair.first, pair.second}) {
        const auto& edges = (*this)[b].open;
        if (edges.empty()) continue;
        if (open == OpenSurfaces::error) fail_open_surface(b, edges.size(), edges.begin()->second, query);
        bodies.push_back(b);
    }
    return bodies;
}

}  // namespace crumple
