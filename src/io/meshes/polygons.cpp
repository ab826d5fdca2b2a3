// Converts intersections of triangles to intersections of polygons: each pair of triangles becomes the pair of the
// polygons that the triangles were cut from.

#include "io/meshes/polygons.h"

#include <algorithm>

#include "base/float_environment.h"
#include "io/formats.h"

namespace crumple::io {

std::int64_t polygon_count(const TriangleMesh& mesh) {
    return mesh.polygons.empty() ? mesh.triangle_count() : mesh.polygons.count();
}

std::int32_t polygon_of(const TriangleMesh& mesh, std::int32_t triangle) {
    return mesh.polygons.empty() ? triangle : mesh.polygons.of_triangle[static_cast<std::size_t>(triangle)];
}

std::vector<std::uint8_t> hit_triangles(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    std::vector<std::uint8_t> result(static_cast<std::size_t>(mesh.triangle_count()));
    const bool of_triangles = hit.size() == result.size();
    for (std::size_t t = 0; t < result.size(); ++t) {
        const auto triangle = static_cast<std::int32_t>(t);
        result[t] = hit[static_cast<std::size_t>(of_triangles ? triangle : polygon_of(mesh, triangle))];
    }
    return result;
}

namespace {

void check(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    validate(mesh);
    if (static_cast<std::int64_t>(hit.size()) == mesh.triangle_count()) return;
    throw Error(ErrorCode::invalid_argument, "the collisions are not those of the mesh's triangles");
}

Array<std::uint8_t> hit_polygons(const TriangleMesh& mesh, const Array<std::uint8_t>& hit) {
    Array<std::uint8_t> result;
    result.assign(static_cast<std::size_t>(polygon_count(mesh)), 0);
    for (std::size_t t = 0; t < hit.size(); ++t) {
        if (hit[t]) result[static_cast<std::size_t>(polygon_of(mesh, static_cast<std::int32_t>(t)))] = 1;
    }
    return result;
}

}  // namespace

Intersections by_polygon(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions) {
    const FloatEnvironment environment;
    check(mesh, collisions.hit);
    if (second) check(*second, collisions.hit_second);
    Intersections result;
    result.pairs.reserve(collisions.pairs.size());
    for (const Pair& pair : collisions.pairs)
        result.pairs.push_back({polygon_of(mesh, pair.a), polygon_of(second ? *second : mesh, pair.b)});
    std::sort(result.pairs.begin(), result.pairs.end());
    const auto end = std::unique(result.pairs.begin(), result.pairs.end());
    result.pairs.resize(static_cast<std::size_t>(end - result.pairs.begin()));
    result.offsets.assign(static_cast<std::size_t>(polygon_count(mesh)) + 1, 0);
    for (const Pair& pair : result.pairs) ++result.offsets[static_cast<std::size_t>(pair.a) + 1];
    for (std::size_t i = 1; i < result.offsets.size(); ++i) result.offsets[i] += result.offsets[i - 1];
    result.hit = hit_polygons(mesh, collisions.hit);
    if (second) result.hit_second = hit_polygons(*second, collisions.hit_second);
    result.statistics = collisions.statistics;
    return result;
}

}  // namespace crumple::io
