#include "distributed/feature_assembly.h"

#include <algorithm>
#include <variant>

#include "scene/prepared_scene.h"

namespace crumple::distribute {
namespace {

using Coordinates = std::variant<std::vector<float>, std::vector<double>>;

Coordinates gathered(const Coordinates& from, const std::vector<std::int32_t>& places) {
    return std::visit(
        [&](const auto& xyz) {
            std::remove_cvref_t<decltype(xyz)> to(3 * places.size());
            for (std::size_t i = 0; i < places.size(); ++i)
                std::copy_n(xyz.begin() + 3 * std::ptrdiff_t{places[i]}, 3,
                            to.begin() + static_cast<std::ptrdiff_t>(3 * i));
            return Coordinates(std::move(to));
        },
        from);
}

VertexReader reader_of(const Coordinates& coordinates) {
    return std::visit(
        [](const auto& xyz) {
            using Scalar = typename std::remove_cvref_t<decltype(xyz)>::value_type;
            return VertexReader{reinterpret_cast<const std::byte*>(xyz.data()), 3 * sizeof(Scalar), sizeof(Scalar),
                                sizeof(Scalar) == sizeof(float)};
        },
        coordinates);
}

std::size_t place_of(const std::vector<std::int32_t>& ids, std::int32_t id) {
    return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

}  // namespace

const Part& FeatureAssembly::update(const AssembledPart& from, const FeatureDemand& demand) {
    if (revision_ != from.revision()) {
        part_.features.emplace();
        merge_triangles(from);
        merge_edges(from);
        revision_ = from.revision();
    }
    PartFeatures& features = *part_.features;
    features.moving = demand.moving;
    features.distance = demand.distance, features.share = demand.share;
    features.weld = demand.weld;
    merge_coordinates(from);
    features.names.clear();
    if (demand.weld) name_vertices();
    return part_;
}

void FeatureAssembly::merge_triangles(const AssembledPart& from) {
    const Part& given = from.part();
    const std::span<const std::int32_t> ids = from.vertex_ids();
    place_ = given.mesh.corners;
    std::sort(place_.begin(), place_.end());
    place_.erase(std::unique(place_.begin(), place_.end()), place_.end());
    const auto id = [&](std::int32_t place) { return ids[static_cast<std::size_t>(place)]; };
    std::sort(place_.begin(), place_.end(), [&](std::int32_t a, std::int32_t b) { return id(a) < id(b); });

    part_.index = given.index, part_.count = given.count;
    part_.levels = given.levels;
    part_.mesh.ids = given.mesh.ids;
    part_.mesh.groups = given.mesh.groups;
    PartFeatures& features = *part_.features;
    std::vector<std::int32_t> number(ids.size());
    for (std::size_t i = 0; i < place_.size(); ++i) {
        number[static_cast<std::size_t>(place_[i])] = static_cast<std::int32_t>(i);
        features.vertices.push_back(id(place_[i]));
    }
    part_.mesh.corners.clear();
    for (const std::int32_t corner : given.mesh.corners)
        part_.mesh.corners.push_back(number[static_cast<std::size_t>(corner)]);
    features.faces = given.mesh.size();
}

void FeatureAssembly::merge_edges(const AssembledPart& from) {
    struct Owned {
        std::int32_t edge;
        Edge ends;
        std::int32_t rank;
    };
    PartFeatures& features = *part_.features;
    const std::vector<std::int32_t>& corners = part_.mesh.corners;
    const auto triangles = static_cast<std::size_t>(from.size());
    std::vector<Owned> edges;
    vertex_rank_.assign(features.vertices.size(), -1);
    for (std::size_t t = 0; t < triangles; ++t) {
        const OwnedFeatures& of = from.owned(t);
        const std::int32_t rank = from.rank_of(static_cast<std::int32_t>(t));
        features.owned.push_back(static_cast<std::uint8_t>(of.owned));
        for (std::size_t k = 0; k < 3; ++k) {
            if (of.owned >> k & 1) vertex_rank_[static_cast<std::size_t>(corners[3 * t + k])] = rank;
            if (!(of.owned >> (3 + k) & 1)) continue;
            const std::int32_t a = corners[3 * t + k], b = corners[3 * t + (k + 1) % 3];
            edges.push_back({of.edges[k], {std::min(a, b), std::max(a, b)}, rank});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Owned& a, const Owned& b) { return a.edge < b.edge; });
    edge_rank_.clear();
    for (const Owned& of : edges) {
        features.edges.push_back(of.edge);
        features.edge_ends.push_back(of.ends);
        edge_rank_.push_back(of.rank);
    }
    for (std::size_t t = 0; t < triangles; ++t) {
        const OwnedFeatures& of = from.owned(t);
        std::array<std::int32_t, 3> places{-1, -1, -1};
        for (std::size_t k = 0; k < 3; ++k)
            if (of.owned >> (3 + k) & 1) places[k] = static_cast<std::int32_t>(place_of_edge(of.edges[k]));
        features.edges_of.push_back(places);
    }
}

void FeatureAssembly::merge_coordinates(const AssembledPart& from) {
    part_.mesh.vertices = gathered(from.part().mesh.vertices, place_);
    if (part_.features->moving) part_.features->end = gathered(from.end(), place_);
}

// Chooses a representative for vertices at equal positions. Representatives only have to be consistent within the part;
// other parts may choose others.
void FeatureAssembly::name_vertices() {
    PartFeatures& features = *part_.features;
    PreparedScene scene;
    scene.vertices[0] = static_cast<std::int64_t>(features.vertices.size());
    scene.reader[0] = reader_of(part_.mesh.vertices);
    scene.moving = features.moving;
    if (features.moving) scene.end = reader_of(features.end);
    Array<std::int32_t> table, names;
    find_representatives(scene, table, names);
    features.names.assign(names.begin(), names.end());
}

std::size_t FeatureAssembly::place_of_edge(std::int32_t id) const { return place_of(part_.features->edges, id); }
int FeatureAssembly::rank_of_vertex(std::int32_t id) const {
    return vertex_rank_[place_of(part_.features->vertices, id)];
}
int FeatureAssembly::rank_of_edge(std::int32_t id) const { return edge_rank_[place_of_edge(id)]; }
Edge FeatureAssembly::ends_of_edge(std::int32_t id) const {
    const PartFeatures& features = *part_.features;
    const Edge ends = features.edge_ends[place_of_edge(id)];
    return {features.vertices[static_cast<std::size_t>(ends.a)], features.vertices[static_cast<std::size_t>(ends.b)]};
}

}  // namespace crumple::distribute
