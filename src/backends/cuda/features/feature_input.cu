#include "backends/cuda/features/feature_input.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "backends/cuda/stages/positions.h"
#include "crumple/error.h"

namespace crumple::cuda {
namespace {

__device__ bool is_finite(double x) { return std::abs(x) <= 1.7976931348623157e308; }

// Check the radii and rest positions that the caller has on the device. rest_kernel() also copies the positions to
// `rest`, in float64.
__global__ void check_radii_kernel(const double* radius, std::size_t n, Counters* counters) {
    for (std::size_t v = grid_thread(); v < n; v += grid_stride())
        if (!(radius[v] >= 0 && is_finite(radius[v])))
            atomicMin(&counters->bad_radius, static_cast<unsigned long long>(v));
}
template <bool aligned>
__global__ void rest_kernel(VertexReader read, std::size_t n, double* rest, Counters* counters) {
    for (std::size_t v = grid_thread(); v < n; v += grid_stride()) {
        const Vec3d p = detail::read<aligned>(read, v);
        if (!(is_finite(p.x) && is_finite(p.y) && is_finite(p.z)))
            atomicMin(&counters->bad_rest, static_cast<unsigned long long>(v));
        for (int axis = 0; axis < 3; ++axis) rest[3 * v + static_cast<std::size_t>(axis)] = p[axis];
    }
}

}  // namespace

FirstOfKind firsts_of(const FeatureRequest& query) {
    FirstOfKind firsts;
    std::int64_t base = 0;
    for (std::size_t k = 0; k < candidate_kinds; ++k) {
        const auto kind = static_cast<CandidateKind>(k);
        if (query.lists(kind)) base += count_of(query.features, types_of(kind).first);
        if (base > std::numeric_limits<std::int32_t>::max())
            throw Error(ErrorCode::invalid_argument,
                        "the cuda backend supports at most 2147483647 features that come first in a pair");
        firsts.base[k + 1] = static_cast<std::uint32_t>(base);
    }
    return firsts;
}

void FeaturesOnDevice::replace(Growth growth) const {
    if (growth == Growth::fixed) throw CapacityError{};
    launches_in_flight_.synchronize();
}

const FeatureTable& FeaturesOnDevice::bring(const SceneFeatures& features, std::int64_t vertices, Growth growth) {
    if (block_.data() && known_.revision == features.revision()) return table_;
    replace(growth);
    const FeatureTable host = features.table();
    const auto triangles = static_cast<std::size_t>(features.faces() + features.proxies());
    const auto named = static_cast<std::size_t>(vertices);
    const std::size_t edge_count = features.edges().size(), point_count = features.codimensional_points().size();
    TriangleEdges* edges_of = nullptr;
    std::uint8_t* owned = nullptr;
    std::int32_t *corners = nullptr, *names = nullptr, *points = nullptr;
    PointsOfTriangle* points_of = nullptr;
    AdjacentVertices* neighbours = nullptr;
    Edge* edges = nullptr;
    known_ = {};
    place_arrays(block_, [&](ArenaLayout& c) {
        edges_of = c.take<TriangleEdges>(triangles);
        owned = c.take<std::uint8_t>(triangles);
        corners = c.take<std::int32_t>(3 * triangles);
        names = c.take<std::int32_t>(host.names ? named : 0);
        points_of = c.take<PointsOfTriangle>(host.points_of ? triangles : 0);
        neighbours = c.take<AdjacentVertices>(host.neighbours ? named : 0);
        edges = c.take<Edge>(edge_count);
        points = c.take<std::int32_t>(point_count);
    });
    const auto copy = [&](auto* to, const auto* from, std::size_t n) {
        if (from) copy_now(stream_, to, from, n, cudaMemcpyHostToDevice);
    };
    copy(edges_of, host.edges_of, triangles);
    copy(owned, host.owned, triangles);
    copy(corners, host.corners, 3 * triangles);
    copy(names, host.names, named);
    copy(points_of, host.points_of, triangles);
    copy(neighbours, host.neighbours, named);
    copy(edges, features.edges().data(), edge_count);
    copy(points, features.codimensional_points().data(), point_count);
    table_ = {edges_of,
              owned,
              corners,
              host.names ? names : nullptr,
              host.points_of ? points_of : nullptr,
              host.neighbours ? neighbours : nullptr,
              host.faces};
    known_ = {corners,
              features.faces(),
              features.proxies(),
              edges,
              static_cast<std::int64_t>(edge_count),
              points,
              static_cast<std::int64_t>(point_count),
              features.revision()};
    return table_;
}

RingTable FeaturesOnDevice::bring(const VertexRings* rings, Growth growth) {
    if (!rings) return {};
    if (ring_table_.of && rings_revision_ == rings->revision()) return ring_table_;
    replace(growth);
    const auto of = rings->rings_of_all();
    const auto first = rings->firsts();
    std::int32_t* others = nullptr;
    std::int64_t* firsts = nullptr;
    ring_table_ = {};
    place_arrays(rings_, [&](ArenaLayout& c) {
        firsts = c.take<std::int64_t>(first.size());
        others = c.take<std::int32_t>(std::max<std::size_t>(1, of.size()));
    });
    copy_now(stream_, firsts, first.data(), first.size(), cudaMemcpyHostToDevice);
    copy_now(stream_, others, of.data(), of.size(), cudaMemcpyHostToDevice);
    ring_table_ = {others, firsts};
    rings_revision_ = rings->revision();
    return ring_table_;
}

void FeaturesOnDevice::release() {
    block_.release();
    rings_.release();
    ring_table_ = {};
    known_ = {};
}

void FeatureInput::tell(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features,
                        Growth growth) {
    all_kinds_ = !query.features.plain();
    firsts_ = firsts_of(query);
    asked_ = {};
    asked_.motion = query.criterion == Criterion::impact;
    asked_.strict = query.strict;
    asked_.distance = query.distance;
    asked_.share = query.share;
    asked_.approaching_only = query.approaching_only;
    asked_.rings = features.bring(query.rings, growth);
    asked_.features = features.bring(query.features, scene.vertex_count(), growth);
}

void FeatureInput::place_values(const PreparedScene& scene, const FeatureRequest& query, bool viewed, Growth growth) {
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    const bool radii = !query.radii.empty(), body = query.rest && query.rest->body;
    viewed_ = viewed;
    place_arrays(
        block_,
        [&](ArenaLayout& c) {
            inflation_ = c.take<Inflation>(1);
            radius_ = c.take<double>(radii && !viewed ? vertices : 0);
            vertex_radius_ = c.take<float>(radii ? vertices : 0);
            triangle_radius_ = c.take<float>(radii ? static_cast<std::size_t>(scene.triangle_count()) : 0);
            resting_ = c.take<double>(query.rest ? 3 * vertices : 0);
            bodies_ = c.take<std::int32_t>(body ? vertices : 0);
        },
        growth);
    asked_.inflation = inflation_;
    asked_.radii = !radii ? nullptr : viewed ? query.radii.data() : radius_;
    asked_.vertex_radius = radii ? vertex_radius_ : nullptr;
    asked_.triangle_radius = radii ? triangle_radius_ : nullptr;
    if (query.rest) asked_.rest = {resting_, body ? bodies_ : nullptr, query.rest->radius};
}

void FeatureInput::view(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features,
                        Growth growth) {
    tell(scene, query, features, growth);
    place_values(scene, query, true, growth);
    given_rest_ = query.rest ? query.rest->position : VertexReader{};
}

void FeatureInput::bring(const PreparedScene& scene, const FeatureRequest& query, FeaturesOnDevice& features) {
    tell(scene, query, features, Growth::grows);
    place_values(scene, query, false, Growth::grows);
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    if (asked_.radii) copy_now(stream_, radius_, query.radii.data(), vertices, cudaMemcpyHostToDevice);
    if (!query.rest) return;
    rest_.resize_discard(3 * vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto vertex = static_cast<std::int32_t>(v);
        const Vec3d p = query.rest->knows(vertex, vertex) ? query.rest->position(vertex) : Vec3d{};
        for (int axis = 0; axis < 3; ++axis) rest_[3 * v + static_cast<std::size_t>(axis)] = p[axis];
    }
    copy_now(stream_, resting_, rest_.data(), 3 * vertices, cudaMemcpyHostToDevice);
    if (asked_.rest.body) copy_now(stream_, bodies_, query.rest->body, vertices, cudaMemcpyHostToDevice);
}

void FeatureInput::enqueue(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene,
                           const SceneBox* box, Counters* counters) const {
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    const Launch over_vertices{stream, geometry.blocks(vertices), geometry.threads};
    if (viewed_ && asked_.radii) over_vertices(check_radii_kernel, asked_.radii, vertices, counters);
    if (viewed_ && asked_.rest.position)
        over_vertices(is_aligned(given_rest_) ? rest_kernel<true> : rest_kernel<false>, given_rest_, vertices, resting_,
                      counters);
    if (asked_.radii) normalise_radii(geometry, stream, scene, box, asked_.radii, vertex_radius_, triangle_radius_);
    make_inflation(stream, box, asked_.distance, asked_.share, asked_.triangle_radius, inflation_);
}

void FeatureInput::release() {
    block_.release();
    rest_.release();
}

}  // namespace crumple::cuda
