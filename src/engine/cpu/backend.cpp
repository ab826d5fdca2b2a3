// The cpu backend: [MZ] Algorithm 1, one line a stage. Owns all buffers; the stages own none.

#include "engine/backend.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "base/float_environment.h"
#include "engine/cpu/align.h"
#include "engine/cpu/bounds.h"
#include "engine/cpu/copies.h"
#include "engine/cpu/kernels.h"
#include "engine/cpu/output.h"
#include "engine/cpu/ownership.h"
#include "engine/cpu/parallel.h"
#include "engine/cpu/sort.h"
#include "engine/cpu/stopwatch.h"
#include "engine/cpu/subdivide.h"
#include "engine/output.h"
#include "model/part.h"
#include "model/rules.h"
#include "questions/intersect/cpu/narrow.h"

namespace crumple {
namespace cpu {
namespace {

// Leaves with more interval tests than this are cut into tiles of about a quarter of it, for several workers.
constexpr std::int64_t tile_work = std::int64_t{1} << 22;

// Under a memory limit duplicated faces are counted when so many pairs a triangle were found: meshes have fewer.
constexpr std::int64_t many_pairs = 8;

/// Memory of one worker.
struct Scratch {
    explicit Scratch(MemoryMeter* m) : members(m), sort(m), leaf(m), records(m), tile_begin(m), narrow(m) {}
    LeafMembers members;
    SortScratch sort;
    SortedLeaf leaf;
    LeafRecords records;
    Array<std::int64_t> tile_begin;  ///< rows at which a large leaf is cut
    NarrowScratch narrow;
};

class CpuBackend final : public BackendBase {
   public:
    CpuBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          kernels_(stage_kernels(options.simd)),
          intersect_(intersect_kernels(options.simd)),
          cancellation_(cancellation),
          workers_(options.threads, cancellation),
          meter_(meter) {
        release();
    }

    void find(const Scene& scene, const Query& query, const Part* part, Collisions& result) override {
        workers_.run([&] {
            if (scene.triangle_count() >= too_many_) {
                find_in_chunks(scene, query, part, result);
            } else {
                try {
                    find_at_once(scene, query, part, result);
                } catch (const ResultExceeds&) {
                    throw;
                } catch (const MemoryMeter::Exceeded&) {
                    too_many_ = scene.triangle_count();
                    find_in_chunks(scene, query, part, result);
                }
            }
        });
        result.statistics = statistics_;
    }

    std::int64_t bytes_needed(const Scene& scene, const Query& query, const Part* part) override {
        std::int64_t pairs = 0;
        workers_.run([&] {
            prepare_chunks(scene, query, part);
            pass_over_chunks(scene, query, [&](const Array<Pair>& found) {
                for (const Pair& pair : found) pairs += copies_.count(pair);
            });
        });
        return meter_.peak + result_bytes(scene, query, pairs);
    }

    bool any(const Scene& scene, const Query& query) override {
        std::atomic<bool> found{false};
        workers_.run([&] {
            try {
                start(scene, query, nullptr);
                gather_leaves(balls_, scene.triangle_count(), 0, subdivision_->clusters, options_, kernels_, workers_,
                              warm_, *subdivision_);
                NarrowContext context = narrow_context(scene, query);
                context.found = &found;
                sweep_leaves(context);
            } catch (const MemoryMeter::Exceeded&) {
                prepare_chunks(scene, query, nullptr);
                pass_over_chunks(
                    scene, query, [](const Array<Pair>&) {}, &found);
            }
        });
        return found;
    }

    bool heeds_bodies() const override { return true; }

    void parallel_for(std::size_t n, Task task) override {
        workers_.run([&] { workers_.parallel_for(n, [&](std::size_t i, std::size_t) { task(i); }); });
    }

    void release() override {
        rule_ = GroupRule(&meter_);
        points_ = std::make_unique<Points>(&meter_);
        balls_ = Array<Ball>(&meter_);
        subdivision_ = std::make_unique<Subdivision>(&meter_);
        part_masks_ = Array<std::uint64_t>(&meter_);
        copies_ = Copies(&meter_);
        output_ = OutputScratch(&meter_);
        warm_ = {};
        pairs_before_ = 0;
        scratch_.clear();
        found_.clear();
        for (int w = 0; w < workers_.workers(); ++w) {
            scratch_.push_back(std::make_unique<Scratch>(&meter_));
            found_.push_back(&scratch_.back()->narrow.pairs);
        }
    }

   private:
    void find_at_once(const Scene& scene, const Query& query, const Part* part, Collisions& result) {
        start(scene, query, part);
        Stopwatch watch;
        gather_leaves(balls_, scene.triangle_count(), 0, subdivision_->clusters, options_, kernels_, workers_, warm_,
                      *subdivision_);
        statistics_[Stage::subdivide] += watch.lap();
        NarrowContext context = narrow_context(scene, query);
        PairBudget budget(asked(scene, query), meter_, many_pairs);
        if (meter_.limit > 0) context.budget = &budget;
        sweep_leaves(context);
        watch.lap();
        if (!copies_.empty())
            workers_.parallel_for(scratch_.size(), [&](std::size_t w, std::size_t) {
                copies_.expand(scratch_[w]->narrow.pairs, cancellation_);
            });
        write_output(scene, workers_, found_, output_, result);
        pairs_before_ = result.pairs.size();
        write_contacts(scene, query, result);
        statistics_[Stage::output] += watch.lap();
    }

    // Under a memory limit: first-level clusters one after another, on one thread, and twice: pairs are counted, then
    // written to their places ([MZ] sec. 3.1's use of prefix sums). Nothing is stored but records and the result.
    void find_in_chunks(const Scene& scene, const Query& query, const Part* part, Collisions& result) {
        crumple::release(result);
        prepare_chunks(scene, query, part);
        PairBudget budget(asked(scene, query), meter_, many_pairs);
        const auto n = static_cast<std::size_t>(scene.triangles[0]);
        result.offsets.assign(n + 1, 0);
        std::int64_t* offsets = result.offsets.data();
        pass_over_chunks(scene, query, [&](const Array<Pair>& found) {
            for (const Pair& first : found) {
                budget.add(copies_.count(first));
                copies_.for_each(first, cancellation_, [&](Pair pair) { ++offsets[pair.a + 1]; });
            }
        });
        for (std::size_t i = 0; i < n; ++i) offsets[i + 1] += offsets[i];
        result.pairs.resize_discard(static_cast<std::size_t>(offsets[n]));
        const auto second = static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
        pass_over_chunks(scene, query, [&](const Array<Pair>& found) {
            for (const Pair& first : found)
                copies_.for_each(first, cancellation_, [&](Pair pair) {
                    result.pairs[offsets[pair.a]++] = {pair.a, pair.b - second};
                });
        });
        Stopwatch watch;
        for (std::size_t i = n; i > 0; --i) offsets[i] = offsets[i - 1];
        offsets[0] = 0;
        for (std::size_t i = 0; i < n; ++i)
            std::sort(result.pairs.begin() + offsets[i], result.pairs.begin() + offsets[i + 1]);
        index_pairs(scene, result);
        write_contacts(scene, query, result);
        statistics_[Stage::output] += watch.lap();
    }

    void prepare_chunks(const Scene& scene, const Query& query, const Part* part) {
        release();
        meter_.peak = meter_.used.load();
        start(scene, query, part);
    }

    void pass_over_chunks(const Scene& scene, const Query& query, const std::function<void(const Array<Pair>&)>& sink,
                          std::atomic<bool>* found = nullptr) {
        NarrowContext context = narrow_context(scene, query);
        context.sink = &sink;
        context.found = found;
        Scratch& scratch = *scratch_[0];
        scratch.narrow.statistics = {};
        statistics_.leaves = statistics_.members = 0;
        warm_.level2 = {};  // each pass makes the same leaves
        for (int k = 0; k < subdivision_->clusters && !context.stop(); ++k) {
            gather_leaves(balls_, scene.triangle_count(), k, k + 1, options_, kernels_, workers_, warm_, *subdivision_);
            for (const Leaf& leaf : subdivision_->leaves) {
                count_leaf(leaf);
                if (leaf.size < 2) continue;
                Ownership ownership(scene, *subdivision_, part_masks(), part_index_, leaf);
                if (!prepare_leaf(scene, leaf, ownership, scratch)) continue;
                sweep_and_narrow(context, scratch.leaf, scratch.records, ownership, 0, scratch.leaf.rows,
                                 scratch.narrow);
            }
        }
        add_counts(scratch.narrow.statistics);
    }

    // Everything up to the first level of subdivision.
    void start(const Scene& scene, const Query& query, const Part* part) {
        statistics_ = {};
        statistics_.backend = "cpu";
        statistics_.simd = kernels_.name;
        statistics_.threads = workers_.workers();
        for (auto& scratch : scratch_) {
            scratch->narrow.pairs.clear();
            scratch->narrow.statistics = {};
        }
        Stopwatch watch;
        rule_.prepare(query, scene.bodies);
        const bool repeats_corner = compute_bounds(scene, kernels_, workers_, *points_, balls_);
        if (part)
            crumple::part_masks(scene, *part, *this, part_masks_);
        else if (scene.between)
            part_masks_.assign(static_cast<std::size_t>(scene.triangle_count()), 1);
        else
            part_masks_.clear();
        if (scene.between) exclude_far(scene, workers_, balls_, part_masks_);
        part_index_ = part ? part->index : 0;
        copies_.clear();
        if (repeats_corner) {
            copies_.find(scene, rule_, part_masks(), part_index_);
            copies_.leave_out(part_masks_);
        }
        statistics_[Stage::bounds] = watch.lap();
        place_clusters(balls_, scene.triangle_count(), part_masks(), part_index_, options_, kernels_, workers_, warm_,
                       *subdivision_);
        statistics_[Stage::subdivide] = watch.lap();
        statistics_.clusters = subdivision_->clusters;
    }

    // Leaves the pairs in scratch_[...]->narrow.pairs.
    void sweep_leaves(const NarrowContext& context) {
        make_room_for_workers(context.scene.between);
        workers_.parallel_for(subdivision_->leaves.size(), [&](std::size_t l, std::size_t worker) {
            const Leaf& leaf = subdivision_->leaves[l];
            if (leaf.size < 2 || context.stop()) return;
            Ownership ownership(context.scene, *subdivision_, part_masks(), part_index_, leaf);
            if (prepare_leaf(context.scene, leaf, ownership, *scratch_[worker]))
                sweep_leaf(context, ownership, *scratch_[worker]);
        });
        for (const auto& scratch : scratch_) add_counts(scratch->narrow.statistics);
        for (const Leaf& leaf : subdivision_->leaves) count_leaf(leaf);
    }

    // Whoever gets the largest leaf, and more than their share of the pairs, finds room for them, so that warm calls
    // allocate nothing. Leaves far larger than others are usual are left to those who get them.
    void make_room_for_workers(bool between) {
        if (meter_.limit > 0 || workers_.workers() == 1) return;
        std::int64_t largest = 0, most = 0;
        for (const Leaf& leaf : subdivision_->leaves) largest = std::max(largest, leaf.size);
        for (const auto& scratch : scratch_) most = std::max(most, scratch->narrow.most_candidates);
        largest = std::min<std::int64_t>(largest, 4 * options_.leaf_size);
        const std::size_t share = 2 * pairs_before_ / static_cast<std::size_t>(workers_.workers());
        for (const auto& scratch : scratch_) {
            scratch->members.make_room(static_cast<std::size_t>(largest));
            make_room(largest, between, scratch->sort, scratch->leaf);
            scratch->records.make_room(largest, scratch->leaf.rows);
            make_room(scratch->leaf.rows, scratch->narrow.candidates);
            if (most > 0) scratch->narrow.verdicts.make_room(most);
            scratch->narrow.pairs.reserve(share);
        }
    }

    PairBudget::Call asked(const Scene& scene, const Query& query) const {
        return {scene, query, rule_, part_masks_, part_index_};
    }

    NarrowContext narrow_context(const Scene& scene, const Query& query) const {
        // The SIMD filters form 4 vertex in 32 bits.
        const bool huge = scene.vertex_count() >= std::int64_t{1} << 29;
        return {scene, query, rule_, kernels_, huge ? scalar_intersect : intersect_, point_rows(scene), cancellation_};
    }

    const std::uint64_t* part_masks() const { return part_masks_.empty() ? nullptr : part_masks_.data(); }

    void count_leaf(const Leaf& leaf) {
        ++statistics_.leaves;
        statistics_.members += leaf.size;
    }

    void write_contacts(const Scene& scene, const Query& query, Collisions& result) {
        result.contacts.kinds.clear();
        result.contacts.offsets.clear();
        result.contacts.points.clear();
        if (!query.contacts) return;
        constexpr std::size_t batch = 256;
        statistics_.rational_contacts = contacts_of_pairs(scene, result, [&](std::size_t n, auto task) {
            workers_.parallel_for((n + batch - 1) / batch, [&](std::size_t b, std::size_t) {
                for (std::size_t i = b * batch; i < std::min(n, (b + 1) * batch); ++i) task(i);
            });
        });
    }

    // False if the leaf holds no pair.
    bool prepare_leaf(const Scene& scene, const Leaf& leaf, Ownership& ownership, Scratch& scratch) {
        Statistics& statistics = scratch.narrow.statistics;
        Stopwatch watch;
        LeafMembers& members = scratch.members;
        members.gather(scene, *subdivision_, leaf);
        if (members.size() < 2) return false;
        ownership.bits(members.triangle.data(), members.member.data(), members.size(), rule_.groups_apart(),
                       members.lower.data());
        members.keep_members = !ownership.complete();
        const BuildInput input{point_rows(scene),      scene.corners,
                               scene.triangle_count(), members.triangle.data(),
                               members.size(),         leaf_frame(balls_, point_rows(scene), scene.corners, members)};
        const FlushToZero mode;
        scratch.records.build(intersect_, input, members);
        statistics[Stage::align] += watch.lap();
        sort_leaf(members, kernels_, scratch.sort, scratch.leaf);
        scratch.records.sort(intersect_, scratch.leaf);
        statistics.interval_tests += scratch.leaf.work;
        statistics[Stage::sort] += watch.lap();
        return true;
    }

    PointRows point_rows(const Scene& scene) const {
        return scene.float32 ? PointRows{points_->f.data(), nullptr} : PointRows{nullptr, points_->d.data()};
    }

    void sweep_leaf(const NarrowContext& context, const Ownership& ownership, Scratch& scratch) {
        const SortedLeaf& leaf = scratch.leaf;
        if (workers_.workers() == 1 || leaf.work <= tile_work) {
            sweep_and_narrow(context, leaf, scratch.records, ownership, 0, leaf.rows, scratch.narrow);
            return;
        }
        // Tiles of rows with about the same number of interval tests: their prefix sum tells where to cut.
        const std::int64_t share = leaf.work / (4 * leaf.work / tile_work + 1) + 1;
        scratch.tile_begin.clear();
        std::int64_t work = 0;
        for (std::int64_t row = 0; row < leaf.rows; ++row) {
            if (work >= share * static_cast<std::int64_t>(scratch.tile_begin.size())) scratch.tile_begin.push_back(row);
            work += std::max<std::int64_t>(0, leaf.link[row].end - leaf.begin_of(row));
        }
        const std::size_t tiles = scratch.tile_begin.size();
        scratch.tile_begin.push_back(leaf.rows);
        workers_.parallel_for(tiles, [&](std::size_t tile, std::size_t worker) {
            sweep_and_narrow(context, leaf, scratch.records, ownership, scratch.tile_begin[tile],
                             scratch.tile_begin[tile + 1], scratch_[worker]->narrow);
        });
    }

    void add_counts(const Statistics& other) {
        for (std::size_t s = 0; s < stage_count; ++s) statistics_.stage_milliseconds[s] += other.stage_milliseconds[s];
        statistics_.interval_tests += other.interval_tests;
        statistics_.box_overlaps += other.box_overlaps;
        statistics_.edge_tests += other.edge_tests;
        statistics_.double_tests += other.double_tests;
        statistics_.exact_tests += other.exact_tests;
        statistics_.rational_tests += other.rational_tests;
    }

    Options options_;
    const StageKernels& kernels_;
    const IntersectKernels& intersect_;
    Cancellation& cancellation_;
    Workers workers_;
    MemoryMeter& meter_;
    GroupRule rule_;
    std::unique_ptr<Points> points_;
    Array<Ball> balls_;
    std::unique_ptr<Subdivision> subdivision_;
    Array<std::uint64_t> part_masks_;  ///< by triangle; empty: all belong to the one part that is answered
    int part_index_ = 0;
    Copies copies_{nullptr};
    OutputScratch output_{nullptr};
    WarmCentres warm_;
    std::size_t pairs_before_ = 0;                   ///< pairs of the call before
    std::vector<std::unique_ptr<Scratch>> scratch_;  ///< one a worker
    std::vector<const Array<Pair>*> found_;          ///< the pairs of each
    Statistics statistics_;
    std::int64_t too_many_ =
        std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit the limit at once
};

}  // namespace
}  // namespace cpu

std::unique_ptr<BackendBase> make_cpu_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation) {
    return std::make_unique<cpu::CpuBackend>(options, meter, cancellation);
}

}  // namespace crumple
