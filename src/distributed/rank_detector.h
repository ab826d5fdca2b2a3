#pragma once

// The detector of one rank, over any transport: it knows the order of the phases.
//
//     question   ranks ask the same                     search  each rank searches the parts that it owns
//     input      each checks what it brings             rows    rows go to who brought their first triangle
//     ids        each element once, copies equal        output  each puts its rows in order
//     place      centres, if those at hand do not serve
//     members    each finds parts of its triangles
//     room       owners make room, and are told what is new

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
#include "distributed/part_placement.h"
#include "distributed/part_search.h"
#include "distributed/rank_bodies.h"
#include "distributed/rank_query.h"
#include "distributed/share.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/rounds.h"

namespace crumple::distribute {

/// Shown by a shared library, for crumple::mpi is another one.
class CRUMPLE_API RankDetector {
   public:
    /// Collective. The transport must outlive this.
    RankDetector(Transport& transport, const DistributedOptions& options);
    ~RankDetector();

    // As mpi::Detector::find:
    const DistributedIntersections& find(const MeshShare& share, const IntersectionQuery& query = {},
                                         std::stop_token stop = {});
    const DistributedImpacts& find(const MeshShare& share, const ImpactQuery& query, std::stop_token stop = {});
    const DistributedProximities& find(const MeshShare& share, const ProximityQuery& query, std::stop_token stop = {});
    const DistributedIntersections& find(const WorldShare& share, const IntersectionQuery& query = {},
                                         std::stop_token stop = {});
    const DistributedImpacts& find(const WorldShare& share, const ImpactQuery& query, std::stop_token stop = {});
    const DistributedProximities& find(const WorldShare& share, const ProximityQuery& query, std::stop_token stop = {});

    const DistributedOptions& options() const { return options_; }
    const DistributedStatistics& statistics() const { return statistics_; }
    /// What tells how long a search took, in milliseconds; by default the time of day.
    void set_clock(double (*clock)()) { clock_ = clock; }
    /// Called at the beginning of each phase, where what it throws is settled.
    void set_hook(std::function<void(Phase)> hook) { hook_ = std::move(hook); }
    /// Called every now and then within searches, as Detector::set_poll's is.
    void set_poll(std::function<void()> poll);
    /// As mpi::Detector::set_progress.
    void set_progress(std::function<void(const DistributedProgress&)> show) { show_ = std::move(show); }

   private:
    /// All phases. ask() makes the question, and may throw; prepare(), which may communicate, is called once it is
    /// settled; work() does the last three phases.
    void answer(const MeshShare& share, const VertexView* end, FunctionRef<Asked()> ask, FunctionRef<void()> prepare,
                std::stop_token stop, FunctionRef<void()> work);
    void answer(const WorldShare& share, const PairFilter& rules, bool moving, FunctionRef<Asked()> ask,
                std::stop_token stop, FunctionRef<void()> work);
    void search_rows(const IntersectionQuery& query, RankOutput wants);
    void search_body_pairs(const IntersectionQuery& query);
    void search_impacts(const ImpactQuery& question);
    void search_near(const ProximityQuery& question);
    void name_bodies_of_rows();
    template <class Answer>
    void name_bodies_of_features(Answer& answer);
    template <class Each, class Result>
    void search_features(Each each, bool listed, bool cut_short, Result& result);

    void settle_question(const MeshShare& share, const VertexView* end);
    void read(const MeshShare& share, const VertexView* end);
    void settle_ids();
    void place();
    void list_members();
    void give_out();
    std::vector<std::vector<int>> ranks_near_parts();
    void give_out_anew();
    void own_parts();
    void deliver();
    /// each(part) searches a part and adds up what is found here; until done() says that this is enough.
    void search(FunctionRef<void(AssembledPart&)> each, FunctionRef<bool()> done);
    /// Adds up over all ranks: what is found, and the work.
    std::int64_t add_up(std::int64_t found, bool cut_short);
    FirstImpact first_of_all(const FirstImpact& here);
    void show_phase(Phase phase);
    void forget();
    void drop_parts();

    int parts_wanted() const;
    bool on_any_rank(bool here);
    void reduce(std::span<std::int64_t> numbers, Reduction how) { transport_.reduce(numbers, how); }

    Transport& transport_;
    DistributedOptions options_;
    Rounds rounds_;
    Agreement agree_;
    std::function<void(Phase)> hook_;
    std::function<void(const DistributedProgress&)> show_;
    std::stop_token stop_;
    double (*clock_)();
    Stopwatch watch_;
    Phase phase_ = Phase::question;
    std::optional<Phase> shown_;  ///< the latest phase of this call that show_ knows of

    // Of this call:
    Asked asked_;
    bool float32_ = true, groups_ = false, triangle_ids_ = false, vertex_ids_ = false;
    bool same_ = false;  ///< triangles, groups and ids are those of the call before; later: so are parts
    std::vector<std::int64_t> counts_;
    Box box_;
    std::vector<std::int64_t> work_;  ///< nanoseconds of each part
    DistributedStatistics statistics_;

    // From call to call:
    std::optional<PartSearch> engine_;
    HostShape staged_;  ///< a share that lies on a device
    Share share_;
    Bodies bodies_;
    SharedVertices copies_;
    Placement placement_;
    Owners owners_;
    Members members_;
    std::vector<AssembledPart> mine_;
    std::vector<std::int64_t> expected_work_;  ///< nanoseconds of each part; empty: not known
    std::int64_t reserved_ = 0;                ///< bytes of parts, as the meter has them
    std::optional<FeatureDemand> demand_;      ///< that parts are made for
    FeatureOwners features_;
    std::map<std::int32_t, FeatureAssembly> assemblies_;  ///< of this rank's parts, of questions about features
    DistributedIntersections result_;
    DistributedIntersections world_result_;
    DistributedImpacts impacts_;
    DistributedProximities nearby_;
};

}  // namespace crumple::distribute
