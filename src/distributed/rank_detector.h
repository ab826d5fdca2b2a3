#pragma once

// Detector of one rank, over any transport. Determines the order of the phases:
//
//     query      compare queries and options            search  search the parts that the rank owns
//     input      check the local mesh                   rows    send rows to the rank of their first element
//     ids        check ids and ghost vertices           output  sort the rows
//     place      make centres, unless reused
//     members    find the parts of local triangles
//     room       owners allocate memory, receive deltas
//
// Overlap queries search whole bodies instead of parts (overlaps/collected_overlaps.cpp). For a mesh they search parts,
// and gather the mesh on one rank (overlaps/overlap_of_mesh.cpp).

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "backends/device_shape.h"
#include "base/stopwatch.h"
#include "crumple/distributed.h"
#include "crumple/export.h"
#include "crumple/function_ref.h"
#include "distributed/assembled_part.h"
#include "distributed/directory.h"
#include "distributed/feature_assembly.h"
#include "distributed/feature_owners.h"
#include "distributed/members.h"
#include "distributed/part_layout.h"
#include "distributed/part_search.h"
#include "distributed/rank_bodies.h"
#include "distributed/rank_mesh.h"
#include "distributed/rank_query.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/message_batches.h"

namespace crumple::distribute {

class BodyCopies;
class PairsOfBodies;

/// Exported, since crumple::mpi is another shared library.
class CRUMPLE_API RankDetector {
   public:
    /// Collective. The transport must outlive this.
    RankDetector(Transport& transport, const DistributedOptions& options);
    ~RankDetector();

    // See mpi::Detector::find:
    const DistributedIntersections& find(const LocalMesh& local, const IntersectionQuery& query = {},
                                         std::stop_token stop = {});
    const DistributedImpacts& find(const LocalMesh& local, const ImpactQuery& query, std::stop_token stop = {});
    const DistributedProximities& find(const LocalMesh& local, const ProximityQuery& query, std::stop_token stop = {});
    const DistributedIntersections& find(const LocalWorld& local, const IntersectionQuery& query = {},
                                         std::stop_token stop = {});
    const DistributedImpacts& find(const LocalWorld& local, const ImpactQuery& query, std::stop_token stop = {});
    const DistributedProximities& find(const LocalWorld& local, const ProximityQuery& query, std::stop_token stop = {});

    const DistributedOverlaps& find(const LocalWorld& local, const OverlapQuery& query, std::stop_token stop = {});
    const DistributedOverlaps& find(const LocalMesh& local, const OverlapQuery& query, std::stop_token stop = {});

    const DistributedOptions& options() const { return options_; }
    const DistributedStatistics& statistics() const { return statistics_; }
    /// Sets the clock that measures searches, in milliseconds; by default std::chrono::steady_clock.
    void set_clock(double (*clock)()) { clock_ = clock; }
    /// Sets a function that is called at the beginning of each collective error check: if it throws, the call ends on
    /// all ranks.
    void set_hook(std::function<void(Phase)> hook) { hook_ = std::move(hook); }
    /// Sets a function that is called regularly within searches, see Detector::set_poll.
    void set_poll(std::function<void()> poll);
    /// See mpi::Detector::set_progress.
    void set_progress(std::function<void(const DistributedProgress&)> show) { show_ = std::move(show); }

   private:
    /// Guards one call: runs its phases, measures them, and forgets everything after an error.
    void guard(std::stop_token stop, FunctionRef<void()> phases);
    /// Runs all phases. make_query() returns the query as ranks compare it, and may throw. prepare() is called after
    /// the comparison, and may communicate. work() runs the phases search, rows and output.
    void run(const LocalMesh& local, const VertexView* end, FunctionRef<ComparedQuery()> make_query,
             FunctionRef<void()> prepare, std::stop_token stop, FunctionRef<void()> work);
    void run(const LocalWorld& local, const PairFilter& rules, bool moving, FunctionRef<ComparedQuery()> make_query,
             std::stop_token stop, FunctionRef<void()> work);
    void search_rows(const IntersectionQuery& query, RankOutput wants);
    void search_body_pairs(const IntersectionQuery& query);
    void search_impacts(const ImpactQuery& query);
    void search_near(const ProximityQuery& query);
    void name_bodies_of_rows();
    void find_overlap_of_mesh(const OverlapQuery& query);
    int rank_of_first_triangle();
    void find_overlaps(const OverlapQuery& query);
    void list_pairs_of_bodies(const OverlapQuery& query, PairsOfBodies& pairs);
    void search_overlaps(const OverlapQuery& query, const PairsOfBodies& pairs, const BodyCopies& copies,
                         std::array<Overlaps, 2>& found, bool& any);
    void collect_overlaps(const OverlapQuery& query, std::array<Overlaps, 2>& found);
    template <class Result>
    void name_bodies_of_features(Result& result);
    template <class Each, class Result>
    void search_features(Each each, bool listed, bool cut_short, Result& result);

    void check_query_of_ranks(const LocalMesh& local, const VertexView* end);
    void read(const LocalMesh& local, const VertexView* end);
    void check_ids();
    void place();
    void list_members();
    void give_out();
    std::vector<std::vector<int>> ranks_near_parts();
    void give_out_anew();
    void own_parts();
    void deliver();
    /// Calls each(part) for the parts of this rank until done() returns true. each() searches a part and accumulates
    /// the result of this rank.
    void search(FunctionRef<void(AssembledPart&)> each, FunctionRef<bool()> done);
    /// Sums results and work over all ranks, and returns the number of results. `cut_short`: does not use the work to
    /// balance later calls.
    std::int64_t add_up(std::int64_t found, bool cut_short);
    FirstImpact first_of_all(const FirstImpact& here);
    void show_phase(Phase phase);
    void forget();
    void drop_parts();

    int requested_parts() const;
    bool on_any_rank(bool here);
    void reduce(std::span<std::int64_t> numbers, Reduction how) { transport_.reduce(numbers, how); }

    Transport& transport_;
    DistributedOptions options_;
    MessageBatches batches_;
    CollectiveCheck check_;
    std::function<void(Phase)> hook_;
    std::function<void(const DistributedProgress&)> show_;
    std::stop_token stop_;
    double (*clock_)();
    Stopwatch watch_;
    Phase phase_ = Phase::query;
    std::optional<Phase> shown_;  ///< latest phase of this call that was reported to show_

    // Per call:
    ComparedQuery compared_;
    bool float32_ = true, groups_ = false, triangle_ids_ = false, vertex_ids_ = false;
    bool same_ = false;  ///< triangles, groups and ids are those of the previous call; after place() also parts
    std::vector<std::int64_t> counts_;
    Box box_;
    std::vector<std::int64_t> work_;  ///< nanoseconds of each part
    DistributedStatistics statistics_;

    // Cached between calls:
    std::optional<PartSearch> engine_;
    HostShape staged_;  ///< host copy of a local mesh in device memory
    RankMesh local_;
    Bodies bodies_;
    GhostVertices copies_;
    PartLayout layout_;
    Owners owners_;
    RankMembers members_;
    std::vector<AssembledPart> mine_;
    std::vector<std::int64_t> expected_work_;  ///< nanoseconds of each part; empty: unknown
    std::int64_t reserved_ = 0;                ///< bytes of parts that the meter counts
    std::optional<FeatureDemand> demand_;      ///< parameters that parts are made for; empty: intersections
    FeatureOwners features_;
    std::map<std::int32_t, FeatureAssembly> assemblies_;  ///< by part of this rank, for queries about features
    DistributedIntersections result_;
    DistributedIntersections world_result_;
    DistributedImpacts impacts_;
    DistributedProximities nearby_;
    DistributedOverlaps overlaps_;
};

}  // namespace crumple::distribute
