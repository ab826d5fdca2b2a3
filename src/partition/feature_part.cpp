#include "partition/feature_part.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "crumple/error.h"
#include "geometry/inflation.h"
#include "partition/parts_of_scene.h"

namespace crumple {
namespace {

// Entry of PartFeatures::joined for an adjacent vertex outside the part; no vertex of the part has this index.
constexpr std::int32_t elsewhere = std::numeric_limits<std::int32_t>::max();

void sort_and_unique(std::vector<std::int32_t>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
}
// Returns the position of an id in an ascending list, or -1.
std::int32_t position_of(const std::vector<std::int32_t>& ids, std::int32_t id) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    return at != ids.end() && *at == id ? static_cast<std::int32_t>(at - ids.begin()) : -1;
}

std::variant<std::vector<float>, std::vector<double>> copy_positions(const VertexReader& reader,
                                                                     const std::vector<std::int32_t>& vertices) {
    const auto copy = [&](auto scalar) {
        std::vector<decltype(scalar)> xyz;
        xyz.reserve(3 * vertices.size());
        for (const std::int32_t v : vertices) {
            const Vec3d p = reader(v);
            for (int axis = 0; axis < 3; ++axis) xyz.push_back(static_cast<decltype(scalar)>(p[axis]));
        }
        return std::variant<std::vector<float>, std::vector<double>>(std::move(xyz));
    };
    return reader.float32 ? copy(float()) : copy(double());
}

class FeatureCopier {
   public:
    FeatureCopier(const PreparedScene& scene, const SceneFeatures& features, const FeaturePartDemand& query)
        : scene_(scene), features_(features), query_(query) {}

    void operator()(std::span<const std::int32_t> ids, Part& part) const {
        PartFeatures& out = part.features.emplace();
        out.moving = query_.moving;
        out.distance = query_.distance;
        out.share = query_.share;
        out.weld = query_.weld;
        out.faces =
            std::partition_point(ids.begin(), ids.end(), [&](std::int32_t t) { return t < features_.faces(); }) -
            ids.begin();
        copy_triangles(ids, part.mesh, out);
        copy_edges(ids, out);
        copy_points(ids, out);
        copy_vertices(out);
        if (query_.rings) copy_rings(out);
    }

   private:
    void copy_triangles(std::span<const std::int32_t> ids, PartMesh& mesh, PartFeatures& out) const {
        for (const std::int32_t t : ids) out.vertices.insert(out.vertices.end(), corners(t), corners(t) + 3);
        sort_and_unique(out.vertices);
        mesh.ids.assign(ids.begin(), ids.end());
        mesh.corners.reserve(3 * ids.size());
        out.owned.reserve(ids.size());
        for (const std::int32_t t : ids) {
            for (int k = 0; k < 3; ++k) mesh.corners.push_back(position_of(out.vertices, corners(t)[k]));
            out.owned.push_back(features_.owned(t));
            const std::int64_t proxy = t - features_.faces();
            const std::int32_t face = proxy < 0 ? t : features_.face_of_proxy(proxy);
            if (proxy >= 0) out.of_no_face.push_back(face < 0);
            if (!query_.groups.empty())
                mesh.groups.push_back(face < 0 ? 0 : query_.groups[static_cast<std::size_t>(face)]);
        }
        mesh.vertices = copy_positions(scene_.reader[0], out.vertices);
        if (query_.moving) out.end = copy_positions(scene_.moving ? scene_.end : scene_.reader[0], out.vertices);
    }

    void copy_edges(std::span<const std::int32_t> ids, PartFeatures& out) const {
        const auto owned_edge = [&](std::int32_t t, int k) {
            return features_.owned(t) >> (3 + k) & 1 ? features_.edges_of(t)[static_cast<std::size_t>(k)] : -1;
        };
        for (const std::int32_t t : ids)
            for (int k = 0; k < 3; ++k)
                if (const std::int32_t e = owned_edge(t, k); e >= 0) out.edges.push_back(e);
        sort_and_unique(out.edges);
        for (const std::int32_t e : out.edges) {
            const Edge& edge = features_.edges()[e];
            out.edge_ends.push_back({position_of(out.vertices, edge.a), position_of(out.vertices, edge.b)});
        }
        out.edges_of.reserve(ids.size());
        for (const std::int32_t t : ids)
            out.edges_of.push_back({position_of(out.edges, owned_edge(t, 0)), position_of(out.edges, owned_edge(t, 1)),
                                    position_of(out.edges, owned_edge(t, 2))});
    }

    void copy_points(std::span<const std::int32_t> ids, PartFeatures& out) const {
        out.lists_points = features_.lists_points();
        if (!out.lists_points) return;
        const auto owned_point = [&](std::int32_t t, int k) {
            return features_.owned(t) >> k & 1 ? features_.point_of(t, k) : -1;
        };
        for (const std::int32_t t : ids)
            for (int k = 0; k < 3; ++k)
                if (const std::int32_t p = owned_point(t, k); p >= 0) out.points.push_back(p);
        sort_and_unique(out.points);
        for (const std::int32_t p : out.points)
            out.point_vertices.push_back(position_of(out.vertices, features_.vertex_of(p)));
        for (const std::int32_t t : ids)
            out.points_of.push_back({position_of(out.points, owned_point(t, 0)),
                                     position_of(out.points, owned_point(t, 1)),
                                     position_of(out.points, owned_point(t, 2))});
    }

    void copy_vertices(PartFeatures& out) const {
        const LocalRepresentatives first = first_by_name(out);
        if (features_.is_welded())
            for (const std::int32_t v : out.vertices) out.names.push_back(named(first, features_.name(v)));
        const auto neighbour = [&](std::int32_t name) {
            const std::int32_t at = named(first, name);
            return name < 0 || at >= 0 ? at : elsewhere;
        };
        for (const std::int32_t v : out.vertices) {
            if (features_.has_lone_edges()) {
                const auto [one, another, more] = features_.neighbours(v);
                out.joined.push_back({neighbour(one), neighbour(another), more});
            }
            if (!query_.radii.empty()) out.radii.push_back(query_.radii[static_cast<std::size_t>(v)]);
            if (!query_.rest) continue;
            const Vec3d p = (*query_.rest)(v);
            for (int axis = 0; axis < 3; ++axis) out.rest.push_back(p[axis]);
        }
    }

    void copy_rings(PartFeatures& out) const {
        const LocalRepresentatives first = first_by_name(out);
        out.rings = query_.rings->rings();
        out.first_ring.push_back(0);
        for (const std::int32_t v : out.vertices) {
            const auto begin = static_cast<std::ptrdiff_t>(out.ring.size());
            for (const std::int32_t name : query_.rings->about(features_.name(v)))
                if (const std::int32_t at = named(first, name); at >= 0) out.ring.push_back(at);
            std::sort(out.ring.begin() + begin, out.ring.end());
            out.first_ring.push_back(static_cast<std::int64_t>(out.ring.size()));
        }
    }

    // Pairs of a representative vertex in the scene and the first vertex of the part that it represents, ascending.
    // Within the part, that first vertex is the representative.
    using LocalRepresentatives = std::vector<std::pair<std::int32_t, std::int32_t>>;
    LocalRepresentatives first_by_name(const PartFeatures& out) const {
        LocalRepresentatives first;
        first.reserve(out.vertices.size());
        for (const std::int32_t v : out.vertices)
            first.push_back({features_.name(v), static_cast<std::int32_t>(first.size())});
        std::sort(first.begin(), first.end());
        const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
        first.erase(std::unique(first.begin(), first.end(), same), first.end());
        return first;
    }
    static std::int32_t named(const LocalRepresentatives& first, std::int32_t name) {
        const auto at = std::lower_bound(first.begin(), first.end(), std::pair(name, std::int32_t{0}));
        return at != first.end() && at->first == name ? at->second : -1;
    }

    const std::int32_t* corners(std::int32_t t) const { return scene_.corners + 3 * std::int64_t{t}; }

    const PreparedScene& scene_;
    const SceneFeatures& features_;
    const FeaturePartDemand& query_;
};

void check_that(bool holds, const char* message, Element element = Element::option, std::size_t index = 0) {
    const std::int64_t at = element == Element::option ? -1 : static_cast<std::int64_t>(index);
    if (!holds) throw Error(ErrorCode::invalid_argument, message, element, at);
}
template <class T>
void check_ids(const std::vector<T>& ids, const char* message, Element element) {
    T before = -1;
    for (std::size_t i = 0; i < ids.size(); before = ids[i++]) check_that(ids[i] > before, message, element, i);
}
// Checks that each entry of each row is a position in a list of `size` entries, or -1.
void check_rows(const std::vector<std::array<std::int32_t, 3>>& rows, std::size_t size, const char* message) {
    const auto most = static_cast<std::int64_t>(size);
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const std::int32_t at : rows[i]) check_that(at >= -1 && at < most, message, Element::triangle, i);
}

}  // namespace

// Converts a length from the scene's units to normalised coordinates, rounded up. The limit `farthest` keeps the result
// finite; longer lengths have no further effect.
double FeatureBallOfTriangle::length(double x) const {
    return min(double{farthest}, x * normalise_.pre * normalise_.post) * 1.0000001 + 1e-30;
}

FeatureBallOfTriangle::FeatureBallOfTriangle(const FeaturePartDemand& query, const Normaliser& normalise)
    : normalise_(normalise), radii_(query.radii) {
    if (query.distance > 0) half_distance_ = length(query.distance) / 2;
    if (query.share > 0) path_share_ = query.share / (1 - query.share) * 1.0000001;
}

PartBall FeatureBallOfTriangle::operator()(const PreparedScene& scene, std::int64_t t) const {
    const std::int32_t* c = scene.corners + 3 * t;
    const Vec3d end[3] = {scene.end_position(c[0]), scene.end_position(c[1]), scene.end_position(c[2])};
    double widened = half_distance_;
    if (!radii_.empty())
        for (int k = 0; k < 3; ++k) widened = std::max(widened, length(radii_[static_cast<std::size_t>(c[k])]));
    return PartBall(scene.triangle(t), end, widened, path_share_, normalise_);
}

std::vector<Part> make_feature_parts(const PreparedScene& scene, const SceneFeatures& features,
                                     const FeaturePartDemand& query, int count, ParallelFor& parallel) {
    const FeatureBallOfTriangle feature_ball(query, Normaliser(scene.low, scene.high));
    const auto ball = [&](std::int64_t t) { return feature_ball(scene, t); };
    return make_parts(scene, count, parallel, ball, FeatureCopier(scene, features, query));
}

void check_feature_part(const Part& part) {
    check_that(part.features.has_value() && !part.second, "the part was not made for a query about features");
    check_part(part);
    const PartFeatures& f = *part.features;
    const std::size_t n = f.vertices.size(), m = part.mesh.ids.size();
    const auto coordinates = [](const auto& xyz) { return std::visit([](const auto& v) { return v.size(); }, xyz); };
    check_that(coordinates(part.mesh.vertices) == 3 * n, "a part must have an id for each of its vertices");
    check_that(coordinates(f.end) == (f.moving ? 3 * n : 0),
               "a part must have an end position for each vertex if it is moving, and none if not");
    check_that(f.faces >= 0 && f.faces <= static_cast<std::int64_t>(m) &&
                   f.of_no_face.size() == m - static_cast<std::size_t>(f.faces),
               "a part's of_no_face must have an entry for each proxy triangle");
    check_that(
        f.owned.size() == m && f.edges_of.size() == m && f.points_of.size() == (f.lists_points ? m : 0),
        "a part's owned and edges_of must have an entry for each triangle, and points_of only if it lists points");
    check_that(f.edges.size() == f.edge_ends.size() && f.points.size() == f.point_vertices.size(),
               "a part must have the vertices of each of its edges and points");
    const auto one_each = [&](std::size_t size, std::size_t each) { return size == 0 || size == each * n; };
    check_that(one_each(f.names.size(), 1) && one_each(f.joined.size(), 1) && one_each(f.radii.size(), 1) &&
                   one_each(f.rest.size(), 3),
               "a part's names, joined, radii and rest must be empty, or have an entry for each vertex");
    check_ids(f.vertices, "a part's vertex ids must be 0 or more, and ascend", Element::vertex);
    check_ids(f.edges, "a part's edge ids must be 0 or more, and ascend", Element::edge);
    check_ids(f.points, "a part's point ids must be 0 or more, and ascend", Element::point);
    check_rows(f.edges_of, f.edges.size(), "a part's triangle owns an edge that the part does not have");
    check_rows(f.points_of, f.points.size(), "a part's triangle owns a point that the part does not have");
    const auto is_vertex = [&](std::int32_t v) { return v >= 0 && static_cast<std::size_t>(v) < n; };
    for (std::size_t e = 0; e < f.edges.size(); ++e)
        check_that(is_vertex(f.edge_ends[e].a) && is_vertex(f.edge_ends[e].b),
                   "a part's edge has a vertex that the part does not have", Element::edge, e);
    for (std::size_t p = 0; p < f.points.size(); ++p)
        check_that(is_vertex(f.point_vertices[p]), "a part's point is a vertex that the part does not have",
                   Element::point, p);
    for (std::size_t v = 0; v < f.names.size(); ++v)
        check_that(is_vertex(f.names[v]), "a part's vertex is represented by one that the part does not have",
                   Element::vertex, v);
    for (std::size_t t = 0; t < m; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            check_that(!(f.owned[t] >> (3 + k) & 1) || f.edges_of[t][k] >= 0,
                       "a part's triangle owns an edge that edges_of does not list", Element::triangle, t);
            check_that(!f.lists_points || !(f.owned[t] >> k & 1) || f.points_of[t][k] >= 0,
                       "a part's triangle owns a point that points_of does not list", Element::triangle, t);
        }
    bool lone = false;
    for (const std::uint8_t owned : f.owned) lone = lone || owned & lone_edge;
    check_that(!lone || f.joined.size() == n,
               "a part with edges that belong to no face must have an entry of joined for each vertex");
    if (f.rings == 0) return;
    check_that(f.first_ring.size() == n + 1 && f.first_ring.front() == 0 &&
                   f.first_ring.back() == static_cast<std::int64_t>(f.ring.size()) &&
                   std::is_sorted(f.first_ring.begin(), f.first_ring.end()),
               "a part's first_ring must have ascending offsets into ring for each vertex");
    check_that(std::all_of(f.ring.begin(), f.ring.end(), is_vertex),
               "a part's ring has a vertex that the part does not have");
}

VertexView end_of(const PartFeatures& features) {
    return std::visit(
        [](const auto& xyz) { return rows_of_three(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3)); },
        features.end);
}

void name_globally(const Part& part, FeatureKind kind, Pair& pair) {
    const PartFeatures& f = *part.features;
    const auto vertex = [&](std::int32_t i) { return (f.lists_points ? f.points : f.vertices)[std::size_t(i)]; };
    const auto edge = [&](std::int32_t i) { return f.edges[static_cast<std::size_t>(i)]; };
    switch (kind) {
        case FeatureKind::vertex_face:
            pair = {vertex(pair.a), part.mesh.ids[static_cast<std::size_t>(pair.b)]};
            break;
        case FeatureKind::edge_edge:
            pair = {edge(pair.a), edge(pair.b)};
            break;
        case FeatureKind::vertex_edge:
            pair = {vertex(pair.a), edge(pair.b)};
            break;
        case FeatureKind::vertex_vertex:
            pair = {vertex(pair.a), vertex(pair.b)};
    }
}

}  // namespace crumple
