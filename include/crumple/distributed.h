#pragma once

// Input, options and results of searches of one scene that is distributed over several ranks, i.e. MPI processes
// (crumple/mpi.h). Each rank provides local triangles or bodies, and gets the rows of the result that belong to them.
// docs/distributed.md describes the method.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "crumple/world.h"

namespace crumple {

/// Local mesh of a rank: triangles, with all vertices that they name. Views, nothing is copied; the arrays must stay
/// unchanged until the call returns.
///
/// Over all ranks triangles are numbered 0 to N - 1, each exactly once, and vertices 0 to V - 1. Several ranks may have
/// copies of one vertex (ghost vertices), which makes the triangles that name it adjacent. Its coordinates must then be
/// equal bit by bit, compared as float64 if some rank has float64. At most 2^31 - 1 triangles, and as many vertices,
/// over all ranks.
struct LocalMesh {
    MeshView mesh;  ///< `triangles` are indices into the `vertices` of this rank
    /// Number of each local triangle. If the list is empty on all ranks, triangles are numbered rank by rank.
    std::span<const std::int64_t> triangle_ids;
    /// Number of each local vertex. If the list is empty on all ranks, vertices are numbered rank by rank, and there
    /// are no ghost vertices.
    std::span<const std::int64_t> vertex_ids;

    /// Returns this local mesh with the given positions of its vertices at the end of a step.
    LocalMesh moving_to(const VertexView& end) const { return {mesh.moving_to(end), triangle_ids, vertex_ids}; }
};

/// Local bodies of a rank, and their shapes. Views, as in LocalMesh. All ranks share one world, so Body::world is 0.
/// Over all ranks bodies are numbered 0 to B - 1, each exactly once; pair filters and results use these numbers. Every
/// rank has a table of all bodies, about 70 bytes each.
///
/// If bodies only move between two calls (new poses, or new coordinates of their shapes), only coordinates are sent.
/// Shape::name is ignored; poses are in host memory.
struct LocalWorld {
    World world;
    /// Number of each local body. If the list is empty on all ranks, bodies are numbered rank by rank.
    std::span<const std::int64_t> body_ids;
};

/// Configuration of distributed calls. Must be the same on all ranks, except for `detector`. No option changes a
/// result.
struct DistributedOptions {
    /// Options of this rank's detector. `threads` 0: the cores that the rank may use, divided by the ranks that share
    /// them. `device` is that of the first rank of a machine; the following ranks of the machine use the following
    /// devices, cyclically. `memory_limit` applies to this rank alone.
    Options detector;
    /// Number of parts into which the scene is divided for all ranks together, 1 to 262,144; 0: chosen from the number
    /// of ranks. More parts balance the load better, but overlap more.
    int parts = 0;
    /// Approximate size in bytes of the message batches that a rank sends, and of the batches that it receives; at
    /// least 1 KiB. A batch is divided equally among the ranks, but each message has at least one row.
    std::int64_t batch_bytes = std::int64_t{1} << 26;
};

/// Phases of a call, in order: check that all ranks make the same query; read the input; match ids over ranks; compute
/// the centres of parts (place); find the parts of each local triangle (members); reserve memory for the parts and send
/// their triangles (memory); search; send the rows of the result; merge them (output). Each phase ends with a
/// collective error check.
enum class Phase : std::uint8_t { query, input, ids, place, members, memory, search, rows, output };
inline constexpr int phase_count = 9;
/// Returns the name of the enumerator, such as "query".
constexpr std::string_view phase_name(Phase phase) {
    constexpr std::array<std::string_view, phase_count> names{"query",  "input",  "ids",  "place", "members",
                                                              "memory", "search", "rows", "output"};
    return names[static_cast<std::size_t>(phase)];
}

/// Progress of a call on one rank.
struct DistributedProgress {
    Phase phase = Phase::query;
    int parts_done = 0;  ///< in Phase::search: number of parts that this rank has searched
    int parts = 0;       ///< in Phase::search: number of parts to search; a first hit may end the search before
};

/// Counts and times of a call on this rank.
struct DistributedStatistics {
    double milliseconds = 0;                               ///< wall-clock time of the call
    std::array<double, phase_count> phase_milliseconds{};  ///< including the communication at the end of the phase
    /// Number of parts that this rank has searched; for overlaps, number of pairs of bodies.
    int parts = 0;
    std::int64_t members = 0;      ///< triangles of these parts, counted once per part
    std::int64_t bytes_sent = 0;   ///< sent to other ranks
    std::int64_t messages = 0;     ///< number of messages to other ranks
    double work_milliseconds = 0;  ///< time of the searches
    double largest_work = 0;       ///< maximum of work_milliseconds over all ranks
    double mean_work = 0;          ///< mean of work_milliseconds over all ranks
    /// True if only vertices have moved since the previous call, so that only coordinates were sent.
    bool moved = false;
    Statistics search;  ///< summed over this rank's parts

    double& operator[](Phase phase) { return phase_milliseconds[static_cast<std::size_t>(phase)]; }
    double operator[](Phase phase) const { return phase_milliseconds[static_cast<std::size_t>(phase)]; }
};

/// Result of an IntersectionQuery: rows of this rank, and totals over all ranks. For meshes, the rows are the pairs
/// whose first triangle is local, in order, with the numbers of triangles over all ranks. For worlds, they are the
/// pairs whose first body is local, in the order of Intersections. Merged by first triangle or body, the rows of all
/// ranks are the same bytes as those of a single machine.
struct DistributedIntersections {
    bool any = false;        ///< true if some rank has found a pair
    std::int64_t count = 0;  ///< number of pairs of triangles over all ranks if they are counted or listed, else 0
    /// For worlds: the bodies of each pair; for Output::body_pairs each pair of bodies once. Else empty.
    Array<BodyPair> bodies;
    Array<Pair> pairs;  ///< for worlds: indices within the bodies
    Contacts contacts;  ///< contacts of these pairs; empty unless requested
    DistributedStatistics statistics;
};

/// Result of an ImpactQuery: the impacts whose first feature belongs to this rank, in order. A vertex or an edge
/// belongs to the rank with the lowest triangle that names it. Features have their numbers over all ranks: faces have
/// those of triangles, edges are numbered as in Impacts. For worlds, features have their indices within their bodies.
/// Merged, the rows of all ranks are the same bytes as those of a single machine.
struct DistributedImpacts {
    bool any = false;                             ///< true if some rank has found a pair
    FirstImpact first;                            ///< over all ranks, for Output::first and Output::pairs
    std::array<ImpactList, feature_kinds> lists;  ///< by FeatureKind
    std::int64_t count = 0;                       ///< number of impacts over all ranks, if they are listed
    /// Edges in this rank's rows: their numbers, ascending, and the numbers of their vertices.
    Array<std::int32_t> edge_ids;
    Array<Edge> edges;
    /// For worlds: the body of each edge, sorted by body first, then by number; else empty.
    Array<std::int32_t> edge_bodies;
    DistributedStatistics statistics;

    const ImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

/// Result of a ProximityQuery: the near pairs whose first feature belongs to this rank. Members are as in
/// DistributedImpacts.
struct DistributedProximities {
    bool any = false;
    std::array<ProximityList, feature_kinds> lists;
    std::int64_t count = 0;
    Array<std::int32_t> edge_ids;
    Array<Edge> edges;
    Array<std::int32_t> edge_bodies;
    bool closest = false;  ///< true if ProximityQuery::closest was set
    DistributedStatistics statistics;

    const ProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

/// Result of an OverlapQuery: rows of this rank, and totals over all ranks.
struct DistributedOverlaps {
    bool any = false;        ///< true if some rank has found a row
    std::int64_t count = 0;  ///< number of rows over all ranks if they are listed, else 0
    /// Rows whose first body is local, in order, with all lists that belong to them. Bodies have their numbers over all
    /// ranks, vertices and triangles their indices within bodies. `skipped` has the local ones of the skipped bodies;
    /// `body_volume` and `is_solid` belong to the local bodies, in the order in which this rank has provided them;
    /// `world_hit` and `statistics` are empty. Merged by first body, the rows of all ranks are the same bytes as those
    /// of a single machine. For a LocalMesh, which is body 0, the rank of triangle 0 has everything.
    Overlaps rows;
    DistributedStatistics statistics;
};

}  // namespace crumple
