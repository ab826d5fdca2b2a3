#pragma once

// One pass over the stages, [MZ] Algorithm 1, on arrays that are cut from blocks of device memory.

#include "crumple/options.h"
#include "engine/cuda/bounds.h"
#include "engine/cuda/memory.h"
#include "engine/cuda/output.h"
#include "engine/cuda/plan.h"
#include "engine/cuda/sort.h"
#include "engine/cuda/subdivide.h"
#include "engine/cuda/sweep.h"
#include "questions/intersect/cuda/narrow.h"

namespace crumple::cuda {

/// Centres of both levels: what one frame leaves for the next.
struct Centres {
    Row<float>* centre[2];
    float* moved[2];

    void cut(Cutter& cutter);
};

class Pass {
   public:
    Pass(const Geometry& geometry, cudaStream_t stream, const Options& options)
        : geometry_(geometry), stream_(stream), options_(options) {}

    /// What is asked. Pointers are of the device.
    Scene scene;
    const SceneBox* box = nullptr;
    WantedGroups groups;
    NarrowPolicy policy;
    Plan plan;
    Centres centres{};

    /// Cuts the arrays of all stages but the last; their contents are lost.
    void cut(Cutter& cutter);

    void bounds();
    void subdivide_scene();
    /// Leaves of those clusters of the first level that have a bit in `listed`.
    void subdivide_clusters(std::uint64_t listed);
    void align();
    void sort();
    void sweep(const Slice& slice);
    void narrow(const Hits& hits);

    /// What the stages find cleared, from subdivide_scene() or subdivide_clusters() on.
    void clear(Clearing& clearing) const;
    /// Between slices of one sweep.
    void clear_counters();

    List<Hit> hits() const { return {hits_, &counters->hits, plan.hits}; }
    Pair* beyond() const { return beyond_; }
    Counters* counters = nullptr;

   protected:  // tests of the stages look at the arrays, and bring another question
    Level level(int i) const;
    Members members(int i) const;
    Fuzziness fuzziness(int i) const;
    Ownership ownership() const;
    /// Of the last level.
    const unsigned long long* leaf_first() const { return child_first_[plan.levels() - 1]; }

    Geometry geometry_;
    cudaStream_t stream_;
    const Options& options_;

    Points points_;
    Ball* balls_ = nullptr;
    Row<float>* partial_ = nullptr;
    std::uint64_t* mask_[2] = {};
    unsigned long long *count_[2] = {}, *cursor_ = nullptr, *child_first_[2] = {};
    Members members_[2] = {};
    Frame* frames_ = nullptr;
    Sorted sorted_{};
    RecordRows records_{};
    SortScratch scratch_{};
    Candidate *survivors_ = nullptr, *undecided_ = nullptr;
    Pair* beyond_ = nullptr;
    Hit* hits_ = nullptr;
};

}  // namespace crumple::cuda
