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

/// Which features touch while every vertex goes straight from its start to its end, and when (docs/motion.md). A value:
/// it owns what it names.
struct ImpactQuery {
    using Result = Impacts;
    using DeviceResult = DeviceImpacts;
    using DistributedResult = DistributedImpacts;

    Output output = Output::pairs;  ///< `any`, `any_by_world`, `first` or `pairs`
    /// Features touch where their distance is at most this: Euclidean, finite, 0 or more; in the units of the
    /// coordinates. Exact as given.
    double min_distance = 0;
    /// The same as a share, in [0, 1), of the pair's own distance at the start; of both the larger one counts. A first
    /// impact with a share of 0.2 takes 1.7 to 3.4 times as long as without (docs/motion_figures.md).
    double min_distance_share = 0;
    /// Leave out features that touch at the start, by the minimum distance if there is one, and come no nearer than
    /// they start; decided exactly. A step may then begin within the minimum distance, and what moves apart is free. If
    /// they do come nearer, `toi` is the last moment before that: 0 if they approach at once. Features at a distance of
    /// 0 cannot come nearer and have no side, so they are left out wherever they go. Pairs of triangles that intersect
    /// at the start are listed all the same.
    bool approaching_only = false;
    bool weld = false;  ///< vertices at equal positions at the start and at the end count as one, for neighbours
    PairFilter filter = {};
    bool index = false;  ///< also make the offsets of ImpactList, where impacts are listed
    /// Also list pairs of triangles: those that intersect at the start (docs/contract.md, Neighbours::geometric), and
    /// those of whose features some pair is an impact. They count for `any` and `any_by_world`, too.
    bool triangle_pairs = false;
};

/// The first impact of all worlds. `output` and `index` are not read. FirstImpactQuery{{.min_distance = 1e-3}}: its
/// members are those of an ImpactQuery.
struct FirstImpactQuery : ImpactQuery {
    using Result = FirstImpact;
};

/// Choice of what is held back where something touches in a step.
enum class Held : std::uint8_t {
    worlds,    ///< the world of the two features; a mesh is one
    bodies,    ///< the two bodies
    vertices,  ///< the vertices of the two features
};

/// A share of the step with positions, so that no feature touches another on the way to those, as they are rounded:
/// start + toi (end - start), computed in floating point, is another motion than the one whose toi that is.
///
/// Where something touches, what `held` names stops short of the time of contact: by 2^-16 of it if that suffices, by
/// more if it touches again. The share is 0 if they touch at the start, or too soon for any share above 2^-40. All else
/// goes on. Features that touch while they rest at the start hold their whole world there, for no share is free of
/// that; with `approaching_only` they do not, and if they would come nearer, what `held` names stays at the start.
///
/// `output` and `index` are not read. Cost: one to three times that of a FirstImpactQuery; with Held::bodies and
/// Held::vertices that of an ImpactQuery for each round of a few.
struct FreeStepQuery : ImpactQuery {
    using Result = FreeStep;
    Held held = Held::worlds;
};

/// Impacts of one kind: unique, by first feature, then second; of worlds by world, then by body before each feature,
/// and pairs among bodies that are in all worlds come last.
struct ImpactList {
    Array<Pair> pairs;          ///< indices within their bodies; see FeatureKind
    Array<BodyPair> bodies;     ///< for each pair its bodies; empty for a single mesh
    Array<double> toi;          ///< first time of contact in [0, 1], rounded down: toi <= exact < next number
    Array<std::uint8_t> start;  ///< 1: they touch at the start (approaching_only: come nearer at once), toi = 0 exactly

    // Where ImpactQuery::index asks for them; a single mesh only:
    Array<std::int64_t> offsets;         ///< impacts of first feature i: [offsets[i], offsets[i + 1])
    Array<std::int64_t> second_offsets;  ///< the same of second features, into `by_second`
    Array<std::int64_t> by_second;       ///< positions in `pairs`, by second feature, then first
};

/// The first impact: least toi as rounded, then first in the order of the lists.
struct FirstImpact {
    bool found = false;
    FeatureKind kind = FeatureKind::vertex_face;
    Pair pair{};
    BodyPair bodies{};
    double toi = 0;  ///< where found
    bool start = false;
    friend bool operator==(const FirstImpact&, const FirstImpact&) = default;
};

/// A share of a step that is free.
struct FreeStep {
    double share = 0;  ///< 0 to 1, the least of all; 1: the whole step is free
    /// 3 a vertex: start + s (end - start) with the share s of its vertex, body or world, rounded to the precision of
    /// the mesh or body; of worlds body by body, as they are posed.
    Array<double> positions;
    FirstImpact first;        ///< the first impact of the uncut step, if there is one
    bool intersects = false;  ///< with ImpactQuery::triangle_pairs: some triangles intersect at the start
    Pair intersecting{};      ///< the first two of them
    BodyPair intersecting_bodies{};

    Array<double> vertex_shares;       ///< one a vertex, with Held::vertices
    Array<double> body_shares;         ///< one a body, otherwise, of worlds and two meshes
    Array<std::int64_t> first_vertex;  ///< of worlds and two meshes: body b has [first_vertex[b], first_vertex[b + 1])
};

/// Result of an ImpactQuery. A plain value: copy it to keep it beyond the detector's next call.
struct Impacts {
    /// True if anything touches; else the step is free. With ImpactQuery::triangle_pairs also if any intersect at
    /// the start.
    bool any = false;
    FirstImpact first;       ///< of features, of all worlds (from Output::first on)
    std::int64_t count = 0;  ///< impacts, where they are listed; else 0

    Array<std::uint8_t> world_hit;                ///< one a world: something touches (not for Output::any)
    Array<FirstImpact> world_first;               ///< one a world (from Output::first on)
    std::array<ImpactList, feature_kinds> lists;  ///< by FeatureKind
    /// Where ImpactQuery::triangle_pairs asks for them: triangles a < b (of worlds body by body) whose groups are
    /// wanted. The first time of their features; 0, with `start`, if they intersect at the start.
    ImpactList triangle_pairs;
    bool lists_triangle_pairs = false;  ///< they were asked for, be there none

    /// What edges are meant: those of body b are [first_edge[b], first_edge[b + 1]), as its shape lists them, or each
    /// edge of its triangles once, in lexicographic order. An edge's index counts within its body.
    Array<Edge> edges;
    Array<std::int64_t> first_edge;

    /// What points are meant where a shape lists them: those of body b are [first_point[b], first_point[b + 1]), its
    /// vertices in the order of the list. A body without any of its own has vertices by their index instead.
    Array<std::int32_t> points;
    Array<std::int64_t> first_point;

    Statistics statistics;

    ImpactList& operator[](FeatureKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const ImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    const ImpactList& vertex_faces() const { return (*this)[FeatureKind::vertex_face]; }
    const ImpactList& edge_edges() const { return (*this)[FeatureKind::edge_edge]; }
    const ImpactList& vertex_edges() const { return (*this)[FeatureKind::vertex_edge]; }
    const ImpactList& vertex_vertices() const { return (*this)[FeatureKind::vertex_vertex]; }
};

}  // namespace crumple
