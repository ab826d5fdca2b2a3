#include "crumple/io.h"

namespace crumple::io {

std::int64_t TriangleMesh::vertex_count() const {
    return std::visit([](const auto& xyz) { return static_cast<std::int64_t>(xyz.size() / 3); }, vertices);
}

ScalarType TriangleMesh::precision() const {
    return std::holds_alternative<std::vector<float>>(vertices) ? ScalarType::float32 : ScalarType::float64;
}

MeshView TriangleMesh::view() const {
    return std::visit(
        [&](const auto& xyz) {
            return MeshView(xyz.data(), vertex_count(), triangles.data(), triangle_count(), groups);
        },
        vertices);
}

}  // namespace crumple::io
