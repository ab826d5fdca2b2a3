#include "io/meshes/faces.h"

#include <numeric>

#include "io/meshes/triangulate.h"

namespace crumple::io {

/// Starts the list of polygons. Called at the fourth corner of the first face that has more than three: all faces
/// before it are triangles, which become the first polygons of the list.
void Faces::begin_polygons() {
    has_polygons_ = true;
    const std::size_t faces = triangles_.size() / 3 - 2;
    polygons_.corners.assign(triangles_.begin(), triangles_.end() - 3);
    polygons_.offsets.resize(faces + 1);
    for (std::size_t i = 0; i <= faces; ++i) polygons_.offsets[i] = static_cast<std::int64_t>(3 * i);
    polygons_.of_triangle.resize(faces);
    std::iota(polygons_.of_triangle.begin(), polygons_.of_triangle.end(), 0);
}

void Faces::end_polygon() {
    const auto index = static_cast<std::int32_t>(polygons_.offsets.size() - 1);
    if (corners_ > 3) to_triangulate_.push_back({index, place_});
    polygons_.offsets.push_back(static_cast<std::int64_t>(polygons_.corners.size()));
    polygons_.of_triangle.resize(triangles_.size() / 3, index);
}

/// Triangulates the polygons of `to_triangulate_`. Polygons that cross themselves remain fans; the result counts them.
WarningTally Faces::cut_polygons(const std::function<Vec3d(std::int32_t)>& point) {
    Triangulator triangulator;
    std::vector<Vec3d> points;
    std::vector<std::int32_t> local;
    WarningTally crossing;
    for (const Polygon& polygon : to_triangulate_) {
        const auto i = static_cast<std::size_t>(polygon.index);
        const auto begin = static_cast<std::size_t>(polygons_.offsets[i]);
        const std::size_t corners = static_cast<std::size_t>(polygons_.offsets[i + 1]) - begin;
        points.clear();
        for (std::size_t k = 0; k < corners; ++k) points.push_back(point(polygons_.corners[begin + k]));
        local.clear();
        if (!triangulator.cut(points, local)) crossing.add(polygon.place);
        // A polygon has two triangles fewer than corners, so `begin - 2 * i` triangles come before this polygon.
        std::int32_t* const triangles = &triangles_[3 * (begin - 2 * i)];
        for (std::size_t k = 0; k < local.size(); ++k)
            triangles[k] = polygons_.corners[begin + static_cast<std::size_t>(local[k])];
    }
    return crossing;
}

}  // namespace crumple::io
