#pragma once

// Builder of triangles from the faces of a file, which are added corner by corner. Each face is at first divided into a
// fan of triangles around its first corner, so that files of triangles have no extra cost. Once a face has more than
// three corners, polygons are stored as well, and mesh() can triangulate them better because all vertices are known.

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "crumple/io.h"
#include "geometry/vec.h"
#include "io/bytes/source.h"

namespace crumple::io {

class Faces {
   public:
    void reserve(std::int64_t faces) { triangles_.reserve(3 * static_cast<std::size_t>(faces)); }

    /// Begins a face; `place` points to it in the text or bytes of the file.
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
    /// Ends a face. A face of less than three corners is left out, with a warning.
    void end() {
        if (corners_ < 3) {
            leave_out();
        } else if (has_polygons_) {
            end_polygon();
        }
    }

    std::size_t triangle_count() const { return triangles_.size() / 3; }

    /// Returns the mesh of these faces and vertices; every corner must be the index of a vertex. `lines`: true if
    /// warnings name lines of the file, false if they name bytes. Call once: it moves the faces out.
    template <class Scalar>
    TriangleMesh mesh(std::vector<Scalar>&& vertices, Triangulation triangulation, Warnings& warnings, bool lines) {
        const auto warn = [&](const WarningTally& faces, const std::string& what) {
            if (faces.count == 0) return;
            const std::string sentence = what + faces.others();
            lines ? warnings.at_line(faces.first, sentence) : warnings.at_byte(faces.first, sentence);
        };
        warn(left_out_, "a face has fewer than three corners and is left out");
        if (triangulation == Triangulation::ears) {
            const WarningTally crossing = cut_polygons([&](std::int32_t corner) {
                const Scalar* const p = &vertices[3 * static_cast<std::size_t>(corner)];
                return Vec3d{double{p[0]}, double{p[1]}, double{p[2]}};
            });
            warn(crossing, "a polygon crosses itself and becomes a fan");
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

    void leave_out() {
        left_out_.add(place_);
        if (has_polygons_) polygons_.corners.resize(polygons_.corners.size() - static_cast<std::size_t>(corners_));
    }
    void begin_polygons();
    void end_polygon();
    WarningTally cut_polygons(const std::function<Vec3d(std::int32_t)>& point);

    std::vector<std::int32_t> triangles_;
    Polygons polygons_;
    std::vector<Polygon> to_triangulate_;  ///< polygons of more than three corners
    WarningTally left_out_;
    bool has_polygons_ = false;
    const char* place_ = nullptr;
    std::int64_t corners_ = 0;  ///< number of corners of the current face so far
    std::int32_t first_ = 0, previous_ = 0;
};

}  // namespace crumple::io
