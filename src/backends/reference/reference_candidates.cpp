#include "backends/reference/reference_candidates.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "exact/integer.h"

namespace crumple {
namespace {

struct Feature {
    std::int32_t index, group;
    std::set<std::int32_t> names;  ///< of its vertices
    Vec3d low, high;               ///< box of its way
};

class Search {
   public:
    Search(const PreparedScene& scene, const CandidateRequest& query, Cancellation& cancellation, CandidateSink sink)
        : scene_(scene), query_(query), cancellation_(cancellation), sink_(sink) {
        std::map<std::int32_t, std::int32_t> face_of_vertex;
        std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> face_of_edge;
        for (std::int32_t t = 0; t < query.features.faces(); ++t) {
            const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
            of(FeatureType::face).push_back(feature(t, t, {c[0], c[1], c[2]}));
            for (int k = 0; k < 3; ++k) {
                const std::int32_t a = c[k], b = c[(k + 1) % 3];
                face_of_vertex.emplace(a, t);
                if (a != b) face_of_edge.emplace(std::minmax(a, b), t);
            }
        }
        std::set<std::int32_t> on_edges;
        const auto add_edge = [&](std::int32_t a, std::int32_t b) {
            auto& edges = of(FeatureType::edge);
            const auto face = face_of_edge.find(std::minmax(a, b));
            edges.push_back(feature(static_cast<std::int32_t>(edges.size()),
                                    face == face_of_edge.end() ? -1 : face->second, {std::min(a, b), std::max(a, b)}));
            on_edges.insert({a, b});
        };
        if (query.features.lists_edges())
            for (const Edge& e : query.features.edges()) add_edge(e.a, e.b);
        else
            for (const auto& [ends, face] : face_of_edge) add_edge(ends.first, ends.second);
        for (std::int32_t p = 0; p < query.features.points(); ++p) {
            const std::int32_t v = query.features.vertex_of(p);
            const auto face = face_of_vertex.find(v);
            if (query.features.lists_points() || face != face_of_vertex.end() || on_edges.count(v) > 0)
                of(FeatureType::vertex).push_back(feature(p, face == face_of_vertex.end() ? -1 : face->second, {v}));
        }
    }

    void run() {
        for (std::size_t k = 0; k < candidate_kinds; ++k) {
            const auto kind = static_cast<CandidateKind>(k);
            if (!query_.wants(kind)) continue;
            const FeatureTypes types = types_of(kind);
            for (const Feature& a : of(types.first)) {
                cancellation_.check();
                for (const Feature& b : of(types.second)) {
                    if ((types.first == types.second && a.index >= b.index) || !candidate(a, b)) continue;
                    const Pair pair{a.index, b.index};
                    sink_(kind, pair);
                }
            }
        }
    }

   private:
    std::vector<Feature>& of(FeatureType type) { return features_[static_cast<std::size_t>(type)]; }

    /// `face`: the lowest that names it, or -1.
    Feature feature(std::int32_t index, std::int32_t face, std::initializer_list<std::int32_t> vertices) const {
        const std::int32_t vertex = *vertices.begin();
        const Vec3d first = scene_.position(vertex);
        Feature f{index, 0, {}, first, first};
        if (face >= 0)
            f.group = scene_.group(face);
        else if (scene_.lone_groups)
            f.group = scene_.lone_groups[vertex];
        for (const std::int32_t v : vertices) {
            f.names.insert(query_.features.name(v));
            for (const Vec3d& p : {scene_.position(v), scene_.end_position(v)})
                f.low = min(f.low, p), f.high = max(f.high, p);
        }
        return f;
    }

    bool candidate(const Feature& a, const Feature& b) const {
        for (int axis = 0; axis < 3; ++axis)
            if (far(a.low[axis], b.high[axis]) || far(b.low[axis], a.high[axis])) return false;
        const auto in_b = [&](std::int32_t name) { return b.names.count(name) > 0; };
        return std::none_of(a.names.begin(), a.names.end(), in_b) && query_.rule(a.group, b.group);
    }

    // Whether the gap exceeds twice the inflation. A difference is rounded by less than the factor, so that most need
    // no other arithmetic.
    bool far(double low, double high) const {
        if (low <= high) return false;
        if ((low - high) * (1 - 0x1p-50) > 2 * query_.inflation) return true;
        const Vec3d numbers{low, high, query_.inflation};
        const int exponent = common_exponent({&numbers, 1});
        return scaled(low, exponent) - scaled(high, exponent) > 2 * scaled(query_.inflation, exponent);
    }

    const PreparedScene& scene_;
    const CandidateRequest& query_;
    Cancellation& cancellation_;
    CandidateSink sink_;
    std::vector<Feature> features_[3];  ///< by FeatureType
};

}  // namespace

void find_candidates_by_brute_force(const PreparedScene& scene, const CandidateRequest& query,
                                    Cancellation& cancellation, CandidateSink sink) {
    Search(scene, query, cancellation, sink).run();
}

}  // namespace crumple
