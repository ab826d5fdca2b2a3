#include "engine/reference/features.h"

#include <map>
#include <set>
#include <vector>

#include "questions/features/points.h"
#include "questions/motion/rational_impact.h"
#include "questions/motion/rational_separation.h"
#include "questions/near/rational_distance.h"

namespace crumple {
namespace {

using Points = std::vector<std::int32_t>;

// A feature by its vertices.
struct Feature {
    Points vertices;
    std::int32_t index, owner;  ///< the lowest triangle that names it
    std::set<std::int32_t> names;
    Vec3d low, high;  ///< box of its way
};

Feature feature(const Scene& scene, const FeatureQuery& query, Points vertices, std::int32_t index,
                std::int32_t owner) {
    Feature f{std::move(vertices), index, owner, {}, {}, {}};
    for (const std::int32_t v : f.vertices) {
        const MovingPoint p = moving_point(scene, v);
        const bool first = f.names.empty();
        f.names.insert(query.features.name(v));
        f.low = min(first ? p.start : f.low, min(p.start, p.end));
        f.high = max(first ? p.start : f.high, max(p.start, p.end));
    }
    return f;
}

struct Everything {
    std::vector<Feature> vertices, edges, faces;

    Everything(const Scene& scene, const FeatureQuery& query) {
        std::map<std::int32_t, std::int32_t> owner_of_vertex;
        std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> owner_of_edge;
        for (std::int32_t t = 0; t < scene.triangle_count(); ++t) {
            const std::int32_t* c = scene.corners + 3 * std::int64_t{t};
            faces.push_back(feature(scene, query, {c[0], c[1], c[2]}, t, t));
            for (int k = 0; k < 3; ++k) {
                const std::int32_t a = c[k], b = c[(k + 1) % 3];
                owner_of_vertex.emplace(a, t);
                if (a != b) owner_of_edge.emplace(std::minmax(a, b), t);
            }
        }
        for (const auto& [v, owner] : owner_of_vertex) vertices.push_back(feature(scene, query, {v}, v, owner));
        for (const auto& [e, owner] : owner_of_edge)
            edges.push_back(feature(scene, query, {e.first, e.second}, static_cast<std::int32_t>(edges.size()), owner));
    }
};

class Search {
   public:
    Search(const Scene& scene, const FeatureQuery& query, Cancellation& cancellation, FeatureAnswer& answer)
        : scene_(scene), query_(query), cancellation_(cancellation), answer_(answer) {}

    void run() {
        const Everything all(scene_, query_);
        for (const Feature& v : all.vertices)
            for (const Feature& f : all.faces) test(FeatureKind::vertex_face, v, f);
        for (std::size_t i = 0; i < all.edges.size(); ++i)
            for (std::size_t j = i + 1; j < all.edges.size(); ++j)
                test(FeatureKind::edge_edge, all.edges[i], all.edges[j]);
    }

   private:
    void test(FeatureKind kind, const Feature& a, const Feature& b) {
        if (query_.extent == Extent::any && answer_.any) return;
        if (far(a, b)) return;
        if (std::any_of(a.names.begin(), a.names.end(), [&](std::int32_t v) { return b.names.count(v) > 0; })) return;
        if (!query_.rule(scene_.group(a.owner), scene_.group(b.owner))) return;
        cancellation_.check();
        ++answer_.statistics.rational_tests;
        const Row row = decide(kind, a, b);
        if (!row.hit) return;
        answer_.any = true;
        const Pair pair{a.index, b.index};
        if (query_.motion && query_.extent != Extent::any && (!answer_.first.found || row.value < answer_.first.toi))
            answer_.first = {true, kind, pair, {}, row.value, row.flag};
        if (query_.extent != Extent::all) return;
        FeatureRows& rows = answer_.rows[static_cast<std::size_t>(kind)];
        rows.pairs.push_back(pair);
        rows.value.push_back(row.value);
        rows.flag.push_back(row.flag);
    }

    // Certain: a difference of numbers is rounded by less than the factor.
    bool far(const Feature& a, const Feature& b) const {
        for (int axis = 0; axis < 3; ++axis) {
            const double gap = std::max(a.low[axis] - b.high[axis], b.low[axis] - a.high[axis]);
            if (gap > 0 && gap * (1 - 0x1p-50) > query_.distance) return query_.share == 0;
        }
        return false;
    }

    struct Row {
        bool hit = false;
        double value = 0;
        bool flag = false;
    };
    Row decide(FeatureKind kind, const Feature& a, const Feature& b) const {
        FeaturePoints p;
        std::size_t n = 0;
        for (const Feature* f : {&a, &b})
            for (const std::int32_t v : f->vertices) p[n++] = moving_point(scene_, v);
        if (!query_.motion) {
            const RationalDistance distance(at_start(kind, p));
            if (!distance.within({query_.distance, 0, query_.strict})) return {};
            return {true, distance.squared(), distance.touching()};
        }
        const Separation separation{query_.distance, query_.share};
        const bool plain = query_.distance == 0 && query_.share == 0, face = kind == FeatureKind::vertex_face;
        const Impact impact = plain  ? (face ? vertex_face(p[0], p[1], p[2], p[3]) : edge_edge(p[0], p[1], p[2], p[3]))
                              : face ? vertex_face(p[0], p[1], p[2], p[3], separation)
                                     : edge_edge(p[0], p[1], p[2], p[3], separation);
        return {impact.meets, impact.toi, impact.start};
    }

    const Scene& scene_;
    const FeatureQuery& query_;
    Cancellation& cancellation_;
    FeatureAnswer& answer_;
};

}  // namespace

void find_features_by_brute_force(const Scene& scene, const FeatureQuery& query, Cancellation& cancellation,
                                  FeatureAnswer& answer) {
    Search(scene, query, cancellation, answer).run();
}

}  // namespace crumple
