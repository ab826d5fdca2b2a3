// Implementation of the backend interface on the cpu: caches data between calls, and chooses how a call is run, at once
// or, under a memory limit, in chunks. The order of the stages is in order.cpp.

#include "backends/backend.h"

#include <limits>
#include <memory>
#include <utility>

#include "backends/cpu/features/find_features.h"
#include "backends/cpu/intersections/find_intersections.h"
#include "backends/cpu/intersections/memory_limit.h"
#include "backends/cpu/overlaps/overlap_lanes.h"
#include "results/intersection_output.h"

namespace crumple {
namespace cpu {
namespace {

class CpuBackend final : public BackendBase {
   public:
    CpuBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          kernels_(stage_kernels(options.simd)),
          intersect_(intersect_kernels(options.simd)),
          features_(feature_kernels(options.simd)),
          candidates_(candidate_kernels(options.simd)),
          overlaps_(cpu::overlap_kernels(options.simd)),
          cancellation_(cancellation),
          workers_(options, cancellation),
          meter_(meter) {
        release();
    }

    void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
              Intersections& result) override {
        statistics_ = {};
        workers_.run([&] {
            if (scene.triangle_count() >= too_many_) return find_in_chunks(scene, query, part, result);
            try {
                IntersectCall call = make_call(scene, query, part);
                PairBudget budget(scene, query, meter_);
                const auto count_new_pairs = [&](const NarrowScratch& scratch, std::size_t before) {
                    budget.add(static_cast<std::int64_t>(scratch.pairs.size() - before));
                };
                const PairSink sink = count_new_pairs;
                if (meter_.limit > 0) call.sink = &sink;
                cpu::find(call, result);
            } catch (const ResultExceeds&) {
                throw;
            } catch (const MemoryMeter::Exceeded&) {
                too_many_ = scene.triangle_count();
                find_in_chunks(scene, query, part, result);
            }
        });
        result.statistics = statistics_;
    }

    void find_possible(const PreparedScene& scene, Intersections& result) override {
        const Restored possible(decides_);
        decides_ = false;
        find(scene, IntersectionQuery(), nullptr, result);
    }

    bool any(const PreparedScene& scene, const IntersectionQuery& query) override {
        bool found = false;
        workers_.run([&] {
            try {
                found = cpu::any(make_call(scene, query, nullptr));
            } catch (const MemoryMeter::Exceeded&) {
                found = cpu::any(call_in_chunks(scene, query, nullptr));
            }
        });
        return found;
    }

    void stream(const PreparedScene& scene, const IntersectionQuery& query, PairStream& to,
                Statistics& statistics) override {
        statistics_ = {};
        workers_.run([&] {
            cpu::stream(meter_.limit > 0 ? call_in_chunks(scene, query, nullptr) : make_call(scene, query, nullptr),
                        to);
        });
        statistics = statistics_;
    }

    void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) override {
        result.clear();
        statistics_ = {};
        workers_.run([&] { cpu::find(make_call(scene, request), request, cached_->features, result); });
        result.statistics = statistics_;
    }

    void stream(const PreparedScene& scene, const FeatureRequest& request, FeatureStream& to,
                Statistics& statistics) override {
        statistics_ = {};
        workers_.run([&] { cpu::stream(make_call(scene, request), request, cached_->features, to); });
        statistics = statistics_;
    }

    void parallel_for(std::size_t n, Task task) override {
        workers_.run([&] { workers_.parallel_for(n, [&](std::size_t i, std::size_t) { task(i); }); });
    }

    const OverlapKernels* overlap_kernels() const override { return overlaps_; }

    Clustering cluster(const PreparedScene& scene) override {
        Clustering clustering;
        const IntersectionQuery query;
        const WarmCentres before = cached_->buffers.warm;
        workers_.run([&] { clustering = cpu::cluster(make_call(scene, query, nullptr)); });
        cached_->buffers.warm = before;
        return clustering;
    }

    bool may_have_lost_pairs() override { return std::exchange(may_lose_, false); }

    void swap_memory(std::unique_ptr<SceneMemory>& memory) override {
        if (!memory) memory = std::make_unique<SceneCache>();
        std::swap(static_cast<SceneCache&>(*memory).centres, cached_->buffers.warm);
    }

    void release() override {
        cached_.reset();
        cached_ = std::make_unique<Cached>(&meter_, workers_.workers(), intersect_, features_, candidates_);
    }

   private:
    struct SceneCache : SceneMemory {
        WarmCentres centres;
    };
    /// Data cached between calls.
    struct Cached {
        Cached(MemoryMeter* m, int workers, const IntersectKernels& kernels, const FeatureTables& features,
               const CandidateKernels& candidates)
            : rule(m),
              buffers(m, workers),
              leaves(m, workers, kernels),
              output(m),
              features(m, workers, features, candidates) {}
        SceneFilter rule;
        Buffers buffers;
        IntersectLeaves leaves;
        OutputScratch output;
        FeatureBuffers features;
    };

    IntersectCall make_call(const PreparedScene& scene, const IntersectionQuery& query, const Part* part) {
        Cached& k = *cached_;
        k.rule.prepare(query.filter, scene.bodies);
        IntersectCall call{{scene, k.rule, Levels(part), options_, kernels_, workers_, cancellation_, meter_, k.buffers,
                            statistics_, k.leaves},
                           query,
                           k.leaves,
                           k.output,
                           decides_};
        call.may_lose = &may_lose_;
        return call;
    }
    Call make_call(const PreparedScene& scene, const FeatureRequest& request) {
        Cached& k = *cached_;
        Call call{scene,
                  request.rule,
                  Levels(request.part),
                  options_,
                  kernels_,
                  workers_,
                  cancellation_,
                  meter_,
                  k.buffers,
                  statistics_,
                  leaves_of(scene, request, k.features)};
        call.may_lose = &may_lose_;
        call.low_memory = request.low_memory;
        call.inflation = request.radii.empty() ? inflation_of(scene, request)
                                               : inflation_of_radii(scene, request.radii, workers_, k.features);
        return call;
    }
    // Frees all cached data, and makes a call with Call::low_memory.
    IntersectCall call_in_chunks(const PreparedScene& scene, const IntersectionQuery& query, const Part* part) {
        release();
        statistics_ = {};
        meter_.peak = meter_.used.load();
        IntersectCall call = make_call(scene, query, part);
        call.low_memory = true;
        return call;
    }
    void find_in_chunks(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                        Intersections& result) {
        crumple::release(result);
        cpu::find_in_chunks(call_in_chunks(scene, query, part), result);
    }

    /// Resets a flag to its current value at the end of a scope.
    struct Restored {
        bool& flag;
        bool value;

        explicit Restored(bool& f) : flag(f), value(f) {}
        ~Restored() { flag = value; }
        Restored(const Restored&) = delete;
        Restored& operator=(const Restored&) = delete;
    };

    Options options_;
    const StageKernels& kernels_;
    const IntersectKernels& intersect_;
    const FeatureTables& features_;
    const CandidateKernels& candidates_;
    const OverlapKernels* overlaps_;
    Cancellation& cancellation_;
    Workers workers_;
    MemoryMeter& meter_;
    std::unique_ptr<Cached> cached_;
    Statistics statistics_;
    bool decides_ = true;    ///< see NarrowContext
    bool may_lose_ = false;  ///< see may_have_lost_pairs()
    /// Number of triangles of the smallest scene that has exceeded the memory limit: scenes of this size or more are
    /// searched in chunks.
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();
};

}  // namespace
}  // namespace cpu

std::unique_ptr<BackendBase> make_cpu_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation) {
    return std::make_unique<cpu::CpuBackend>(options, meter, cancellation);
}

}  // namespace crumple
