#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/world.h"

namespace crumple {

struct Proximities;
struct DeviceProximities;
struct DistributedProximities;

/// Which features are within a distance of each other (docs/nearness.md). A value, but for the views `radii` and
/// `rest`, which are read during the call.
struct ProximityQuery {
    using Result = Proximities;
    using DeviceResult = DeviceProximities;
    using DistributedResult = DistributedProximities;

    Output output = Output::pairs;  ///< `any`, `any_by_world` or `pairs`
    /// Features are near whose distance is at most this: Euclidean, finite, 0 or more; in the units of the coordinates.
    /// Exact as given.
    double radius = 0;
    /// Instead of `radius`: one a vertex, finite, 0 or more. That of an edge or a face is the largest of its vertices';
    /// features are near whose distance is at most the sum of both, in real numbers. Half a cloth's thickness, say. Of
    /// a single mesh; a world has Shape::radii.
    std::span<const double> radii = {};
    bool strict = false;   ///< less, not equal
    bool closest = false;  ///< also tell where they are closest: ProximityList::type and at
    /// Tell each feature's least distance, too: Proximities::vertex_distance and so on; single mesh. It counts pairs
    /// that `rings` or `rest` leave out of the lists, so that it can bound a step; with these it takes a second search.
    bool least = false;
    bool weld = false;  ///< vertices at equal positions count as one, for neighbours
    /// Neighbours, which are never near: features of which two vertices are joined by a path of at most so many edges.
    /// 0: those with a common vertex. Cost: 4 bytes for each vertex and each that is as close to it, kept for the next
    /// call; some 150 bytes a vertex for 3 rings.
    std::int32_t rings = 0;
    /// Where the vertices are at rest: (n, 3), float32 or float64, finite. Features whose distance there is at most
    /// `rest_radius` are never near. Of a single mesh; a world has Shape::rest. Without data there is no such shape.
    VertexView rest = {};
    double rest_radius = 0;  ///< finite, 0 or more; exact as given
    PairFilter filter = {};
    bool index = false;  ///< also make the offsets of ProximityList, where pairs are listed
};

/// Which parts of two features are closest: of lowest dimension, then first in this order. Names and order are IPC
/// Toolkit's: E0 is the side from the face's first corner to the second, E1 from there to the third, E2 back; EA and EB
/// are the edges, EA0 is the first vertex of EA, as it is in Proximities::edges. Of a vertex and an edge E0 and E1 are
/// the edge's vertices, E the edge.
enum class VertexFaceType : std::uint8_t { P_T0, P_T1, P_T2, P_E0, P_E1, P_E2, P_T };
enum class EdgeEdgeType : std::uint8_t { EA0_EB0, EA0_EB1, EA1_EB0, EA1_EB1, EA_EB0, EA_EB1, EA0_EB, EA1_EB, EA_EB };
enum class VertexEdgeType : std::uint8_t { P_E0, P_E1, P_E };
enum class VertexVertexType : std::uint8_t { P_P };

/// Near pairs of one kind: unique, by first feature, then second; of worlds by world, then by body before each feature,
/// and pairs among bodies that are in all worlds come last.
struct ProximityList {
    Array<Pair> pairs;               ///< indices within their bodies; see FeatureKind
    Array<BodyPair> bodies;          ///< for each pair its bodies; empty for a single mesh
    Array<double> squared_distance;  ///< exact, then rounded to the nearest number; infinite beyond the largest
    Array<std::uint8_t> touching;    ///< 1: the distance is 0 exactly

    // Where ProximityQuery::closest asks for them:
    Array<std::uint8_t> type;  ///< a VertexFaceType, an EdgeEdgeType, a VertexEdgeType or a VertexVertexType
    /// The point of the face a + u (b - a) + v (c - a) as (u, v), of the edges a + s (b - a) and c + t (d - c) as (s,
    /// t), or of the one edge a + s (b - a) as (s, 0); (0, 0) of two vertices. Exact, then rounded to the nearest
    /// numbers.
    Array<std::array<double, 2>> at;

    // Where ProximityQuery::index asks for them; a single mesh only:
    Array<std::int64_t> offsets;         ///< pairs of first feature i: [offsets[i], offsets[i + 1])
    Array<std::int64_t> second_offsets;  ///< the same of second features, into `by_second`
    Array<std::int64_t> by_second;       ///< positions in `pairs`, by second feature, then first
};

/// Result of a ProximityQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Proximities {
    bool any = false;        ///< whether anything is near
    std::int64_t count = 0;  ///< pairs, where they are listed; else 0

    Array<std::uint8_t> world_hit;                   ///< one a world: something is near (not for Output::any)
    std::array<ProximityList, feature_kinds> lists;  ///< by FeatureKind

    /// What edges and points are meant: as in Impacts.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    /// Where ProximityQuery::least asks for them, of a single mesh: the least distance of each vertex, each face and
    /// each edge over the pairs of all kinds that are near and name it, whatever `rings` and `rest` leave out; rounded
    /// down. Infinite without one. Vertices are by their place in the list of points, if the mesh has one.
    Array<double> vertex_distance, face_distance, edge_distance;

    Statistics statistics;

    ProximityList& operator[](FeatureKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const ProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    const ProximityList& vertex_faces() const { return (*this)[FeatureKind::vertex_face]; }
    const ProximityList& edge_edges() const { return (*this)[FeatureKind::edge_edge]; }
    const ProximityList& vertex_edges() const { return (*this)[FeatureKind::vertex_edge]; }
    const ProximityList& vertex_vertices() const { return (*this)[FeatureKind::vertex_vertex]; }
};

}  // namespace crumple
