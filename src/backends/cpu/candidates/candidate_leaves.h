#pragma once

// Candidate query, for pairs of features whose inflated boxes overlap, as a LeafQuery. Triangles are swept as boxes
// along a coordinate axis. For each pair of triangles whose boxes overlap, the features that one owns are tested
// against those that the other owns.

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "backends/cpu/candidates/candidate_kernels.h"
#include "backends/cpu/leaf_query.h"
#include "filters/candidates/box_test.h"
#include "geometry/normaliser.h"
#include "queries/feature_request.h"

namespace crumple::cpu {

class CandidateLeaves final : public LeafQuery {
   public:
    CandidateLeaves(MemoryMeter* meter, int workers, const CandidateKernels& kernels);

    /// Sets the request of the next search, which begin() starts. `query` must stay valid until the search ends.
    void ask(const FeatureRequest& query);
    /// Delivers all candidates to a stream, unit by unit (RowStream: queries/row_stream.h), until the next request is
    /// set.
    void deliver_to(FeatureStream& stream) { stream_ = &stream; }

    void begin(const Call& call) override;
    bool stop() const override;
    void build(const BuildInput& input, LeafMembers& members, std::size_t worker) override;
    void place(const SortedLeaf& leaf, std::size_t worker) override;
    void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
               std::size_t builder, std::size_t worker) override;
    void begin_unit(std::int64_t unit, std::size_t worker) override { worker_[worker]->unit = unit; }
    void end_unit(std::size_t worker) override {
        stream_->add(worker_[worker]->unit, worker_[worker]->found);
        stream_->finish(worker_[worker]->unit);
    }
    void fail() override { stream_->fail(); }
    void finish(Statistics& statistics) override;

    /// Finds the candidates whose two features are owned by the same triangle, for triangles [begin, end). sweep() does
    /// not find these, because it tests pairs of different triangles.
    void search_within(std::int64_t begin, std::int64_t end, std::size_t worker);

    /// Returns the pairs that each worker has found.
    std::span<const Array<Pair>* const> found(CandidateKind kind) const {
        return found_[static_cast<std::size_t>(kind)];
    }

   private:
    struct Worker {
        explicit Worker(MemoryMeter* m);
        Array<CandidateRecord> built;   ///< in the order of LeafMembers
        Array<CandidateRecord> sorted;  ///< by physical row (stages/layout.h)
        CandidateChunk candidates;
        Array<UncertainTests> unsure;  ///< candidates of a batch with uncertain pairs
        RowLists found;
        std::int64_t unit = 0;  ///< unit of a stream that the pairs belong to
        Statistics statistics;
    };

    struct InflatedBox {
        Vec3f low, high;
    };
    /// Writes a triangle's record, and returns its inflated box.
    InflatedBox write_member(std::int32_t triangle, const CandidateKey& key, CandidateRecord& record) const;
    unsigned owned_lanes(std::int32_t triangle) const;
    void drop_foreign(const SortedLeaf& leaf, const Ownership& ownership, Worker& worker) const;
    void narrow(const Worker& builder, Worker& worker) const;
    void list(const UncertainTests& hit, const CandidateRecord& a, const CandidateRecord& b, PairEnds& next) const;
    void pass_on(Worker& worker) const;
    FeatureBox box(const CandidateRecord& record, int lane) const;

    const CandidateKernels& kernels_;
    std::vector<std::unique_ptr<Worker>> worker_;
    std::array<std::vector<const Array<Pair>*>, candidate_kinds> found_;
    // Current call:
    const Call* call_ = nullptr;
    const FeatureRequest* query_ = nullptr;
    FeatureStream* stream_ = nullptr;  ///< receives the candidates; null: each worker keeps its own (found())
    Normaliser normaliser_;
    LaneSteps rounds_;
};

}  // namespace crumple::cpu
