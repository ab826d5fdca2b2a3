#include "distributed/block_of_triangles.h"

#include <numeric>

namespace crumple::distribute {

LocalMesh TriangleBlock::take(const PreparedScene& scene) {
    if (!names_the_same(scene)) number(scene);
    gather(scene.reader[0], start_);
    if (scene.moving) gather(scene.end, end_);
    LocalMesh local;
    local.mesh.vertices = view_of(start_);
    local.mesh.triangles = rows_of_three(corners_.data(), triangles_.size());
    if (scene.groups)
        local.mesh.groups = {scene.groups + triangles_.begin, static_cast<std::size_t>(triangles_.size())};
    local.vertex_ids = ids_;
    return local;
}

std::span<const std::int32_t> TriangleBlock::corners_in(const PreparedScene& scene) const {
    return {scene.corners + 3 * triangles_.begin, static_cast<std::size_t>(3 * triangles_.size())};
}

bool TriangleBlock::names_the_same(const PreparedScene& scene) const {
    if (mine(scene.triangle_count()) != triangles_ || mine(scene.vertex_count()) != vertices_) return false;
    const std::span<const std::int32_t> corners = corners_in(scene);
    for (std::size_t i = 0; i < corners.size(); ++i)
        if (ids_[static_cast<std::size_t>(corners_[i])] != corners[i]) return false;
    return true;
}

void TriangleBlock::number(const PreparedScene& scene) {
    triangles_ = mine(scene.triangle_count()), vertices_ = mine(scene.vertex_count());
    ids_.resize(static_cast<std::size_t>(vertices_.size()));
    std::iota(ids_.begin(), ids_.end(), vertices_.begin);
    std::vector<std::int32_t> place(static_cast<std::size_t>(scene.vertex_count()), -1);
    std::iota(place.begin() + vertices_.begin, place.begin() + vertices_.end, 0);
    const std::span<const std::int32_t> corners = corners_in(scene);
    corners_.resize(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        std::int32_t& at = place[static_cast<std::size_t>(corners[i])];
        if (at < 0) {
            at = static_cast<std::int32_t>(ids_.size());
            ids_.push_back(corners[i]);
        }
        corners_[i] = at;
    }
}

template <class Scalar>
void TriangleBlock::gather_as(const VertexReader& reader, Coordinates& xyz) const {
    if (!std::holds_alternative<std::vector<Scalar>>(xyz)) xyz = std::vector<Scalar>();
    auto& values = std::get<std::vector<Scalar>>(xyz);
    values.resize(3 * ids_.size());
    auto* value = values.data();
    for (const std::int64_t id : ids_) {
        const Vec3d p = reader(id);
        for (int axis = 0; axis < 3; ++axis) *value++ = static_cast<Scalar>(p[axis]);
    }
}

void TriangleBlock::gather(const VertexReader& reader, Coordinates& xyz) const {
    if (reader.float32)
        gather_as<float>(reader, xyz);
    else
        gather_as<double>(reader, xyz);
}

VertexView TriangleBlock::view_of(const Coordinates& xyz) {
    return std::visit(
        [](const auto& values) { return rows_of_three(values.data(), static_cast<std::int64_t>(values.size() / 3)); },
        xyz);
}

}  // namespace crumple::distribute
