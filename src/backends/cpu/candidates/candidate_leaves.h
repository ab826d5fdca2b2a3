#pragma once

// Candidates in the order of the stages. Triangles are swept as boxes along the axes of the coordinates; of a pair of
// triangles whose boxes overlap the features that the one owns are held against those that the other owns.

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "backends/cpu/candidates/candidate_kernels.h"
#include "backends/cpu/leaf_question.h"
#include "backends/cpu/pair_range.h"
#include "filters/candidates/box_test.h"
#include "geometry/normaliser.h"
#include "queries/candidate_request.h"

namespace crumple::cpu {

/// What a worker has found, by kind.
using CandidateHits = std::array<Array<Pair>, candidate_kinds>;

/// Told of so many candidates more, in any worker; may take them.
using CandidateHitSink = FunctionRef<void(CandidateHits& hits, std::size_t more)>;

/// How an answer in blocks is searched.
struct CandidateShare {
    const FeatureRange* range = nullptr;  ///< only these pairs, where `kind` alone is asked for; null: all
    CandidateKind kind = CandidateKind::vertex_face;
    const CandidateHitSink* sink = nullptr;     ///< if there is a range there is one
    const std::atomic<bool>* enough = nullptr;  ///< the search may end
};

class CandidateLeaves final : public LeafQuestion {
   public:
    CandidateLeaves(MemoryMeter* meter, int workers, const CandidateKernels& kernels);

    /// What is asked, from begin() on.
    void ask(const CandidateRequest& query);
    /// Of which only a share is wanted at a time; until the next ask().
    void ask_for(const CandidateShare& share) { share_ = share; }

    void begin(const Call& call) override;
    void leave_out(const Call& call, Levels& levels) override;
    bool stop() const override;
    void build(const BuildInput& input, LeafMembers& members, std::size_t worker) override;
    void place(const SortedLeaf& leaf, std::size_t worker) override;
    void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
               std::size_t builder, std::size_t worker) override;
    void finish(Statistics& statistics) override;

    /// Candidates of which one triangle owns both features, of triangles [begin, end): no pair of triangles has them.
    void search_within(std::int64_t begin, std::int64_t end, std::size_t worker);

    /// What each worker has found.
    std::span<const Array<Pair>* const> found(CandidateKind kind) const {
        return found_[static_cast<std::size_t>(kind)];
    }
    /// That of one.
    CandidateHits& hits(std::size_t worker) { return worker_[worker]->found; }

   private:
    struct Worker {
        explicit Worker(MemoryMeter* m);
        Array<CandidateRecord> built;   ///< in the order of LeafMembers
        Array<CandidateRecord> sorted;  ///< by physical row
        CandidateChunk candidates;
        Array<UnsureHit> unsure;  ///< of a batch
        CandidateHits found;
        Statistics statistics;
    };

    struct GrownBox {
        Vec3f low, high;
    };
    /// Returns the box of the triangle.
    GrownBox write_member(std::int32_t triangle, const CandidateKey& key, CandidateRecord& record) const;
    unsigned owned_lanes(std::int32_t triangle) const;
    void drop_foreign(const SortedLeaf& leaf, const Ownership& ownership, Worker& worker) const;
    void narrow(const Worker& builder, Worker& worker) const;
    void list(const UnsureHit& hit, const CandidateRecord& a, const CandidateRecord& b, PairEnds& next) const;
    void tell(CandidateHits& found, std::size_t before) const;
    FeatureBox box(const CandidateRecord& record, int lane) const;

    const CandidateKernels& kernels_;
    std::vector<std::unique_ptr<Worker>> worker_;
    std::array<std::vector<const Array<Pair>*>, candidate_kinds> found_;
    // Of the call:
    const Call* call_ = nullptr;
    const CandidateRequest* query_ = nullptr;
    CandidateShare share_;
    Normaliser normaliser_;
    Rounds rounds_;
};

}  // namespace crumple::cpu
