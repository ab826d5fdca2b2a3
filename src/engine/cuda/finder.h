#pragma once

// What searches of one scene have in common whose answers go to the host: planned, passed over, and passed over again
// where a list was too short, as search.h has it for triangles. Where that does not fit the memory limit or the device,
// clusters are done one after another, in slices, and what each finds is brought to the host.

#include <algorithm>
#include <cstdint>
#include <limits>

#include "base/cancellation.h"
#include "crumple/options.h"
#include "engine/cuda/device.h"
#include "engine/cuda/input.h"
#include "engine/cuda/memory.h"
#include "engine/cuda/pass.h"

namespace crumple::cuda {

/// `QuestionPass`: a Pass with cut(), sort() and sweep(slice).
template <class QuestionPass>
class Finder {
   public:
    Finder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
           MemoryMeter& meter, Cancellation& cancellation, Input& input)
        : options_(options),
          meter_(meter),
          cancellation_(cancellation),
          geometry_(geometry),
          stream_(stream),
          input_(input),
          watch_(device),
          beside_(device),
          counters_(device),
          guides_(meter),
          work_(meter),
          answer_(meter),
          pass_(geometry, stream, options) {
        pass_.beside = &beside_;
    }

   protected:
    enum class Lists : std::uint8_t { shortest, roomy };  ///< of chunks

    void drop_lists() {
        work_.release();
        answer_.release();
    }
    void release() {
        drop_lists();
        guides_.release();
        too_many_ = std::numeric_limits<std::int64_t>::max();
    }

    /// Brings a scene of the host and the rule about its pairs.
    void bring(const Scene& scene, const GroupRule& rule) {
        input_.bring(scene);
        input_.want(rule);
        pass_.scene = input_.scene();
        pass_.box = input_.box();
        pass_.wanted = input_.wanted();
        statistics_ = {};
    }
    static Primitives primitives(const Scene& scene, const Inflation* inflation, bool along_axes) {
        return {true, scene.moving, scene.moving ? static_cast<std::int32_t>(scene.vertex_count()) : 0, inflation,
                along_axes};
    }

    /// Calls at_once(), or in_chunks(lists) with as long lists as memory seems to allow, or with the shortest.
    /// `frugal`: with these from the beginning.
    template <class AtOnce, class InChunks>
    void find(bool frugal, AtOnce at_once, InChunks in_chunks) {
        const std::int64_t n = pass_.scene.triangle_count();
        if (!frugal && n < too_many_ && fits(at_once)) return;
        if (!frugal) too_many_ = std::min(too_many_, n);
        if (frugal || !fits([&] { in_chunks(Lists::roomy); })) in_chunks(Lists::shortest);
    }

    /// `make_ready`: work between that of the input and `bounds`.
    template <class MakeReady>
    void enqueue_until_sorted(Clearing& clearing, MakeReady make_ready) {
        pass_.clear(clearing);
        input_.clear(clearing);
        clearing.launch(geometry_, stream_);
        watch_.begin(Stage::bounds, stream_);
        input_.enqueue(geometry_, stream_, pass_.counters);
        make_ready();
        pass_.bounds();
        watch_.begin(Stage::subdivide, stream_);
        pass_.subdivide_scene();
        pass_.subdivide_clusters(~std::uint64_t{0});
        watch_.begin(Stage::align, stream_);
        pass_.align();
        watch_.begin(Stage::sort, stream_);
        pass_.sort();
    }
    /// Ends a pass: what was done beside is joined, and the host is told the counters.
    void enqueue_end() {
        if (pass_.plan.guided) beside_.join(stream_);
        watch_.end(stream_);
        CRUMPLE_CUDA(
            cudaMemcpyAsync(counters_.get(), pass_.counters, sizeof(Counters), cudaMemcpyDeviceToHost, stream_));
    }
    void accepted() {
        pass_.plan.cold = false;
        pass_.plan.guided = true;
    }

    /// Cluster by cluster: calls slice(counters) for each slice whose pairs of triangles fit their list, which ends the
    /// search by returning false. `cut_answer`: what of the answer lies on the device.
    template <class CutAnswer, class MakeReady, class NarrowSlice>
    void over_chunks(CutAnswer cut_answer, MakeReady make_ready, NarrowSlice slice) {
        bool laid_out = false;
        for (int k = 0; k < pass_.plan.fan_out[0];) {
            if (!laid_out) lay_out_chunks(cut_answer, make_ready);
            Clearing clearing;
            pass_.clear(clearing);
            clearing.launch(geometry_, stream_);
            pass_.subdivide_clusters(std::uint64_t{1} << k);
            laid_out = pass_.plan.accepts_chunk(read_counters());
            if (!laid_out) continue;
            pass_.align();
            pass_.sort();
            const Counters sorted = read_counters();
            laid_out = pass_.plan.accepts_units(sorted);
            if (!laid_out) continue;
            count(sorted);
            if (!over_slices(slice)) return;
            ++k;
        }
    }

    Counters read_counters() {
        copy_now(stream_, counters_.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
        return *counters_;
    }
    void count(const Counters& c) {
        Statistics& s = statistics_;
        s.backend = "cuda";
        s.clusters = pass_.plan.fan_out[0];
        s.leaves = pass_.plan.leaves();
        s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
        s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
        s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
        s.edge_tests += static_cast<std::int64_t>(c.listed);
        for (const unsigned long long tests : c.tests) {
            s.double_tests += static_cast<std::int64_t>(tests);
            s.exact_tests += static_cast<std::int64_t>(tests);
        }
        s.rational_tests += static_cast<std::int64_t>(c.beyond);
    }

   private:
    template <class CutAnswer, class MakeReady>
    void lay_out_chunks(CutAnswer cut_answer, MakeReady make_ready) {
        lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
        lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
        lay_out(answer_, cut_answer);
        Clearing clearing;
        pass_.clear(clearing);
        input_.clear(clearing);
        clearing.launch(geometry_, stream_);
        input_.enqueue(geometry_, stream_, pass_.counters);
        make_ready();
        pass_.bounds();
        input_.throw_error(read_counters());
        pass_.subdivide_scene();
    }

    // A slice is halved until its pairs of triangles fit their list; then all lists do.
    template <class NarrowSlice>
    bool over_slices(NarrowSlice narrow) {
        for (Slice slice{}; slice.turn < slice.turns;) {
            cancellation_.check();
            pass_.clear_counters();
            pass_.sweep(slice);
            if (read_counters().survivors > pass_.plan.survivors) {
                slice = {2 * slice.turn, 2 * slice.turns};
                continue;
            }
            if (!narrow()) return false;
            ++slice.turn;
        }
        return true;
    }

   protected:
    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;
    Input& input_;
    StageEvents watch_;
    Branch beside_;
    Pinned<Counters> counters_;
    Block guides_, work_, answer_;
    QuestionPass pass_;
    Statistics statistics_;
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace crumple::cuda
