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

/// Query for all pairs of features within a distance of each other (docs/nearness.md). A value, except for the views
/// `radii` and `rest`, which are read during the call.
struct ProximityQuery {
    using Result = Proximities;
    using DeviceResult = DeviceProximities;
    using DistributedResult = DistributedProximities;

    Output output = Output::pairs;  ///< `any`, `any_by_world` or `pairs`
    /// Two features are near if their distance is at most this: Euclidean, finite, 0 or more; in the units of the
    /// coordinates. Not rounded.
    double radius = 0;
    /// Replaces `radius`: one per vertex, finite, 0 or more, for example half the thickness of a cloth. The radius of
    /// an edge or a face is the largest of its vertices'. Two features are near if their distance is at most the sum of
    /// their radii, in real numbers. For a single mesh; a world has Shape::radii.
    std::span<const double> radii = {};
    bool strict = false;   ///< near only if the distance is less than the limit
    bool closest = false;  ///< also makes ProximityList::type and ProximityList::at
    /// Also makes the least distance of each feature (Proximities::vertex_distance and so on), for a single mesh.
    /// Includes pairs that `rings` or `rest` drop from the lists, so a solver can limit its step by it; with `rings` or
    /// `rest` it takes a second search.
    bool least = false;
    bool weld = false;  ///< vertices at equal positions count as one, for adjacency
    /// Features are adjacent, and never near, if a path of at most this many edges connects a vertex of one with a
    /// vertex of the other. 0: if they have a common vertex. Memory: 4 bytes for each vertex and each other vertex that
    /// such a path reaches from it, about 150 bytes per vertex for 3 rings; cached for the next call.
    std::int32_t rings = 0;
    /// Rest shape: positions of the vertices, (n, 3), float32 or float64, finite. Features whose distance in the rest
    /// shape is at most `rest_radius` are never near. For a single mesh; a world has Shape::rest. Without data there is
    /// no rest shape.
    VertexView rest = {};
    double rest_radius = 0;  ///< finite, 0 or more; not rounded
    PairFilter filter = {};
    bool index = false;  ///< also makes the offsets of ProximityList, for Output::pairs
};

/// Closest parts (vertices, edges, faces) of two features; if several are equally close, those of lowest dimension, and
/// of these the first in the order of the enum. Names and order are those of IPC Toolkit. P is the vertex. T is the
/// face, T0 to T2 are its corners; E0 is its side from T0 to T1, E1 from T1 to T2, E2 from T2 to T0. EA and EB are the
/// two edges; EA0 and EA1 are the vertices of EA as in Proximities::edges. For a vertex and an edge, E is the edge, E0
/// and E1 are its vertices.
/// @{
enum class VertexFaceType : std::uint8_t { P_T0, P_T1, P_T2, P_E0, P_E1, P_E2, P_T };
enum class EdgeEdgeType : std::uint8_t { EA0_EB0, EA0_EB1, EA1_EB0, EA1_EB1, EA_EB0, EA_EB1, EA0_EB, EA1_EB, EA_EB };
enum class VertexEdgeType : std::uint8_t { P_E0, P_E1, P_E };
enum class VertexVertexType : std::uint8_t { P_P };
/// @}

/// Near pairs of one kind, each once, sorted by first feature, then second. For worlds sorted by world, first body,
/// first feature, second body, second feature; pairs among bodies that are in all worlds come last.
struct ProximityList {
    Array<Pair> pairs;               ///< indices within their bodies; see FeatureKind
    Array<BodyPair> bodies;          ///< the bodies of each pair; empty for a single mesh
    Array<double> squared_distance;  ///< exact, rounded to nearest; infinite if it overflows
    Array<std::uint8_t> touching;    ///< 1: the distance is 0 exactly

    // For ProximityQuery::closest:
    Array<std::uint8_t> type;  ///< a VertexFaceType, an EdgeEdgeType, a VertexEdgeType or a VertexVertexType
    /// Parameters of the closest points: (u, v) of the point a + u (b - a) + v (c - a) of a face a b c; (s, t) of the
    /// points a + s (b - a) and c + t (d - c) of two edges a b and c d; (s, 0) of the point a + s (b - a) of an edge a
    /// b against a vertex; (0, 0) for two vertices. Exact values, each rounded to the nearest number.
    Array<std::array<double, 2>> at;

    // For ProximityQuery::index, a single mesh only:
    Array<std::int64_t> offsets;  ///< pairs with first feature i: [offsets[i], offsets[i + 1])
    /// Pairs with second feature j: by_second[k] for k in [second_offsets[j], second_offsets[j + 1]).
    Array<std::int64_t> second_offsets;
    Array<std::int64_t> by_second;  ///< positions in `pairs`, sorted by second feature, then by first
};

/// Result of a ProximityQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Proximities {
    bool any = false;        ///< true if anything is near
    std::int64_t count = 0;  ///< number of pairs if they are listed, else 0

    Array<std::uint8_t> world_hit;                   ///< per world: 1 if something is near (not for Output::any)
    std::array<ProximityList, feature_kinds> lists;  ///< by FeatureKind

    /// The edges and points that indices refer to: as in Impacts.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    /// For ProximityQuery::least, of a single mesh: least distance of each vertex, face and edge over its near pairs of
    /// all kinds, including those that `rings` and `rest` drop; rounded down; infinite for a feature in no pair. If the
    /// mesh lists points, vertices are counted by their position in that list.
    Array<double> vertex_distance, face_distance, edge_distance;

    Statistics statistics;

    ProximityList& operator[](FeatureKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const ProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    /// Returns the list of one kind.
    /// @{
    const ProximityList& vertex_faces() const { return (*this)[FeatureKind::vertex_face]; }
    const ProximityList& edge_edges() const { return (*this)[FeatureKind::edge_edge]; }
    const ProximityList& vertex_edges() const { return (*this)[FeatureKind::vertex_edge]; }
    const ProximityList& vertex_vertices() const { return (*this)[FeatureKind::vertex_vertex]; }
    /// @}
};

}  // namespace crumple
