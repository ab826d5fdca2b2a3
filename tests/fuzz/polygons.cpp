#include "fuzz/polygons.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "fuzz/fail.h"
#include "geometry/predicates.h"

namespace crumple::fuzz {
namespace {

using Corners = std::span<const std::int32_t>;
/// For each edge, how often it is traversed from the smaller to the larger vertex id, minus how often in reverse.
using Outline = std::map<std::pair<std::int32_t, std::int32_t>, int>;

void add(Outline& outline, Corners ring) {
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const std::int32_t a = ring[i], b = ring[i + 1 == ring.size() ? 0 : i + 1];
        int& runs = outline[std::minmax(a, b)];
        runs += a < b ? 1 : a > b ? -1 : 0;
        if (runs == 0) outline.erase(std::minmax(a, b));
    }
}

Vec3d position(const io::TriangleMesh& mesh, std::int32_t vertex) {
    const auto i = 3 * static_cast<std::size_t>(vertex);
    return std::visit(
        [i](const auto& xyz) {
            return Vec3d{double{xyz[i]}, double{xyz[i + 1]}, double{xyz[i + 2]}};
        },
        mesh.vertices);
}

/// True if the triangles have the same orientation as seen along some axis, or if a coordinate is beyond the range of
/// expansions.
bool one_way(const io::TriangleMesh& mesh, Corners triangles) {
    for (int axis = 0; axis < 3; ++axis) {
        bool left = false, right = false;
        for (std::size_t i = 0; i < triangles.size(); i += 3) {
            const Vec3d a = position(mesh, triangles[i]), b = position(mesh, triangles[i + 1]),
                        c = position(mesh, triangles[i + 2]);
            if (!in_expansion_range(a) || !in_expansion_range(b) || !in_expansion_range(c)) return true;
            const int turn = orient2d_exact(a, b, c, axis);
            left = left || turn > 0;
            right = right || turn < 0;
        }
        if (!left || !right) return true;
    }
    return false;
}

}  // namespace

void require_cut(const io::TriangleMesh& mesh, io::Triangulation triangulation) {
    const io::Polygons& polygons = mesh.polygons;
    if (polygons.empty()) {
        require(polygons.offsets.empty() && polygons.corners.empty(), "polygons of no triangle");
        return;
    }
    const auto count = static_cast<std::size_t>(polygons.count());
    require(polygons.offsets.size() == count + 1 && polygons.offsets[0] == 0 &&
                polygons.offsets[count] == static_cast<std::int64_t>(polygons.corners.size()),
            "offsets of polygons are not those of their corners");
    require(polygons.of_triangle.size() == mesh.triangles.size() / 3, "polygons are not one a triangle");
    for (const std::int32_t corner : polygons.corners)
        require(corner >= 0 && corner < mesh.vertex_count(), "a polygon's corner names no vertex");
    const bool crosses = std::any_of(mesh.warnings.begin(), mesh.warnings.end(), [](const std::string& warning) {
        return warning.find("crosses itself") != warning.npos;
    });
    std::size_t triangle = 0;
    bool polygon = false;
    for (std::size_t i = 0; i < count; ++i) {
        require(polygons.offsets[i + 1] - polygons.offsets[i] >= 3, "a polygon of less than three corners");
        const auto begin = static_cast<std::size_t>(polygons.offsets[i]),
                   corners = static_cast<std::size_t>(polygons.offsets[i + 1]) - begin;
        const Corners ring(&polygons.corners[begin], corners);
        require(triangle + corners - 2 <= mesh.triangles.size() / 3, "triangles are missing");
        const Corners triangles(&mesh.triangles[3 * triangle], 3 * (corners - 2));
        polygon = polygon || corners > 3;
        Outline of_polygon, of_triangles;
        add(of_polygon, ring);
        for (std::size_t t = 0; t < corners - 2; ++t, ++triangle) {
            require(polygons.of_triangle[triangle] == static_cast<std::int32_t>(i), "a triangle of another polygon");
            add(of_triangles, triangles.subspan(3 * t, 3));
        }
        require(of_polygon == of_triangles, "triangles do not have the outline of their polygon");
        require(triangulation == io::Triangulation::fan || crosses || one_way(mesh, triangles),
                "triangles of a polygon overlap");
    }
    require(triangle == mesh.triangles.size() / 3, "a triangle of no polygon");
    require(polygon, "polygons that are all triangles");
}

}  // namespace crumple::fuzz
