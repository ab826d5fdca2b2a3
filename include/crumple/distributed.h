#pragma once

// One scene on several ranks, which are processes of MPI (crumple/mpi.h): each brings triangles of its own, and gets
// the rows of the answer that are about them. docs/distributed.md

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/proximities.h"
#include "crumple/world.h"

namespace crumple {

/// The triangles that one rank brings, with all vertices that they name. Views, nothing is copied; they must stay as
/// they are until the call returns.
///
/// Over all ranks triangles are numbered 0 to N - 1, each once, and vertices 0 to V - 1. Ranks may have copies of a
/// vertex, which must be equal bit by bit, each as float64 where some rank has float64: that is what makes triangles of
/// different ranks neighbours. There may be 2^31 - 1 triangles, and as many vertices, over all ranks.
struct MeshShare {
    MeshView mesh;  ///< `triangles` count in this rank's `vertices`
    /// Which ones these are. Empty on all ranks: those of rank 0, then those of rank 1, and so on.
    std::span<const std::int64_t> triangle_ids;
    /// The same of the vertices. Empty on all ranks: no rank has a copy of another's.
    std::span<const std::int64_t> vertex_ids;

    /// The same share, on its way to `end`: where each of its vertices is at the end of a step.
    MeshShare moving_to(const VertexView& end) const { return {mesh.moving_to(end), triangle_ids, vertex_ids}; }
};

/// The bodies that one rank brings, whole, and the shapes that these need. Views, as in MeshShare. All ranks share one
/// world, so Body::world is 0, and bodies have numbers over all ranks, 0 to B - 1, each once: those by which rules and
/// answers name them. Every rank keeps a table of all bodies, some 70 bytes each.
///
/// A body that only moves (another pose, other vertices of its shape) is no new body: only coordinates travel. Names of
/// shapes are not used; poses lie in host memory.
struct WorldShare {
    World world;
    /// Which ones the bodies are. Empty on all ranks: those of rank 0, then those of rank 1, and so on.
    std::span<const std::int64_t> body_ids;
};

/// How ranks work together. The same on all ranks, but for `detector`. None of these changes an answer.
struct DistributedOptions {
    /// Of the detector of each rank. `threads` 0: the cores that the rank is allowed, divided by the ranks that share
    /// them. `device`: of the first rank of a machine; the next ones take the next devices, and begin anew after the
    /// last. `memory_limit` is the rank's own.
    Options detector;
    /// Parts that the scene is cut into over all ranks, 1 to 262,144; 0: chosen from the number of ranks. More parts
    /// are shared out more evenly, but overlap more.
    int parts = 0;
    /// Bytes that a rank may have on their way at a time, about, out and in each: at least 1 KiB. Each pair of ranks
    /// has an equal share of them, and one row at least.
    std::int64_t round_bytes = std::int64_t{1} << 26;
};

/// What a call does on each rank, in order. Ranks agree at the end of each that all of them go on.
enum class Phase : std::uint8_t { question, input, ids, place, members, room, search, rows, output };
inline constexpr int phase_count = 9;
constexpr std::string_view phase_name(Phase phase) {
    constexpr std::array<std::string_view, phase_count> names{"question", "input",  "ids",  "place", "members",
                                                              "room",     "search", "rows", "output"};
    return names[static_cast<std::size_t>(phase)];
}

/// How far a call is on one rank.
struct DistributedProgress {
    Phase phase = Phase::question;
    int parts_done = 0;  ///< in Phase::search: parts that this rank has searched
    int parts = 0;       ///< in Phase::search: parts that it searches in this call, unless a first hit is enough
};

/// What a call did on this rank.
struct DistributedStatistics {
    double milliseconds = 0;                               ///< wall-clock time of the call
    std::array<double, phase_count> phase_milliseconds{};  ///< with the communication that follows each
    int parts = 0;                                         ///< that this rank has searched
    std::int64_t members = 0;                              ///< triangles of these, each counted in each
    std::int64_t bytes_sent = 0;                           ///< to other ranks
    std::int64_t messages = 0;                             ///< the same
    double work_milliseconds = 0;                          ///< time of the searches
    double largest_work = 0;                               ///< over all ranks, in milliseconds
    double mean_work = 0;                                  ///< the same
    bool moved = false;  ///< only vertices have moved since the call before, so that only coordinates were sent
    Statistics search;   ///< summed over this rank's parts

    double& operator[](Phase phase) { return phase_milliseconds[static_cast<std::size_t>(phase)]; }
    double operator[](Phase phase) const { return phase_milliseconds[static_cast<std::size_t>(phase)]; }
};

/// A rank's rows of the intersections. Of triangles: those whose first triangle it has brought, in order, with the
/// numbers that triangles have over all ranks. Of bodies: those whose first body it has brought, in the order of
/// Intersections. Merged by first triangle or body, the rows of all ranks are those of one machine, byte for byte.
struct DistributedIntersections {
    bool any = false;        ///< over all ranks
    std::int64_t count = 0;  ///< pairs of triangles over all ranks, where they are counted or listed; else 0
    Array<BodyPair> bodies;  ///< of bodies: for each pair its bodies; for Output::body_pairs each pair once; else empty
    Array<Pair> pairs;       ///< of bodies as they count within these
    Contacts contacts;       ///< of these; empty unless asked for
    DistributedStatistics statistics;
};

/// A rank's share of the impacts of a step: those whose first feature is its own, in order. A vertex and an edge belong
/// to the rank with the lowest triangle that names them. Features have the numbers that they have over all ranks: faces
/// those of triangles, edges as Impacts numbers them; of bodies those that they have within their bodies. Merged, the
/// rows of all ranks are those of one machine, byte for byte.
struct DistributedImpacts {
    bool any = false;                             ///< over all ranks
    FirstImpact first;                            ///< over all ranks (from Output::first on)
    std::array<ImpactList, feature_kinds> lists;  ///< by FeatureKind
    std::int64_t count = 0;                       ///< impacts over all ranks, where they are listed
    /// The edges that this rank's rows name: their numbers, ascending, and the numbers of their vertices.
    Array<std::int32_t> edge_ids;
    Array<Edge> edges;
    Array<std::int32_t> edge_bodies;  ///< of bodies: whose edges these are, ascending before the numbers; else empty
    DistributedStatistics statistics;

    const ImpactList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

/// The same of what is near.
struct DistributedProximities {
    bool any = false;
    std::array<ProximityList, feature_kinds> lists;
    std::int64_t count = 0;
    Array<std::int32_t> edge_ids;
    Array<Edge> edges;
    Array<std::int32_t> edge_bodies;
    bool closest = false;  ///< ProximityQuery::closest was asked for
    DistributedStatistics statistics;

    const ProximityList& operator[](FeatureKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
};

}  // namespace crumple
