#include "crumple/io.h"

#include <algorithm>

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

MeshFeatures features_of(const TriangleMesh& mesh) {
    MeshFeatures features;
    const auto add = [&](std::int32_t a, std::int32_t b) {
        if (a != b) features.edges.push_back({std::min(a, b), std::max(a, b)});
        features.points.insert(features.points.end(), {a, b});
    };
    const std::vector<std::int32_t>& corners = mesh.triangles;
    for (std::size_t i = 0; i < corners.size(); ++i) add(corners[i], corners[i % 3 == 2 ? i - 2 : i + 1]);
    for (const Edge& line : mesh.lines) add(line.a, line.b);
    features.points.insert(features.points.end(), mesh.points.begin(), mesh.points.end());
    const auto make_unique = [](auto& list) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    make_unique(features.edges);
    make_unique(features.points);
    return features;
}

}  // namespace crumple::io
