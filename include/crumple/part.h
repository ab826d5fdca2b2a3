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

/// Copy of one mesh's triangles that belong to a part, and of their vertices.
struct CRUMPLE_API PartMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< 3n coordinates, in the precision of the mesh
    std::vector<std::int32_t> corners;                               ///< 3m indices into `vertices`
    std::vector<std::int32_t> ids;                                   ///< m triangle ids of the mesh, strictly ascending
    std::vector<std::int32_t> groups;                                ///< m group ids, or empty: all in group 0

    /// Returns the number of triangles, m.
    std::int64_t size() const { return static_cast<std::int64_t>(ids.size()); }
    /// Returns a view, valid while this object is unchanged.
    MeshView view() const;
};

/// One level of the subdivision that a part comes from. At each level, a cluster of the level above has at most 64
/// clusters.
struct PartLevel {
    std::int32_t cluster = 0;  ///< the cluster that the part lies in, 0 to 63
    /// One mask per triangle of the part, the triangles of the first mesh first. Bit k is set if the triangle belongs
    /// to cluster k of this level, within the part's cluster of the level above. Bit `cluster` is set in all masks.
    std::vector<std::uint64_t> masks;
};

/// Vertices, edges and points of a part that was made for a query about motion or nearness (Detector::partition). One
/// triangle of the scene, which need not be in the part, owns each feature; a pair of features belongs to the part that
/// owns the pair of their owners. All indices count within the part, except for arrays of ids. Ids ascend, so the order
/// within a part is that of the mesh.
struct PartFeatures {
    bool moving = false;  ///< true for motion, false for nearness
    /// Largest distance that a query on this part may use: ImpactQuery::min_distance and min_distance_share, or
    /// ProximityQuery::radius.
    double distance = 0, share = 0;
    bool weld = false;
    std::variant<std::vector<float>, std::vector<double>> end;  ///< 3 per vertex, for motion: positions at the end
    std::vector<double> radii;                                  ///< 1 per vertex, or empty: ProximityQuery::radii
    std::vector<double> rest;                                   ///< 3 per vertex, or empty: ProximityQuery::rest

    /// Number of faces, which come first among the triangles. The other triangles are proxy triangles: degenerate, each
    /// owns one listed edge or point.
    std::int64_t faces = 0;
    std::vector<std::int32_t> vertices;  ///< ids of the part's vertices
    std::vector<std::int32_t> edges;     ///< ids of the edges that the part's triangles own
    std::vector<Edge> edge_ends;         ///< ends of these edges, as vertices of the part
    std::vector<std::uint8_t> owned;     ///< per triangle: bit k: owns corner k; bit 3 + k: owns the side from there
    std::vector<std::array<std::int32_t, 3>> edges_of;  ///< per triangle: the edges that it owns, by side, or -1
    /// Representative vertex of each vertex, equal for vertices that count as one; or empty.
    std::vector<std::int32_t> names;

    bool lists_points = false;  ///< true if the mesh lists points; ids of points are then positions in its list
    /// Ids of the points that the part's triangles own, and the vertex of each.
    std::vector<std::int32_t> points, point_vertices;
    std::vector<std::array<std::int32_t, 3>> points_of;  ///< per triangle: the points that it owns, by corner, or -1
    std::vector<std::uint8_t> of_no_face;                ///< per proxy triangle: 1 if no face names its edge or point
    /// For each vertex up to two different vertices that it shares an edge with (negative: none, or outside of the
    /// part), and 1 if there are more. Empty if every edge belongs to a face.
    std::vector<std::array<std::int32_t, 3>> joined;

    std::int32_t rings = 0;                ///< ProximityQuery::rings
    std::vector<std::int64_t> first_ring;  ///< per vertex the start of its entries in `ring`, and the end
    std::vector<std::int32_t> ring;        ///< other vertices that a path of at most `rings` edges leads to
};

/// One of several independent, overlapping parts of a scene ([MZ] sec. 1.1). A plain value that owns its arrays: it can
/// be sent to another machine and searched there without the meshes (Detector::find). On each level, the lowest cluster
/// that both triangles of a pair belong to owns the pair; a part owns the pair if the part's clusters own it on all
/// levels. So exactly one part owns each pair and contains both of its triangles, and the union over all parts is the
/// whole result.
///
/// Memory: about 50 bytes per triangle in float32. A triangle is in several parts if it is large compared to the
/// distance of the parts' centres: with 64 parts of a million triangles, it is in 1.3 parts on average.
struct Part {
    std::int32_t index = 0, count = 1;  ///< index of this part, and number of parts
    PartMesh mesh;                      ///< triangles of the single mesh, or of the first of two
    std::optional<PartMesh> second;     ///< triangles of the second of two meshes: pairs across only
    std::vector<PartLevel> levels;  ///< top level first: one level for up to 64 parts, two for up to 4,096, at most 4
    std::optional<PartFeatures> features;  ///< for queries about motion or nearness

    /// Returns the number of triangles, of both meshes together if there are two.
    std::int64_t triangle_count() const { return mesh.size() + (second ? second->size() : 0); }
};

}  // namespace crumple
