#pragma once

// Questions about features in the order of the stages. A leaf's candidates are pairs of triangles; those that no
// direction separates stand for tests of features, and each test is decided.

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/leaf_question.h"
#include "backends/cpu/stages/sweep.h"
#include "backends/decide_features.h"
#include "queries/feature_request.h"

namespace crumple::cpu {

/// `moments`: 1 at rest, 2 for a step.
template <int moments>
class FeatureLeaves final : public LeafQuestion {
   public:
    FeatureLeaves(MemoryMeter* meter, int workers, const FeatureTables& kernels);

    /// What is asked, from begin() on. `distance`: what is asked for in normalised coordinates, rounded up; `radius`:
    /// the same of FeatureRequest::radii, one a vertex, or null.
    void ask(const FeatureRequest& query, float distance, const float* radius);
    /// Gives all hits to a stream, unit by unit; until the next ask().
    void deliver_to(FeatureStream& stream) { stream_ = &stream; }

    void begin(const Call& call) override;
    bool stop() const override;
    void build(const BuildInput& input, LeafMembers& members, std::size_t worker) override;
    void place(const SortedLeaf& leaf, std::size_t worker) override;
    void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
               std::size_t builder, std::size_t worker) override;
    void begin_unit(std::int64_t unit, std::size_t worker) override { worker_[worker]->unit = unit; }
    void end_unit(std::size_t worker) override {
        stream_->add(worker_[worker]->unit, worker_[worker]->hits);
        stream_->finish(worker_[worker]->unit);
    }
    void fail() override { stream_->fail(); }
    void finish(Statistics& statistics) override;

    bool any() const { return any_; }
    /// Hits of each worker.
    std::span<const FeatureRows* const> found(FeatureKind kind) const { return found_[static_cast<std::size_t>(kind)]; }

   private:
    using Record = FeatureRecord<moments>;

    struct Worker {
        explicit Worker(MemoryMeter* m)
            : built(m),
              sorted(m),
              candidates(m),
              left(m),
              distance(m),
              listed{Array<std::uint32_t>(m), Array<std::uint32_t>(m)},
              tests{Array<FeatureTest>(m), Array<FeatureTest>(m), Array<FeatureTest>(m), Array<FeatureTest>(m)},
              hits(m) {}
        GuessBatch guesses;
        Array<Record> built;   ///< in the order of LeafMembers
        Array<Record> sorted;  ///< by physical row
        float reach = 0;       ///< the leaf's largest |coordinate|
        float farthest = 0;    ///< what is asked of any pair in the leaf
        CandidateChunk candidates;
        Array<std::uint32_t> left;                   ///< candidates that no direction separates, packed
        Array<float> distance;                       ///< of each test, where vertices have radii
        std::array<Array<std::uint32_t>, 2> listed;  ///< see ListedTests
        std::array<Array<FeatureTest>, feature_kinds> tests;
        RowLists hits;
        std::int64_t unit = 0;  ///< of a stream: what the hits belong to
        Statistics statistics;
    };

    void narrow(const SortedLeaf& leaf, const Ownership& ownership, const Worker& builder, Worker& worker);
    void narrow(std::size_t pairs, const Worker& builder, Worker& worker);
    std::size_t separate(const Worker& builder, Worker& worker) const;
    std::size_t own_pairs(const SortedLeaf& leaf, const Ownership& ownership, std::size_t left, Worker& worker) const;
    void find_tests(const PairsLeft<moments>& pairs, Worker& worker) const;
    template <FeatureKind kind>
    void filter_listed(const PairsLeft<moments>& pairs, ListedTests& listed, Worker& worker) const;
    void list_tests_of_listed(const PairsLeft<moments>& pairs, Worker& worker) const;
    void filter_tests(FeatureKind kind, Worker& worker) const;
    void drop_neighbours(FeatureKind kind, Array<FeatureTest>& tests) const;
    bool is_later(FeatureKind kind, const FeatureTest& test) const;
    void decide_tests(FeatureKind kind, Worker& worker);
    void measure_tests(FeatureKind kind, Worker& worker);

    std::int64_t ends() const;

    const FeatureTables& tables_;
    const FeatureKernels<moments>& kernels_;
    std::vector<std::unique_ptr<Worker>> worker_;
    std::array<std::vector<const FeatureRows*>, feature_kinds> found_;
    // Of the call:
    const Call* call_ = nullptr;
    const FeatureRequest* query_ = nullptr;
    FeatureStream* stream_ = nullptr;  ///< null: hits gather with the workers
    float distance_ = 0, share_ = 0;
    const float* radius_ = nullptr;
    std::atomic<bool> any_{false};
    /// Place of the first pair that touches at time 0, where only the first impact is asked for: none can be earlier,
    /// so that pairs behind it need not be decided. Slides within a plane touch there all over, and are slow to decide.
    static constexpr std::uint64_t no_place = UINT64_MAX;
    std::atomic<std::uint64_t> first_at_start_{no_place};
    std::atomic<std::uint64_t> first_time_{0};  ///< the earliest of the impacts that are known, by its bits, or 1
};

extern template class FeatureLeaves<1>;
extern template class FeatureLeaves<2>;

}  // namespace crumple::cpu
