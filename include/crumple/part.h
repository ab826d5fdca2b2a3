#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "crumple/export.h"
#include "crumple/features.h"
#include "crumple/mesh.h"

namespace crumple {

/// A part's share of one mesh: copies of the triangles that belong to the part, and of their vertices.
struct CRUMPLE_API PartMesh {
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

/// What a part knows of vertices and edges, if it is asked about motion or nearness (Detector::partition of a question
/// about these). A feature is owned by one triangle of the scene, which need not be in the part; pairs of
/// features belong to the part that owns the pair of their owners. Everything here counts within the part, but for the
/// ids, which ascend: so a part's order is that of the mesh.
struct PartFeatures {
    bool moving = false;  ///< asked about motion, else about nearness
    double distance = 0,
           share =
               0;  ///< the most that may be asked for: ImpactQuery::min_distance and its share, ProximityQuery::radius
    bool weld = false;
    std::variant<std::vector<float>, std::vector<double>> end;  ///< 3 a vertex, of motion: where it goes
    std::vector<double> radii;                                  ///< 1 a vertex, or none: ProximityQuery::radii
    std::vector<double> rest;                                   ///< 3 a vertex, or none: ProximityQuery::rest

    std::int64_t faces = 0;  ///< the first so many triangles; the others carry an edge or a point of the lists
    std::vector<std::int32_t> vertices;  ///< ids of the part's vertices
    std::vector<std::int32_t> edges;     ///< ids of the edges that the part's triangles own
    std::vector<Edge> edge_ends;         ///< their vertices
    std::vector<std::uint8_t> owned;     ///< of each triangle: bit k, its corner k; bit 3 + k, the side from there
    std::vector<std::array<std::int32_t, 3>> edges_of;  ///< of each triangle: the edges that it owns, by side, or -1
    std::vector<std::int32_t> names;                    ///< of each vertex, or none: equal where vertices count as one

    bool lists_points = false;                         ///< the mesh does; ids of points are then places in its list
    std::vector<std::int32_t> points, point_vertices;  ///< ids of the points that the part's triangles own; vertices
    std::vector<std::array<std::int32_t, 3>>
        points_of;                                    ///< of each triangle: the points that it owns, by corner, or -1
    std::vector<std::uint8_t> of_no_face;             ///< 1 for each of the other triangles that no face is behind
    std::vector<std::array<std::int32_t, 3>> joined;  ///< see SceneFeatures: of each vertex, or none

    std::int32_t rings = 0;                ///< ProximityQuery::rings
    std::vector<std::int64_t> first_ring;  ///< of each vertex, in `ring`; and the end
    std::vector<std::int32_t> ring;        ///< the others within so many edges of it
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
    std::int32_t index = 0, count = 1;     ///< which of how many parts this is
    PartMesh mesh;                         ///< of the one soup, or of the first mesh
    std::optional<PartMesh> second;        ///< of the second mesh, if there are two: pairs across only
    std::vector<PartLevel> levels;         ///< from the top: one for up to 64 parts, two for up to 4,096, at most 4
    std::optional<PartFeatures> features;  ///< of a part that is asked about motion or nearness

    std::int64_t triangle_count() const { return mesh.size() + (second ? second->size() : 0); }
};

}  // namespace crumple
