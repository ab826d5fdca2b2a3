#include "backends/reference/reference_features.h"

#include <map>
#include <set>
#include <vector>

#include "exact/impact/exact_impact.h"
#include "exact/impact/exact_min_distance.h"
#include "exact/integer.h"
#include "exact/proximity/rational_distance.h"
#include "filters/features/feature_points.h"
#include "partition/levels.h"

namespace crumple {
namespace {

using Points = std::vector<std::int32_t>;

// Vertex, edge or face of the scene.
struct ReferenceFeature {
    Points vertices;
    std::int32_t index;
    std::int32_t group;
    std::set<std::int32_t> names;  ///< representatives of its vertices: equal for vertices that welding merges
    Vec3d low, high;               ///< box of its swept volume
    double radius = 0;
    bool lone = true;         ///< on no face, and if it is a vertex, on no edge
    std::int32_t owner = -1;  ///< if the scene is a part (crumple/part.h): triangle of the part that owns it
};

using Ends = std::pair<std::int32_t, std::int32_t>;
Ends ends_of(std::int32_t a, std::int32_t b) { return {std::min(a, b), std::max(a, b)}; }

// All features of a scene: its faces; the edges that the caller lists, or else those of the faces; the points that the
// caller lists, or else the vertices of faces and edges.
class AllFeatures {
   public:
    std::vector<ReferenceFeature> vertices, edges, faces;

    const std::vector<ReferenceFeature>& of(FeatureType type) const {
        return type == FeatureType::vertex ? vertices : type == FeatureType::edge ? edges : faces;
    }

    AllFeatures(const PreparedScene& scene, const FeatureRequest& query) : scene_(scene), query_(query) {
        if (query.part) {
            read_part();
            return;
        }
        for (std::int32_t t = 0; t < query.features.faces(); ++t) {
            const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
            faces.push_back(feature({c[0], c[1], c[2]}, t, t));
            for (int k = 0; k < 3; ++k) {
                const std::int32_t a = c[k], b = c[(k + 1) % 3];
                face_of_vertex_.emplace(a, t);
                if (a != b) face_of_edge_.emplace(ends_of(a, b), t);
            }
        }
        if (query.features.lists_edges())
            for (const Edge& e : query.features.edges()) add_edge(ends_of(e.a, e.b));
        else
            for (const auto& [ends, face] : face_of_edge_) add_edge(ends);
        for (std::int32_t p = 0; p < query.features.points(); ++p) {
            const std::int32_t v = query.features.vertex_of(p);
            if (query.features.lists_points() || face_of_vertex_.count(v) || edges_of_vertex_.count(v))
                add_vertex(v, p);
        }
    }

    /// Returns true if some edge of the vertex has no vertex in common with `edge`.
    bool has_edge_apart(const ReferenceFeature& vertex, const ReferenceFeature& edge) const {
        if (query_.part)
            return query_.features.has_edge_apart(vertex.vertices[0], {edge.vertices[0], edge.vertices[1]});
        const auto at = edges_of_vertex_.find(vertex.vertices[0]);
        if (at == edges_of_vertex_.end()) return false;
        return std::any_of(at->second.begin(), at->second.end(),
                           [&](std::size_t e) { return !incident(edges[e], edge); });
    }
    static bool incident(const ReferenceFeature& a, const ReferenceFeature& b) {
        return std::any_of(a.names.begin(), a.names.end(), [&](std::int32_t v) { return b.names.count(v) > 0; });
    }

   private:
    /// Makes a feature. `face`: the lowest face that contains it, or -1.
    ReferenceFeature feature(Points vertices, std::int32_t index, std::int32_t face) const {
        ReferenceFeature f{std::move(vertices), index, 0, {}, {}, {}, 0, face < 0};
        if (face >= 0)
            f.group = scene_.group(face);
        else if (scene_.lone_groups)
            f.group = scene_.lone_groups[f.vertices[0]];
        for (const std::int32_t v : f.vertices) {
            const MovingPoint p = moving_point(scene_, v);
            const bool first = f.names.empty();
            f.names.insert(query_.features.name(v));
            f.low = min(first ? p.start : f.low, min(p.start, p.end));
            f.high = max(first ? p.start : f.high, max(p.start, p.end));
            if (!query_.radii.empty()) f.radius = std::max(f.radius, query_.radii[static_cast<std::size_t>(v)]);
        }
        return f;
    }
    // Reads the features that the part's triangles own. The owner need not be the lowest triangle of the part that
    // contains the feature.
    void read_part() {
        const SceneFeatures& features = query_.features;
        const auto add = [&](std::vector<ReferenceFeature>& list, Points vertices, std::int32_t index,
                             std::int32_t owner, bool lone) {
            list.push_back(feature(std::move(vertices), index, owner));
            list.back().lone = lone;
            list.back().owner = owner;
        };
        for (std::int32_t t = 0; t < scene_.triangle_count(); ++t) {
            const std::int32_t* c = scene_.corners + 3 * std::int64_t{t};
            const std::uint8_t owned = features.owned(t);
            if (t < features.faces()) add(faces, {c[0], c[1], c[2]}, t, t, false);
            for (int k = 0; k < 3; ++k) {
                if (owned >> k & 1) add(vertices, {c[k]}, features.point_of(t, k), t, owned & lone_point);
                if (!(owned >> (3 + k) & 1)) continue;
                const std::int32_t e = features.edges_of(t)[static_cast<std::size_t>(k)];
                add(edges, {features.edges()[e].a, features.edges()[e].b}, e, t, owned & lone_edge);
            }
        }
        for (auto* list : {&vertices, &edges})
            std::sort(list->begin(), list->end(),
                      [](const ReferenceFeature& f, const ReferenceFeature& g) { return f.index < g.index; });
    }
    void add_edge(const Ends& ends) {
        const auto face = face_of_edge_.find(ends);
        for (const std::int32_t v : {ends.first, ends.second}) edges_of_vertex_[v].push_back(edges.size());
        edges.push_back(feature({ends.first, ends.second}, static_cast<std::int32_t>(edges.size()),
                                face == face_of_edge_.end() ? -1 : face->second));
    }
    void add_vertex(std::int32_t v, std::int32_t index) {
        const auto face = face_of_vertex_.find(v);
        vertices.push_back(feature({v}, index, face == face_of_vertex_.end() ? -1 : face->second));
        vertices.back().lone = vertices.back().lone && !edges_of_vertex_.count(v);
    }

    const PreparedScene& scene_;
    const FeatureRequest& query_;
    std::map<std::int32_t, std::int32_t> face_of_vertex_;
    std::map<Ends, std::int32_t> face_of_edge_;
    std::map<std::int32_t, std::vector<std::size_t>> edges_of_vertex_;
};

/// For each representative vertex: the representative vertices that an edge or a face joins to it, itself included.
using AdjacentVertices = std::map<std::int32_t, std::set<std::int32_t>>;

AdjacentVertices next_of(const AllFeatures& all) {
    AdjacentVertices next;
    for (const auto* features : {&all.edges, &all.faces})
        for (const ReferenceFeature& feature : *features)
            for (const std::int32_t a : feature.names)
                for (const std::int32_t b : feature.names) next[a].insert(b);
    return next;
}

/// Returns true if a path of at most `edges` edges joins a vertex of `from` to one of `to`. A common vertex is a path
/// of 0 edges.
bool joined(const AdjacentVertices& next, std::set<std::int32_t> from, const std::set<std::int32_t>& to,
            std::int32_t edges) {
    for (;; --edges) {
        for (const std::int32_t v : from)
            if (to.count(v) > 0) return true;
        if (edges == 0) return false;
        const std::size_t before = from.size();
        const std::set<std::int32_t> ring = from;
        for (const std::int32_t v : ring)
            if (const auto found = next.find(v); found != next.end())
                from.insert(found->second.begin(), found->second.end());
        if (from.size() == before) return false;
    }
}

class Search {
   public:
    Search(const PreparedScene& scene, const FeatureRequest& query, Cancellation& cancellation, FeatureResult& result,
           FeatureStream* stream)
        : scene_(scene), query_(query), cancellation_(cancellation), result_(result), stream_(stream) {}

    void run() {
        const AllFeatures all(scene_, query_);
        if (query_.criterion == Criterion::candidate) return list_candidates(all);
        if (!query_.part) next_ = next_of(all);
        for (const ReferenceFeature& v : all.vertices)
            for (const ReferenceFeature& f : all.faces) test(FeatureKind::vertex_face, v, f);
        for (std::size_t i = 0; i < all.edges.size(); ++i)
            for (std::size_t j = i + 1; j < all.edges.size(); ++j)
                test(FeatureKind::edge_edge, all.edges[i], all.edges[j]);
        for (const ReferenceFeature& v : all.vertices)
            for (const ReferenceFeature& e : all.edges)
                if (e.lone && !all.has_edge_apart(v, e)) test(FeatureKind::vertex_edge, v, e);
        for (std::size_t i = 0; i < all.vertices.size(); ++i)
            for (std::size_t j = i + 1; j < all.vertices.size(); ++j)
                if (all.vertices[i].lone && all.vertices[j].lone)
                    test(FeatureKind::vertex_vertex, all.vertices[i], all.vertices[j]);
    }

   private:
    void list_candidates(const AllFeatures& all) {
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            const auto kind = static_cast<CandidateKind>(k);
            if (!query_.lists(kind)) continue;
            const FeatureTypes types = types_of(kind);
            for (const ReferenceFeature& a : all.of(types.first)) {
                cancellation_.check();
                for (const ReferenceFeature& b : all.of(types.second)) {
                    if ((types.first == types.second && a.index >= b.index) || !boxes_overlap(a, b)) continue;
                    if (AllFeatures::incident(a, b) && !query_.neighbours) continue;
                    if (!query_.rule(a.group, b.group)) continue;
                    result_.any = true;
                    result_.rows[kind].pairs.push_back({a.index, b.index});
                    pass_on();
                }
            }
        }
    }

    bool boxes_overlap(const ReferenceFeature& a, const ReferenceFeature& b) const {
        for (int axis = 0; axis < 3; ++axis)
            if (exceeds_inflation(a.low[axis], b.high[axis]) || exceeds_inflation(b.low[axis], a.high[axis]))
                return false;
        return true;
    }
    // Returns true if the gap from `high` up to `low` exceeds twice the inflation. The first test needs no exact
    // arithmetic: its factor covers the rounding of the difference.
    bool exceeds_inflation(double low, double high) const {
        if (low <= high) return false;
        if ((low - high) * (1 - 0x1p-50) > 2 * query_.distance) return true;
        const Vec3d numbers{low, high, query_.distance};
        const int exponent = common_exponent({&numbers, 1});
        return in_units(low, exponent) - in_units(high, exponent) > 2 * in_units(query_.distance, exponent);
    }

    // Delivers the rows to the stream if there are enough for a block.
    void pass_on() {
        constexpr std::size_t some_rows = 2048;
        if (stream_ && result_.rows.size() >= some_rows) stream_->add(0, result_.rows);
    }

    void test(FeatureKind kind, const ReferenceFeature& a, const ReferenceFeature& b) {
        if (query_.extent == Extent::any && result_.any) return;
        if (far(a, b)) return;
        if (query_.part ? is_excluded_in_part(a, b)
                        : joined(next_, a.names, b.names, query_.rings ? query_.rings->rings() : 0))
            return;
        if (!query_.rule(a.group, b.group)) return;
        cancellation_.check();
        ++result_.statistics.rational_tests;
        const Row row = decide(kind, a, b);
        if (!row.hit) return;
        result_.any = true;
        const FeatureHit hit{{a.index, b.index}, row.value, row.flag};
        if (query_.criterion == Criterion::impact && query_.extent != Extent::any &&
            (!result_.first.found || row.value < result_.first.toi))
            result_.first = {true, kind, hit.pair, {}, row.value, row.flag};
        if (query_.extent != Extent::all) return;
        result_.rows[kind].push_back(hit);
        pass_on();
    }

    // Returns true if the features are adjacent, or another part owns the pair.
    bool is_excluded_in_part(const ReferenceFeature& a, const ReferenceFeature& b) const {
        if (AllFeatures::incident(a, b) || a.owner == b.owner || !levels_.own(a.owner, b.owner)) return true;
        if (!query_.rings) return false;
        return std::any_of(a.names.begin(), a.names.end(), [&](std::int32_t v) {
            return std::any_of(b.names.begin(), b.names.end(),
                               [&](std::int32_t w) { return query_.rings->joined(v, w); });
        });
    }

    // Returns true if the features' boxes prove them farther apart than the requested distance. For a request with a
    // share of the initial distance, boxes prove nothing. The factor covers the rounding of the difference.
    bool far(const ReferenceFeature& a, const ReferenceFeature& b) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double gap = std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]);
            const double reach = query_.radii.empty() ? query_.distance : a.radius + b.radius;
            if (gap > 0 && gap * (1 - 0x1p-50) > reach) return query_.share == 0;
        }
        return false;
    }

    struct Row {
        bool hit = false;
        double value = 0;
        bool flag = false;
    };
    Row decide(FeatureKind kind, const ReferenceFeature& a, const ReferenceFeature& b) const {
        FeaturePoints p;
        std::size_t n = 0;
        for (const ReferenceFeature* f : {&a, &b})
            for (const std::int32_t v : f->vertices) p[n++] = moving_point(scene_, v);
        if (query_.criterion == Criterion::proximity) {
            const RationalDistance distance(at_start(kind, p));
            const DistanceLimit one{query_.distance, 0, query_.strict}, sum{a.radius, b.radius, query_.strict};
            if (!distance.within(query_.radii.empty() ? one : sum) || close_in_rest_shape(kind, a, b)) return {};
            return {true, distance.squared(), distance.touching()};
        }
        const MinDistance separation{query_.distance, query_.share, query_.approaching_only};
        const Impact impact = separation.contact_only() ? first_contact(kind, p) : first_approach(kind, p, separation);
        if (separation.contact_only() && separation.approaching_only && impact.start) return {};  // cannot come nearer
        return {impact.meets, impact.toi, impact.start};
    }

    static Impact first_contact(FeatureKind kind, const FeaturePoints& p) {
        switch (kind) {
            case FeatureKind::vertex_face:
                return vertex_face(p[0], p[1], p[2], p[3]);
            case FeatureKind::edge_edge:
                return edge_edge(p[0], p[1], p[2], p[3]);
            case FeatureKind::vertex_edge:
                return vertex_edge(p[0], p[1], p[2]);
            case FeatureKind::vertex_vertex:
                break;
        }
        return vertex_vertex(p[0], p[1]);
    }
    static Impact first_approach(FeatureKind kind, const FeaturePoints& p, const MinDistance& separation) {
        switch (kind) {
            case FeatureKind::vertex_face:
                return vertex_face(p[0], p[1], p[2], p[3], separation);
            case FeatureKind::edge_edge:
                return edge_edge(p[0], p[1], p[2], p[3], separation);
            case FeatureKind::vertex_edge:
                return vertex_edge(p[0], p[1], p[2], separation);
            case FeatureKind::vertex_vertex:
                break;
        }
        return vertex_vertex(p[0], p[1], separation);
    }

    bool close_in_rest_shape(FeatureKind kind, const ReferenceFeature& a, const ReferenceFeature& b) const {
        if (!query_.rest || !query_.rest->knows(a.vertices[0], b.vertices[0])) return false;
        Features features{kinds_of(kind), {}};
        std::size_t n = 0;
        for (const ReferenceFeature* f : {&a, &b})
            for (const std::int32_t v : f->vertices) features.point[n++] = query_.rest->position(v);
        return RationalDistance(features).within({query_.rest->radius, 0});
    }

    const PreparedScene& scene_;
    const FeatureRequest& query_;
    Cancellation& cancellation_;
    FeatureResult& result_;
    FeatureStream* stream_;
    const Levels levels_{query_.part};
    AdjacentVertices next_;
};

}  // namespace

void find_features_by_brute_force(const PreparedScene& scene, const FeatureRequest& query, Cancellation& cancellation,
                                  FeatureResult& result, FeatureStream* stream) {
    Search(scene, query, cancellation, result, stream).run();
}

}  // namespace crumple
