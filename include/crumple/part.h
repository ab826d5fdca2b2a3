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

/// Copy of those triangles of one mesh that belong to a part, and of their vertices. The id of a triangle is its index
/// in the mesh.
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

/// One level of the subdivision that a part comes from. Each level divides every cluster of the level above into at
/// most 64 overlapping clusters.
struct PartLevel {
    std::int32_t cluster = 0;  ///< the cluster that the part lies in, 0 to 63
    /// One mask per triangle of the part, the triangles of the first mesh first. Bit k is set if the triangle belongs
    /// to cluster k of those into which this level divides the part's cluster of the level above. So bit `cluster` is
    /// set in all masks.
    std::vector<std::uint64_t> masks;
};

/// Vertices, edges and points of a part that was made for a query about motion or nearness (Detector::partition). One
/// triangle of the scene, which need not be in the part, owns each feature; a pair of features belongs to the part that
/// owns the pair of their owners. All indices count within the part, except for arrays of ids, which are indices in the
/// mesh. Ids ascend, so the order within a part is that of the mesh.
struct PartFeatures {
    bool moving = false;  ///< true for motion, false for nearness
    /// Largest distance that a query on this part may use: ImpactQuery::min_distance and min_distance_share, or
    /// ProximityQuery::radius.
    double distance = 0, share = 0;
    bool weld = false;
    std::variant<std::vector<float>, std::vector<double>> end;  ///< 3 per vertex, for motion: positions at the end
    std::vector<double> radii;                                  ///< 1 per vertex, or empty: ProximityQuery::radii
    std::vector<double> rest;                                   ///< 3 per vertex, or empty: ProximityQuery::rest

    /// Number of faces, which come first among the triangles. The other triangles are proxy triangles: degenerate
    /// triangles, each of which owns one edge or point that the mesh lists.
    std::int64_t faces = 0;
    std::vector<std::int32_t> vertices;  ///< ids of the part's vertices
    std::vector<std::int32_t> edges;     ///< ids of the edges that the part's triangles own
    std::vector<Edge> edge_ends;         ///< ends of these edges, as vertices of the part
    std::vector<std::uint8_t> owned;     ///< per triangle: bit k: owns corner k; bit 3 + k: owns the side from corner k
    std::vector<std::array<std::int32_t, 3>> edges_of;  ///< per triangle: the edges that it owns, by side, or -1
    /// Representative of each vertex: equal for vertices that `weld` merges. Empty if each vertex represents itself.
    std::vector<std::int32_t> names;

    bool lists_points = false;  ///< true if the mesh lists points; ids of points are then positions in its list
    /// Ids of the points that the part's triangles own, and the vertex of each.
    std::vector<std::int32_t> points, point_vertices;
    std::vector<std::array<std::int32_t, 3>> points_of;  ///< per triangle: the points that it owns, by corner, or -1
    std::vector<std::uint8_t> of_no_face;                ///< per proxy triangle: 1 if no face has its edge or point
    /// Per vertex: two different vertices that an edge joins to it (negative: there is none, or it is outside of the
    /// part), then 1 if there are more, else 0. Empty if every edge belongs to a face.
    std::vector<std::array<std::int32_t, 3>> joined;

    std::int32_t rings = 0;                ///< ProximityQuery::rings
    std::vector<std::int64_t> first_ring;  ///< per vertex the start of its entries in `ring`, and the end
    std::vector<std::int32_t> ring;        ///< other vertices that a path of at most `rings` edges reaches
};

/// One of several independent, overlapping parts of a scene (D. Mainzer and G. Zachmann, Collision Detection Based on
/// Fuzzy Scene Subdivision, sec. 1.1). A plain value that owns its arrays: it can be sent to another machine and
/// searched there without the meshes (Detector::find). On each level, the lowest cluster that both triangles of a pair
/// belong to owns the pair; a part owns the pair if the part's clusters own it on all levels. So exactly one part owns
/// each pair and contains both of its triangles, and the union over all parts is the whole result.
///
/// Memory: about 30 bytes per triangle in float32 with one level, 8 more for each further level. A triangle may be in
/// several parts, above all if it is large compared to the distance between the parts' centres: a cloth of a million
/// triangles has 1.08 times as many in 64 parts together, and 1.4 times in 1,000 (docs/subdivide.md).
struct Part {
    std::int32_t index = 0, count = 1;  ///< index of this part, and number of parts
    PartMesh mesh;                      ///< triangles of the single mesh, or of the first of two
    std::optional<PartMesh> second;     ///< triangles of the second of two meshes; pairs are then across the two only
    std::vector<PartLevel>
        levels;  ///< top level first: one for up to 64 parts, two for up to 4,096, else three; find() accepts up to 4
    std::optional<PartFeatures> features;  ///< for queries about motion or nearness

    /// Returns the number of triangles, of both meshes together if there are two.
    std::int64_t triangle_count() const { return mesh.size() + (second ? second->size() : 0); }
};

}  // namespace crumple
