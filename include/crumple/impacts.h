#pragma once

#include <cstdint>

#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/intersections.h"
#include "crumple/world.h"

namespace crumple {

struct Impacts;
struct DeviceImpacts;
struct DistributedImpacts;
struct FirstImpact;
struct FreeStep;

/// Query for all pairs of features that touch while every vertex moves straight from start to end, and when
/// (docs/motion.md). A value: it owns its data.
struct ImpactQuery {
    using Result = Impacts;
    using DeviceResult = DeviceImpacts;
    using DistributedResult = DistributedImpacts;

    Output output = Output::pairs;  ///< `any`, `any_by_world`, `first` or `pairs`
    /// Features touch if their distance is at most this: Euclidean, finite, 0 or more; in the units of the coordinates.
    /// Not rounded.
    double min_distance = 0;
    /// Minimum distance as a share, in [0, 1), of the pair's distance at the start; if both are given, the larger one
    /// applies. A first impact with a share of 0.2 takes 1.7 to 3.4 times as long as without (docs/motion_figures.md).
    double min_distance_share = 0;
    /// Drops pairs that touch at the start (by the minimum distance if there is one) and never come nearer than they
    /// are at the start; decided exactly. So a step may begin within the minimum distance, and features may move apart.
    /// If a pair does come nearer, `toi` is the greatest lower bound of the times at which it is nearer than at the
    /// start: 0 if the features approach at once. Pairs at distance 0 at the start cannot come nearer, so they are
    /// dropped however they move, even through each other. Pairs of triangles that intersect at the start are still
    /// listed.
    bool approaching_only = false;
    bool weld = false;  ///< vertices with equal positions at start and end count as one, for adjacency
    PairFilter filter = {};
    bool index = false;  ///< also makes the offsets of ImpactList, for Output::pairs
    /// Also lists pairs of triangles: those that intersect at the start (docs/contract.md, Neighbours::geometric), and
    /// those for which some impact is between a feature of one triangle and a feature of the other. They count for
    /// `any` and `any_by_world`, too.
    bool triangle_pairs = false;
};

/// Query for the first impact of all worlds. Ignores `output` and `index`. The members are those of an ImpactQuery:
/// FirstImpactQuery{{.min_distance = 1e-3}}.
struct FirstImpactQuery : ImpactQuery {
    using Result = FirstImpact;
};

/// Objects that are held back if two features touch during a step.
enum class Held : std::uint8_t {
    worlds,    ///< the world of the two features; a mesh is one world
    bodies,    ///< the two bodies
    vertices,  ///< the vertices of the two features
};

/// Query for the share of a step that is free, and for end positions that can be reached without any impact. The motion
/// from the start to these positions, as rounded, is verified to be free. Rounding makes it a slightly different motion
/// from a fraction of the original step, so a `toi` of the original step does not bound it.
///
/// If two features touch, the objects that `held` selects stop before the time of contact: by 2^-16 of that time if
/// this suffices, by more if the shortened motion still touches. Their share is 0 if the features touch at the start,
/// if only a share below 2^-40 would be free, or after 40 attempts. Everything else moves on to the end of the step.
/// Features that touch at the start hold their whole world there, whatever `held` is, because no share of the step is
/// free of that contact. With `approaching_only` they do not hold their world; if they would come nearer, only the
/// objects that `held` selects stay at the start.
///
/// Ignores `output` and `index`. Cost: one to three times that of a FirstImpactQuery; with Held::bodies and
/// Held::vertices that of an ImpactQuery for each of a few iterations.
struct FreeStepQuery : ImpactQuery {
    using Result = FreeStep;
    Held held = Held::worlds;
};

/// Impacts of one kind, each once, sorted by first feature, then second. For worlds sorted by world, first body, first
/// feature, second body, second feature; pairs among bodies that are in all worlds come last.
struct ImpactList {
    Array<Pair> pairs;          ///< indices within their bodies; see FeatureKind
    Array<BodyPair> bodies;     ///< the bodies of each pair; empty for a single mesh
    Array<double> toi;          ///< first time of contact in [0, 1], rounded down: toi <= exact < next number
    Array<std::uint8_t> start;  ///< 1: touch at the start (approaching_only: and approach at once); toi is exactly 0

    // For ImpactQuery::index, a single mesh only:
    Array<std::int64_t> offsets;  ///< impacts with first feature i: [offsets[i], offsets[i + 1])
    /// Pairs with second feature j: by_second[k] for k in [second_offsets[j], second_offsets[j + 1]).
    Array<std::int64_t> second_offsets;
    Array<std::int64_t> by_second;  ///< positions in `pairs`, sorted by second feature, then by first
};

/// Impact with the least rounded `toi`; of several, the first by kind, in the order of FeatureKind, then by the order
/// of its list.
struct FirstImpact {
    bool found = false;
    FeatureKind kind = FeatureKind::vertex_face;
    Pair pair{};
    BodyPair bodies{};
    double toi = 0;  ///< valid if found
    bool start = false;
    friend bool operator==(const FirstImpact&, const FirstImpact&) = default;
};

/// Result of a FreeStepQuery.
struct FreeStep {
    /// Smallest share of the step that any vertex, body or world may go, 0 to 1; 1: the whole step is free.
    double share = 0;
    /// 3 per vertex: start + s (end - start), where s is the share of the vertex, its body or its world; rounded to the
    /// precision of the mesh or body. For worlds the posed vertices, body after body.
    Array<double> positions;
    FirstImpact first;        ///< the first impact of the whole step, if any
    bool intersects = false;  ///< with ImpactQuery::triangle_pairs: true if triangles intersect at the start
    Pair intersecting{};      ///< the first such pair, valid if `intersects`
    BodyPair intersecting_bodies{};

    Array<double> vertex_shares;  ///< 1 per vertex, for Held::vertices
    Array<double> body_shares;    ///< 1 per body, for other values of FreeStepQuery::held, for worlds and two meshes
    /// For worlds and two meshes: body b has vertices [first_vertex[b], first_vertex[b + 1]).
    Array<std::int64_t> first_vertex;
};

/// Result of an ImpactQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Impacts {
    /// True if anything touches (otherwise the step is free), or with ImpactQuery::triangle_pairs if triangles
    /// intersect at the start.
    bool any = false;
    FirstImpact first;       ///< first impact of all worlds, for Output::first and Output::pairs
    std::int64_t count = 0;  ///< number of impacts if they are listed, else 0

    Array<std::uint8_t> world_hit;                ///< per world: 1 if something touches (not for Output::any)
    Array<FirstImpact> world_first;               ///< 1 per world, for Output::first and Output::pairs
    std::array<ImpactList, feature_kinds> lists;  ///< by FeatureKind
    /// For ImpactQuery::triangle_pairs: pairs of triangles whose groups the filter selects, in the order of an
    /// ImpactList; for a single mesh a < b. `toi` is the first time of contact of their features; 0, with `start`, if
    /// they intersect at the start.
    ImpactList triangle_pairs;
    bool lists_triangle_pairs = false;  ///< true if pairs of triangles were requested, even if there are none

    /// The edges that indices refer to; an edge's index counts within its body. Body b has [first_edge[b], first_edge[b
    /// + 1]): the edges that its shape lists, or each edge of its triangles once, in lexicographic order.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;

    /// The points that indices refer to, if a shape lists points: body b has [first_point[b], first_point[b + 1]), the
    /// vertices in the order of its list. For a body whose shape lists no points, pairs have vertex indices instead.
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    Statistics statistics;

    ImpactList& operator[](FeatureKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const ImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    /// Returns the list of one kind.
    /// @{
    const ImpactList& vertex_faces() const { return (*this)[FeatureKind::vertex_face]; }
    const ImpactList& edge_edges() const { return (*this)[FeatureKind::edge_edge]; }
    const ImpactList& vertex_edges() const { return (*this)[FeatureKind::vertex_edge]; }
    const ImpactList& vertex_vertices() const { return (*this)[FeatureKind::vertex_vertex]; }
    /// @}
};

}  // namespace crumple
