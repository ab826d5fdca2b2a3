#pragma once

// Reader of the triangles of glTF meshes. Meshes with the same accessors, which exporters write for one geometry in
// several colours, become one shape.

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "crumple/io.h"
#include "io/scenes/gltf_file.h"

namespace crumple::io {

class GltfMeshes {
   public:
    GltfMeshes(GltfFile& file, const ReadOptions& options) : file_(file), options_(options) {}

    /// Returns the index of the shape of mesh `mesh`, which is read on first use. `node`: the node that refers to the
    /// mesh, for messages. Throws Error (format, file).
    std::int32_t shape_of(std::int64_t mesh, const GltfObject& node);
    std::vector<TriangleMesh> release_shapes() { return std::move(shapes_); }

    // Unsupported objects of one kind, which are left out: the place of the first one in the description, and their
    // number.
    struct Unsupported {
        std::string first;
        std::int64_t count = 0;
        void add(const std::string& place) {
            if (count++ == 0) first = place;
        }
    };
    Unsupported points_and_lines, without_positions, morph_targets;

   private:
    enum Mode : std::int64_t { triangles = 4, strip = 5, fan = 6 };
    struct Primitive {
        std::int64_t mode, positions, indices;  ///< indices: -1 if there are none
        auto operator<=>(const Primitive&) const = default;
    };
    struct Vertices {
        GltfElements elements;
        std::int64_t first = 0;  ///< index of the accessor's first vertex among those of the mesh
        std::string place;       ///< place of the accessor in the description, for errors
    };

    std::vector<Primitive> primitives_of(const GltfObject& mesh);
    TriangleMesh read(const std::vector<Primitive>& primitives, const GltfObject& mesh);
    void add_corners(const Primitive& primitive, const Vertices& vertices, const GltfObject& mesh,
                     std::vector<std::int64_t>& corners);

    GltfFile& file_;
    const ReadOptions& options_;
    std::vector<std::int32_t> of_mesh_;  ///< shape of each mesh; -1: not read yet
    std::map<std::vector<Primitive>, std::int32_t> known_;
    std::vector<TriangleMesh> shapes_;
    std::size_t corners_ = 0;  ///< number of corners of all shapes
};

}  // namespace crumple::io
