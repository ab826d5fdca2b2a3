// Each pair makes one row, in four steps: the vertices of its features; its closest points, from the result or computed
// exactly; weights and normal; and, on request, the reduction to the closest parts. Rows are independent of each other,
// so any thread may make them.

#include "results/stencil_rows.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "crumple/error.h"
#include "exact/proximity/decide_distance.h"
#include "exact/proximity/nearest_parts.h"
#include "filters/features/feature_points.h"
#include "queries/feature_request.h"

namespace crumple {
namespace {

using detail::Vec3dw;
using Points = std::array<Vec3d, 4>;
using Weights = std::array<double, 4>;

constexpr std::size_t pairs_of_task = 512;

/// Distance of impacts that counts as touching, relative to the largest coordinate of the vertices.
constexpr double touching_share = 0x1p-32;
/// Bound on the errors of positions at the time of an impact, relative to the largest coordinate
/// (docs/nearness_algebra.md).
constexpr double error_share = 0x1p-50;
/// Bound on the error of a WeightedSum, relative to its scale.
constexpr double sum_error = 0x1p-48;

struct StencilVertex {
    std::int32_t body;
    std::int64_t vertex;  ///< index within the body
};
using StencilVertices = std::array<StencilVertex, 4>;

double size_of(const Vec3d& v) { return largest(abs(v)); }

/// Vertices of the features that a result lists.
template <class Result>
class FeatureVertices {
   public:
    FeatureVertices(const StencilScene& scene, const Result& found) : scene_(scene), found_(found) {
        const auto fits = [&](const Array<std::int64_t>& first, std::size_t entries) {
            if (entries == 0) return true;
            return first.size() == static_cast<std::size_t>(scene.bodies()) + 1 && first[0] == 0 &&
                   std::is_sorted(first.begin(), first.end()) && first.back() == static_cast<std::int64_t>(entries);
        };
        fits_ = fits(found.first_edge, found.edges.size()) && fits(found.first_point, found.points.size());
    }

    /// Returns false if there are no such features in the scene.
    bool find(FeatureKind kind, const Pair& pair, const BodyPair& bodies, StencilVertices& vertices) const {
        const FeatureTypes types = types_of(kind);
        std::size_t count = 0;
        if (!fits_ || !append(types.first, pair.a, bodies.first, vertices, count)) return false;
        if (!append(types.second, pair.b, bodies.second, vertices, count)) return false;
        for (; count < 4; ++count) vertices[count] = vertices[count - 1];
        return true;
    }

   private:
    bool append(FeatureType type, std::int32_t index, std::int32_t body, StencilVertices& vertices,
                std::size_t& count) const {
        if (body < 0 || body >= scene_.bodies() || index < 0) return false;
        const auto add = [&](std::int64_t vertex) {
            vertices[count++] = {body, vertex};
            return vertex >= 0 && vertex < scene_.vertices(body);
        };
        if (type == FeatureType::face) {
            if (index >= scene_.triangles(body)) return false;
            const auto [a, b, c] = scene_.corners(body, index);
            return add(a) && add(b) && add(c);
        }
        if (type == FeatureType::edge) {
            if (found_.edges.empty() || index >= found_.first_edge[body + 1] - found_.first_edge[body]) return false;
            const Edge edge = found_.edges[found_.first_edge[body] + index];
            return add(edge.a) && add(edge.b);
        }
        if (found_.points.empty() || found_.first_point[body] == found_.first_point[body + 1]) return add(index);
        if (index >= found_.first_point[body + 1] - found_.first_point[body]) return false;
        return add(found_.points[found_.first_point[body] + index]);
    }

    const StencilScene& scene_;
    const Result& found_;
    bool fits_ = true;
};

/// Two features with positions and closest points.
struct NearFeatures {
    FeatureKind kind = FeatureKind::vertex_face;
    StencilVertices vertices{};
    Points points{};
    std::uint8_t type = 0;
    std::array<double, 2> at{};
    double distance = 0;
    bool touching = false;
    double blur = 0;     ///< bound on the errors of `points`
    bool came = false;   ///< true if the features moved before they touched
    Points backwards{};  ///< if `came`: motion of each vertex to the start of the step
};

/// Sum of four vectors with weights. `scale`: bound on the lengths of the terms' sums.
struct WeightedSum {
    Vec3dw vector;
    double scale = 0;

    WeightedSum(const Weights& weights, const Points& x) {
        Vec3d sum{};
        for (std::size_t k = 0; k < 4; ++k) {
            sum = sum + weights[k] * x[k];
            scale = std::max(scale, 4 * size_of(x[k]));
        }
        vector = {{sum.x, 0}, {sum.y, 0}, {sum.z, 0}};
    }
};

/// Makes rows of stencils.
class RowMaker {
   public:
    RowMaker(const StencilScene& scene, const StencilOptions& options) : scene_(scene), options_(options) {}

    void make(const NearFeatures& pair, std::size_t row, Stencils& rows, Array<std::uint8_t>& kinds) const {
        const NearestParts& parts = nearest_parts(kinds_of(pair.kind), pair.type);
        const Weights weights = weights_of(parts, pair.at);
        const auto [normal, from] = normal_of(pair, parts, weights);
        for (std::size_t k = 0; k < 4; ++k) {
            const StencilVertex& v = pair.vertices[k];
            rows.vertices[row][k] = static_cast<std::int32_t>(scene_.first_vertex(v.body) + v.vertex);
        }
        rows.weights[row] = weights;
        rows.normals[row] = {normal.x, normal.y, normal.z};
        rows.distance[row] = pair.distance;
        rows.normal_from[row] = static_cast<std::uint8_t>(from);
        rows.type[row] = pair.type;
        kinds[row] = static_cast<std::uint8_t>(pair.kind);
        if (options_.reduced && !stays_whole(pair, rows.vertices[row])) reduce(parts, row, rows, kinds[row]);
    }

   private:
    std::pair<Vec3d, NormalFrom> normal_of(const NearFeatures& pair, const NearestParts& parts,
                                           const Weights& weights) const {
        constexpr Vec3d none{};
        const PartDirections along(parts, pair.points, pair.touching ? pair.blur : 0);
        if (!pair.touching) {
            const auto at = [&](const NearestPart& part) { return pair.points[part.point[0]]; };
            const Vec3dw apart = detail::exact_difference(at(parts.first), at(parts.second));
            const Vec3d normal = along.perpendicular(apart, 2 * size_of(detail::high(apart)), 0);
            if (normal != none) return {normal, NormalFrom::apart};
        }
        std::array<std::optional<Points>, 2> earlier;
        if (pair.came) earlier[0] = pair.backwards;
        if (scene_.before()) earlier[1] = relative(*scene_.before(), pair);
        for (const std::optional<Points>& points : earlier) {
            if (!points) continue;
            const WeightedSum sum(weights, *points);
            const Vec3d normal = along.perpendicular(sum.vector, sum.scale, sum_error);
            if (normal != none) return {normal, NormalFrom::before};
        }
        if (scene_.rest()) {
            const Points rest = relative(*scene_.rest(), pair);
            const WeightedSum sum(weights, rest);
            const int side = PartDirections(parts, rest).side(sum.vector, sum.scale, sum_error);
            const Vec3d normal = static_cast<double>(side) * along.across();
            if (normal != none) return {normal, NormalFrom::rest};
        }
        return {none, NormalFrom::none};
    }

    /// Returns positions relative to that of the first vertex, to keep errors of sums small.
    Points relative(const VertexReader& read, const NearFeatures& pair) const {
        Points x;
        for (std::size_t k = 0; k < 4; ++k)
            x[k] = read(scene_.first_vertex(pair.vertices[k].body) + pair.vertices[k].vertex);
        for (std::size_t k = 4; k-- > 0;) x[k] = x[k] - x[0];
        return x;
    }

    bool stays_whole(const NearFeatures& pair, const std::array<std::int32_t, 4>& vertices) const {
        if (pair.kind != FeatureKind::edge_edge || !(options_.parallel > 0)) return false;
        const auto edges = [](const Points& x) { return std::pair(x[1] - x[0], x[3] - x[2]); };
        const auto square = [](const Vec3d& v) { return dot(v, v); };
        Points rest = pair.points;
        if (scene_.rest()) std::transform(vertices.begin(), vertices.end(), rest.begin(), *scene_.rest());
        const auto now = edges(pair.points), then = edges(rest);
        return square(cross(now.first, now.second)) < options_.parallel * square(then.first) * square(then.second);
    }

    /// Replaces a row by that of its closest parts, in the order that all equal rows share: a vertex first, vertices of
    /// an edge and two single vertices ascending.
    static void reduce(const NearestParts& parts, std::size_t row, Stencils& rows, std::uint8_t& kind) {
        const std::array<std::int32_t, 4> vertices = rows.vertices[row];
        const Weights weights = rows.weights[row];
        const std::size_t m = parts.first.points, n = parts.second.points;
        if (m + n == 4) return;
        const auto first = parts.first.point, second = parts.second.point;
        const bool swap = m > n || (m == n && vertices[first[0]] > vertices[second[0]]);
        std::array<std::uint8_t, 4> order{swap ? second[0] : first[0], swap ? first[0] : second[0]};
        if (m + n == 3) {
            order[2] = swap ? first[1] : second[1];
            if (vertices[order[1]] > vertices[order[2]]) std::swap(order[1], order[2]);
        }
        for (std::size_t k = m + n; k < 4; ++k) order[k] = order[m + n - 1];
        for (std::size_t k = 0; k < 4; ++k) {
            rows.vertices[row][k] = vertices[order[k]];
            rows.weights[row][k] = k < m + n ? (swap ? -weights[order[k]] : weights[order[k]]) : 0;
        }
        if (swap)
            for (double& coordinate : rows.normals[row]) coordinate = 0 - coordinate;
        kind = static_cast<std::uint8_t>(m + n == 3 ? FeatureKind::vertex_edge : FeatureKind::vertex_vertex);
        rows.type[row] = static_cast<std::uint8_t>(types_of_nearest_parts[kind] - 1);
    }

    const StencilScene& scene_;
    const StencilOptions& options_;
};

bool place(const StencilScene& scene, const ProximityList& list, std::size_t i, NearFeatures& pair) {
    for (std::size_t k = 0; k < 4; ++k) pair.points[k] = scene.start(pair.vertices[k].body, pair.vertices[k].vertex);
    if (!std::all_of(pair.points.begin(), pair.points.end(), all_finite)) return false;
    pair.distance = std::sqrt(list.squared_distance[i]);
    pair.touching = list.touching[i] != 0;
    if (list.type.size() == list.pairs.size() && list.at.size() == list.pairs.size()) {
        pair.type = list.type[i];
        pair.at = list.at[i];
        return pair.type < types_of_nearest_parts[static_cast<std::size_t>(pair.kind)];
    }
    DistanceCounts counts;
    const ClosestPoints closest = Distance({kinds_of(pair.kind), pair.points}, counts).closest();
    pair.type = closest.type;
    pair.at = closest.at;
    return true;
}

bool place(const StencilScene& scene, const ImpactList& list, std::size_t i, NearFeatures& pair) {
    const double t = list.toi[i];
    double size = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vec3d start = scene.start(pair.vertices[k].body, pair.vertices[k].vertex);
        const Vec3d end = scene.end(pair.vertices[k].body, pair.vertices[k].vertex);
        pair.points[k] = t == 0 ? start : t == 1 ? end : (1 - t) * start + t * end;
        pair.backwards[k] = start - end;
        size = std::max({size, size_of(start), size_of(end)});
    }
    if (!std::all_of(pair.points.begin(), pair.points.end(), all_finite)) return false;
    DistanceCounts counts;
    Distance distance({kinds_of(pair.kind), pair.points}, counts);
    const ClosestPoints closest = distance.closest();
    pair.type = closest.type;
    pair.at = closest.at;
    pair.distance = std::sqrt(distance.squared());
    pair.touching = pair.distance <= touching_share * size;
    pair.blur = error_share * size;
    pair.came = list.start[i] == 0;
    return true;
}

bool has_all_columns(const ProximityList& list) {
    return list.squared_distance.size() == list.pairs.size() && list.touching.size() == list.pairs.size();
}
bool has_all_columns(const ImpactList& list) {
    return list.toi.size() == list.pairs.size() && list.start.size() == list.pairs.size();
}

void resize(std::size_t size, Stencils& rows) {
    rows.vertices.resize_discard(size);
    rows.weights.resize_discard(size);
    rows.normals.resize_discard(size);
    rows.distance.resize_discard(size);
    rows.normal_from.resize_discard(size);
    rows.type.resize_discard(size);
}

/// Sorts rows by kind and vertices, and merges equal ones into the first of them.
Stencils merged(const Stencils& rows, const Array<std::uint8_t>& kinds) {
    const auto key = [&](std::int64_t i) { return std::tie(kinds[i], rows.vertices[i]); };
    Array<std::int64_t> order;
    order.resize_discard(rows.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](std::int64_t i, std::int64_t j) { return std::pair(key(i), i) < std::pair(key(j), j); });
    Stencils result;
    resize(rows.size(), result);
    result.row_of_pair.resize_discard(rows.size());
    result.multiplicity.reserve(rows.size());
    std::size_t count = 0;
    for (std::size_t i = 0; i < order.size(); ++i) {
        const std::int64_t from = order[i];
        if (i == 0 || key(from) != key(order[i - 1])) {
            result.vertices[count] = rows.vertices[from];
            result.weights[count] = rows.weights[from];
            result.normals[count] = rows.normals[from];
            result.distance[count] = rows.distance[from];
            result.normal_from[count] = rows.normal_from[from];
            result.type[count] = rows.type[from];
            result.multiplicity.push_back(0);
            ++count;
            for (std::size_t k = kinds[from]; k < feature_kinds; ++k) ++result.first[k + 1];
        }
        ++result.multiplicity[count - 1];
        result.row_of_pair[from] = static_cast<std::int64_t>(count) - 1;
    }
    resize(count, result);
    return result;
}

template <class Result>
Stencils make(const StencilScene& scene, const Result& found, const StencilOptions& options, ParallelFor& workers) {
    const FeatureVertices<Result> features(scene, found);
    const RowMaker maker(scene, options);
    Stencils rows;
    for (std::size_t k = 0; k < feature_kinds; ++k)
        rows.first[k + 1] = rows.first[k] + static_cast<std::int64_t>(found.lists[k].pairs.size());
    const auto size = static_cast<std::size_t>(rows.first.back());
    resize(size, rows);
    Array<std::uint8_t> kinds;
    kinds.resize_discard(size);
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto& list = found.lists[k];
        const auto refuse = [&](std::size_t i) {
            throw Error(ErrorCode::invalid_argument,
                        "pair " + std::to_string(i) + " of kind " +
                            std::string(feature_kind_name(static_cast<FeatureKind>(k))) +
                            " does not fit the scene: a feature does not exist, or a position is not finite");
        };
        const std::size_t pairs = list.pairs.size();
        if (!has_all_columns(list) || (!list.bodies.empty() && list.bodies.size() != pairs)) refuse(0);
        std::atomic<std::size_t> misfit{pairs};
        workers.parallel_for((pairs + pairs_of_task - 1) / pairs_of_task, [&](std::size_t task) {
            const std::size_t end = std::min(pairs, (task + 1) * pairs_of_task);
            for (std::size_t i = task * pairs_of_task; i < end; ++i) {
                NearFeatures pair;
                pair.kind = static_cast<FeatureKind>(k);
                const BodyPair bodies = list.bodies.empty() ? BodyPair{} : list.bodies[i];
                if (features.find(pair.kind, list.pairs[i], bodies, pair.vertices) && place(scene, list, i, pair)) {
                    maker.make(pair, static_cast<std::size_t>(rows.first[k]) + i, rows, kinds);
                    continue;
                }
                std::size_t before = misfit;
                while (i < before && !misfit.compare_exchange_weak(before, i)) {
                }
            }
        });
        if (misfit < pairs) refuse(misfit);
    }
    if (options.reduced) rows = merged(rows, kinds);
    rows.first_vertex.resize_discard(static_cast<std::size_t>(scene.bodies()) + 1);
    for (std::int32_t b = 0; b <= scene.bodies(); ++b) rows.first_vertex[b] = scene.first_vertex(b);
    return rows;
}

}  // namespace

Stencils make_stencils(const StencilScene& scene, const Proximities& found, const StencilOptions& options,
                       ParallelFor& workers) {
    return make(scene, found, options, workers);
}
Stencils make_stencils(const StencilScene& scene, const Impacts& found, const StencilOptions& options,
                       ParallelFor& workers) {
    return make(scene, found, options, workers);
}

}  // namespace crumple
