#pragma once

// Intersection query as a LeafQuery: records from `align` to `narrow`, and the pairs found.

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "backends/cpu/intersections/intersection_narrow.h"
#include "backends/cpu/leaf_query.h"
#include "backends/cpu/stages/copies.h"
#include "queries/row_stream.h"

namespace crumple::cpu {

class IntersectLeaves final : public LeafQuery {
   public:
    IntersectLeaves(MemoryMeter* meter, int workers, const IntersectKernels& kernels);

    /// Query of the next search, and destination of its pairs. The pointers must stay valid during the search.
    struct Asked {
        const IntersectionQuery* query = nullptr;
        bool decides = true;                  ///< see NarrowContext
        const PairSink* sink = nullptr;       ///< see NarrowContext
        std::atomic<bool>* enough = nullptr;  ///< see NarrowContext
        PairStream* stream = nullptr;  ///< receives the pairs of each unit (queries/row_stream.h); null: no stream
    };
    void ask(const Asked& asked) { asked_ = asked; }

    void begin(const Call& call) override;
    void leave_out(const Call& call, Levels& levels) override;
    void reserve(const Call& call, std::int64_t members, std::int64_t rows, std::size_t worker) override;
    bool stop() const override { return context_->stop(); }
    void build(const BuildInput& input, LeafMembers& members, std::size_t worker) override;
    void place(const SortedLeaf& leaf, std::size_t worker) override;
    void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
               std::size_t builder, std::size_t worker) override;
    void begin_unit(std::int64_t unit, std::size_t worker) override { worker_[worker]->narrow.unit = unit; }
    void end_unit(std::size_t worker) override;
    void fail() override { asked_.stream->fail(); }
    void finish(Statistics& statistics) override;

    /// Delivers the pairs of a worker to the stream, after adding the pairs of duplicate triangles (copies.h).
    void deliver(NarrowScratch& scratch);

    /// Returns the pairs of each worker that no sink has removed. Of duplicate triangles, only the first occurs in
    /// them.
    std::span<const Array<Pair>* const> found() const { return found_; }
    Array<Pair>& found(std::size_t worker) { return worker_[worker]->narrow.pairs; }
    const Copies& copies() const { return copies_; }

    std::size_t pairs_before = 0;  ///< number of pairs in the last result of write_result(); reserve() expects as many

   private:
    struct Worker {
        explicit Worker(MemoryMeter* m) : records(m), narrow(m) {}
        LeafRecords records;
        NarrowScratch narrow;
    };

    const IntersectKernels& kernels_;
    Asked asked_;
    std::optional<NarrowContext> context_;
    Copies copies_;
    std::vector<std::unique_ptr<Worker>> worker_;
    std::vector<const Array<Pair>*> found_;
};

}  // namespace crumple::cpu
