#pragma once

// Queries about features (vertices, edges, faces) as a LeafQuery. A leaf is a small set of triangles that one sweep
// searches; its candidates are pairs of them whose inflated boxes overlap. A pair that no direction separates stands
// for tests: pairs of a feature that one triangle owns and one that the other owns. Filters drop most tests, and the
// remaining ones are decided exactly.

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "backends/cpu/features/feature_kernels.h"
#include "backends/cpu/leaf_query.h"
#include "backends/cpu/stages/sweep.h"
#include "backends/decide_features.h"
#include "queries/feature_request.h"

namespace crumple::cpu {

/// Query about features. The template argument is the number of time samples: 1 if static, 2 for motion.
template <int moments>
class FeatureLeaves final : public LeafQuery {
   public:
    FeatureLeaves(MemoryMeter* meter, int workers, const FeatureTables& kernels);

    /// Sets the request of the next search, which begin() starts. `distance`: the requested distance in normalised
    /// coordinates, rounded up; `radius`: FeatureRequest::radii likewise, 1 per vertex, or null. `query` and `radius`
    /// must stay valid until the search ends.
    void ask(const FeatureRequest& query, float distance, const float* radius);
    /// Delivers all hits to a stream, unit by unit (RowStream: queries/row_stream.h), until the next request is set.
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
    /// Returns the hits of each worker.
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
        Array<Record> sorted;  ///< by physical row (stages/layout.h)
        float reach = 0;  ///< extent for NeededGap: the leaf's largest |coordinate|, doubled if BuildInput::until < 1
        float farthest = 0;  ///< largest distance requested for a pair of the leaf, apart from a share of the pair's
                             ///< distance at the start
        CandidateChunk candidates;
        Array<std::uint32_t> left;                   ///< candidates that no direction separates, packed as in PairsLeft
        Array<float> distance;                       ///< requested distance of each test, if vertices have radii
        std::array<Array<std::uint32_t>, 2> listed;  ///< for TestList::test: of vertex_face and of edge_edge
        std::array<Array<FeatureTest>, feature_kinds> tests;
        RowLists hits;
        std::int64_t unit = 0;  ///< unit of a stream that the hits belong to
        Statistics statistics;
    };

    void narrow(const SortedLeaf& leaf, const Ownership& ownership, const Worker& builder, Worker& worker);
    void narrow(std::size_t pairs, const Worker& builder, Worker& worker);
    std::size_t separate(const Worker& builder, Worker& worker) const;
    std::size_t own_pairs(const SortedLeaf& leaf, const Ownership& ownership, std::size_t left, Worker& worker) const;
    void find_tests(const PairsLeft<moments>& pairs, Worker& worker) const;
    template <FeatureKind kind>
    void filter_list(const PairsLeft<moments>& pairs, TestList& listed, Worker& worker) const;
    void list_codimensional_tests(const PairsLeft<moments>& pairs, Worker& worker) const;
    void filter_tests(FeatureKind kind, Worker& worker) const;
    void drop_adjacent(FeatureKind kind, Array<FeatureTest>& tests) const;
    float first_time() const;
    bool is_later(FeatureKind kind, const FeatureTest& test) const;
    void decide_tests(FeatureKind kind, Worker& worker);
    void measure_tests(FeatureKind kind, Worker& worker);

    std::int64_t ends() const;

    const FeatureTables& tables_;
    const FeatureKernels<moments>& kernels_;
    std::vector<std::unique_ptr<Worker>> worker_;
    std::array<std::vector<const FeatureRows*>, feature_kinds> found_;
    // Current call:
    const Call* call_ = nullptr;
    const FeatureRequest* query_ = nullptr;
    FeatureStream* stream_ = nullptr;  ///< receives the hits; null: each worker keeps its own (found())
    float distance_ = 0, share_ = 0;
    const float* radius_ = nullptr;
    std::atomic<bool> any_{false};
    static constexpr std::uint64_t no_place = UINT64_MAX;  ///< rank of no pair: above all others
    /// Rank (place_of()) of the first pair found that touches at time 0, if only the first impact is requested: no
    /// impact is earlier, so pairs of higher rank need not be decided. Faces that slide within a plane touch all over
    /// at time 0, and are slow to decide.
    std::atomic<std::uint64_t> first_at_start_{no_place};
    std::atomic<std::uint64_t> first_time_{0};  ///< bits of the earliest toi found so far as a float64 number, or of 1
};

extern template class FeatureLeaves<1>;
extern template class FeatureLeaves<2>;

}  // namespace crumple::cpu
