#pragma once

// One pass over the stages up to `sweep`, [MZ] Algorithm 1, on arrays that are cut from blocks of device memory. Each
// kind of query derives a pass, which adds its records, its filter and the later stages.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/stages/bounds.h"
#include "backends/cuda/stages/plan.h"
#include "backends/cuda/stages/sort.h"
#include "backends/cuda/stages/subdivide.h"
#include "backends/cuda/stages/sweep.h"
#include "crumple/options.h"

namespace crumple::cuda {

/// Data by which a pass warm-starts the next one. A warm-started pass (Plan::warm_started) begins with a copy of `next`
/// to `now`, and then computes the following `next`, in parallel to the stages:
///
///     clear, now = next -- bounds -- members ---- sort -- sweep -- narrow -- output
///                                          \                                  /
///                                           fuzzy C-means, places, frames: next
///
/// Any other pass computes each part of `now` right before it is used.
struct WarmStarts {
    WarmStart now, next;
    float* moved[2];  ///< Level::moved of each level

    void cut(ArenaLayout& cutter, const Plan& plan);
};

class Pass {
   public:
    Pass(const Geometry& geometry, cudaStream_t stream, const Options& options)
        : geometry_(geometry), stream_(stream), options_(options) {}
    virtual ~Pass() = default;

    /// Input of the pass. Pointers refer to device memory.
    PreparedScene scene;
    const SceneBox* box = nullptr;
    Primitives primitives;
    Segments worlds{};  ///< triangles of each world; null: a single world
    PairSelection wanted;
    Plan plan;
    WarmStarts warm_starts{};
    const Branch* beside = nullptr;  ///< side branch that computes the next warm start; the caller joins it

    /// Takes the arrays of the stages up to `sort`, and the list that `sweep` fills, from the cutter; their contents
    /// are lost. Overriders add their records and the lists of `narrow`.
    virtual void cut(ArenaLayout& cutter);

    void bounds();
    void subdivide_scene();
    /// Lists the members of those clusters of the first level that have a bit in `listed`, and of the leaves in these.
    void subdivide_clusters(std::uint64_t listed);
    void align();
    virtual void sort() = 0;
    virtual void sweep(const Slice& slice) = 0;

    /// Adds to `batch` all that has to be cleared before a pass, or before another call of subdivide_clusters().
    void clear(BatchedClear& batch) const;
    /// Clears the counters from Counters::members on, before another slice of a sweep. Those of bad or changed
    /// elements, of places and of units stay.
    void clear_counters();

    Counters* counters = nullptr;

   private:
    void list_members(int i, std::uint64_t listed);
    void move_centres(int i);
    void prepare_next(int i, cudaStream_t stream);

   protected:  // tests of the stages read the arrays, and use other records and filters
    template <class Primitive, class Records>
    void sort_by(const Primitive& primitive, const Records& records) {
        sort_members(geometry_, stream_, scene, points_, plan.leaves(), members_of(last_level()),
                     members_[last_level()], frames(), ownership(), sorted_, primitive, records, units(), counters);
    }

    template <class Filter>
    void sweep_by(const Slice& slice, const Filter& filter) {
        cuda::sweep(geometry_, stream_, scene, sorted_, units(), ownership(), wanted, filter, survivors(), slice,
                    counters);
    }

    Level level(int i) const;
    Members members(int i) const;
    Fuzziness fuzziness(int i) const;
    Ownership ownership() const;
    int last_level() const { return plan.levels() - 1; }
    Segments members_of(int i) const { return {warm_starts.now.first[i], count_[i]}; }
    Frames frames() const { return {warm_starts.now.frame, reach_}; }
    List<SweepUnit> units() const { return {units_, &counters->units, plan.units}; }
    List<Candidate> survivors() const { return {survivors_, &counters->survivors, plan.survivors}; }

    Geometry geometry_;
    cudaStream_t stream_;
    const Options& options_;

    Points points_;
    Ball* balls_ = nullptr;
    Row<float>* partial_ = nullptr;
    std::uint64_t* mask_[2] = {};
    unsigned long long* count_[2] = {};
    Members members_[2] = {};
    unsigned* reach_ = nullptr;
    Sorted sorted_{};
    SweepUnit* units_ = nullptr;
    Candidate* survivors_ = nullptr;
};

}  // namespace crumple::cuda
