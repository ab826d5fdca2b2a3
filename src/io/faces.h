#pragma once

// The faces of a file, corner after corner, on their way to triangles. Each is fanned at once, so that a file of
// triangles costs nothing more; polygons are kept beside, and cut once all vertices are known.

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "crumple/io.h"
#include "geometry/vec.h"
#include "io/source.h"

namespace crumple::io {

class Faces {
   public:
    void reserve(std::int64_t faces) { triangles_.reserve(3 * static_cast<std::size_t>(faces)); }

    /// Begins a face; `place` is where it stands in the file.
    void begin(const char* place) {
        place_ = place;
        corners_ = 0;
    }
    void add(std::int32_t corner) {
        if (corners_ == 0) first_ = corner;
        if (corners_ >= 2) triangles_.insert(triangles_.end(), {first_, previous_, corner});
        if (corners_ == 3 && !has_polygons_) begin_polygons();
        if (has_polygons_) polygons_.corners.push_back(corner);
        previous_ = corner;
        ++corners_;
    }
    std::int64_t corners() const { return corners_; }
    /// Ends a face of at least three corners.
    void end() {
        if (has_polygons_) end_polygon();
    }

    std::size_t triangle_count() const { return triangles_.size() / 3; }

    /// The mesh of these faces and vertices, which all corners must name. Places of warnings are lines, else bytes.
    template <class Scalar>
    TriangleMesh mesh(std::vector<Scalar>&& vertices, Triangulation triangulation, Warnings& warnings, bool lines) {
        if (triangulation == Triangulation::ears) {
            const Tally crossing = cut_polygons([&](std::int32_t corner) {
                const Scalar* const p = &vertices[3 * static_cast<std::size_t>(corner)];
                return Vec3d{double{p[0]}, double{p[1]}, double{p[2]}};
            });
            const std::string what = "a polygon crosses itself and is fanned" + crossing.others();
            if (crossing.count > 0)
                lines ? warnings.at_line(crossing.first, what) : warnings.at_byte(crossing.first, what);
        }
        TriangleMesh mesh{std::move(vertices), std::move(triangles_)};
        mesh.polygons = std::move(polygons_);
        return mesh;
    }

   private:
    struct Polygon {
        std::int32_t index;
        const char* place;
    };

    void begin_polygons();
    void end_polygon();
    Tally cut_polygons(const std::function<Vec3d(std::int32_t)>& point);

    std::vector<std::int32_t> triangles_;
    Polygons polygons_;
    std::vector<Polygon> to_cut_;  ///< those of more than three corners
    bool has_polygons_ = false;
    const char* place_ = nullptr;
    std::int64_t corners_ = 0;  ///< of the face at hand
    std::int32_t first_ = 0, previous_ = 0;
};

}  // namespace crumple::io
