#include "questions/features/cuda/input.h"

#include <limits>

#include "crumple/error.h"

namespace crumple::cuda {
namespace {

FirstOfKind firsts_of(const SceneFeatures& features, std::int64_t edges) {
    FirstOfKind firsts;
    std::int64_t base = 0;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        base += types_of(static_cast<FeatureKind>(k)).first == FeatureType::edge ? edges : features.points();
        check_joint_number(base);
        firsts.base[k + 1] = static_cast<std::uint32_t>(base);
        if (k == 1 && features.plain())  // the other lists stay empty
            return firsts.base[3] = firsts.base[4] = firsts.base[2], firsts;
    }
    return firsts;
}

}  // namespace

void check_joint_number(std::int64_t features) {
    if (features > std::numeric_limits<std::int32_t>::max())
        throw Error(ErrorCode::invalid_argument,
                    "the cuda backend numbers at most 2147483647 features that come first in a pair");
}

void FeatureInput::bring(const Scene& scene, const FeatureQuery& query) {
    bring_rings(query.rings);
    bring_values(scene, query);
    all_kinds_ = !query.features.plain();
    firsts_ = firsts_of(query.features, static_cast<std::int64_t>(query.features.edges().size()));
    asked_.motion = query.motion;
    asked_.strict = query.strict;
    asked_.distance = query.distance;
    asked_.share = query.share;
    asked_.rings = ring_table_;
    asked_.features = features_.bring(query.features, scene.vertex_count());
}

const FeatureTable& FeaturesOnDevice::bring(const SceneFeatures& features, std::int64_t vertices) {
    if (block_.data() && revision_ == features.revision()) return table_;
    const FeatureTable host = features.table();
    const auto triangles = static_cast<std::size_t>(features.faces() + features.carriers());
    const auto named = static_cast<std::size_t>(vertices);
    TriangleEdges* edges = nullptr;
    std::uint8_t* owned = nullptr;
    std::int32_t *corners = nullptr, *names = nullptr;
    PointsOfTriangle* points = nullptr;
    NamedNeighbours* neighbours = nullptr;
    lay_out(block_, [&](Cutter& c) {
        edges = c.take<TriangleEdges>(triangles);
        owned = c.take<std::uint8_t>(triangles);
        corners = c.take<std::int32_t>(3 * triangles);
        names = c.take<std::int32_t>(host.names ? named : 0);
        points = c.take<PointsOfTriangle>(host.points_of ? triangles : 0);
        neighbours = c.take<NamedNeighbours>(host.neighbours ? named : 0);
    });
    const auto copy = [&](auto* to, const auto* from, std::size_t n) {
        if (from) copy_now(stream_, to, from, n, cudaMemcpyHostToDevice);
    };
    copy(edges, host.edges_of, triangles);
    copy(owned, host.owned, triangles);
    copy(corners, host.corners, 3 * triangles);
    copy(names, host.names, named);
    copy(points, host.points_of, triangles);
    copy(neighbours, host.neighbours, named);
    table_ = {edges,
              owned,
              corners,
              host.names ? names : nullptr,
              host.points_of ? points : nullptr,
              host.neighbours ? neighbours : nullptr,
              host.faces};
    revision_ = features.revision();
    return table_;
}

void FeatureInput::bring_rings(const VertexRings* rings) {
    if (!rings) {
        ring_table_ = {};
        return;
    }
    if (ring_table_.of && rings_revision_ == rings->revision()) return;
    const auto of = rings->rings_of_all();
    const auto first = rings->firsts();
    std::int32_t* others = nullptr;
    std::int64_t* firsts = nullptr;
    lay_out(rings_, [&](Cutter& c) {
        firsts = c.take<std::int64_t>(first.size());
        others = c.take<std::int32_t>(std::max<std::size_t>(1, of.size()));
    });
    copy_now(stream_, firsts, first.data(), first.size(), cudaMemcpyHostToDevice);
    copy_now(stream_, others, of.data(), of.size(), cudaMemcpyHostToDevice);
    ring_table_ = {others, firsts};
    rings_revision_ = rings->revision();
}

// What may be another in each call.
void FeatureInput::bring_values(const Scene& scene, const FeatureQuery& query) {
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    const bool radii = !query.radii.empty(), body = query.rest && query.rest->body;
    double *radius = nullptr, *rest = nullptr;
    std::int32_t* bodies = nullptr;
    lay_out(values_, [&](Cutter& c) {
        inflation_ = c.take<Inflation>(1);
        radius = c.take<double>(radii ? vertices : 0);
        vertex_radius_ = c.take<float>(radii ? vertices : 0);
        triangle_radius_ = c.take<float>(radii ? static_cast<std::size_t>(scene.triangle_count()) : 0);
        rest = c.take<double>(query.rest ? 3 * vertices : 0);
        bodies = c.take<std::int32_t>(body ? vertices : 0);
    });
    asked_.inflation = inflation_;
    asked_.radii = radii ? radius : nullptr;
    asked_.vertex_radius = radii ? vertex_radius_ : nullptr;
    asked_.triangle_radius = radii ? triangle_radius_ : nullptr;
    if (radii) copy_now(stream_, radius, query.radii.data(), vertices, cudaMemcpyHostToDevice);
    asked_.rest = {};
    if (!query.rest) return;
    rest_.resize_discard(3 * vertices);
    for (std::size_t v = 0; v < vertices; ++v) {
        const auto vertex = static_cast<std::int32_t>(v);
        const Vec3d p = query.rest->knows(vertex, vertex) ? query.rest->position(vertex) : Vec3d{};
        for (int axis = 0; axis < 3; ++axis) rest_[3 * v + static_cast<std::size_t>(axis)] = p[axis];
    }
    copy_now(stream_, rest, rest_.data(), 3 * vertices, cudaMemcpyHostToDevice);
    if (body) copy_now(stream_, bodies, query.rest->body, vertices, cudaMemcpyHostToDevice);
    asked_.rest = {rest, body ? bodies : nullptr, query.rest->radius};
}

void FeatureInput::enqueue(const Geometry& geometry, cudaStream_t stream, const Scene& scene,
                           const SceneBox* box) const {
    if (asked_.radii) normalise_radii(geometry, stream, scene, box, asked_.radii, vertex_radius_, triangle_radius_);
    make_inflation(stream, box, asked_.distance, asked_.share, asked_.triangle_radius, inflation_);
}

void FeatureInput::release() {
    rings_.release();
    values_.release();
    rest_.release();
    ring_table_ = {};
}

}  // namespace crumple::cuda
