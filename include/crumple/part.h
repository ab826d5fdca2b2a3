#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "crumple/mesh.h"

namespace crumple {

/// A part's share of one mesh: copies of the triangles that belong to the part, and of their vertices.
struct PartMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< 3n coordinates, in the mesh's own precision
    std::vector<std::int32_t> corners;                               ///< 3m indices into `vertices`
    std::vector<std::int32_t> ids;     ///< m: which triangles of the mesh these are, strictly ascending
    std::vector<std::int32_t> groups;  ///< m, or empty: all in group 0

    std::int64_t size() const { return static_cast<std::int64_t>(ids.size()); }
    MeshView view() const;
};

/// One level of the subdivision that a part comes from. A level has at most 64 clusters within each cluster of the
/// level above.
struct PartLevel {
    std::int32_t cluster = 0;  ///< the one that the part lies in, 0 to 63
    /// For each triangle of the part, those of the first mesh first: bit k is set if it belongs to cluster k of this
    /// level, within the part's cluster of the level above. Bit `cluster` is set in all.
    std::vector<std::uint64_t> masks;
};

/// One of several independent, overlapping parts of a scene ([MZ] sec. 1.1). A plain value that owns its arrays: send
/// it anywhere, and answer it there without the meshes (Detector::find). Of the clusters of a level that both triangles
/// of a pair belong to, the lowest owns the pair; a part owns it if its clusters do on all levels. So each pair is
/// owned by exactly one part, and the union over the parts is the whole answer. Both triangles of a pair are in the
/// part that owns it.
///
/// Memory: about 50 bytes a triangle in float32; the parts together hold each triangle about as often as its size, over
/// the distance of the parts' centres, suggests: 1.3 times for 64 parts of a million triangles.
struct Part {
    std::int32_t index = 0, count = 1;  ///< which of how many parts this is
    PartMesh mesh;                      ///< of the one soup, or of the first mesh
    std::optional<PartMesh> second;     ///< of the second mesh, if there are two: pairs across only
    std::vector<PartLevel> levels;      ///< from the top: one for up to 64 parts, two for up to 4,096, at most 4

    std::int64_t triangle_count() const { return mesh.size() + (second ? second->size() : 0); }
};

}  // namespace crumple
