// The seam of the cpu backend: what is kept between calls, and which way a call is answered. order.cpp knows the
// stages.

#include "engine/backend.h"

#include <limits>
#include <memory>

#include "engine/cpu/limit.h"
#include "engine/cpu/order.h"
#include "engine/output.h"

namespace crumple {
namespace cpu {
namespace {

class CpuBackend final : public BackendBase {
   public:
    CpuBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          kernels_(stage_kernels(options.simd)),
          intersect_(intersect_kernels(options.simd)),
          cancellation_(cancellation),
          workers_(options, cancellation),
          meter_(meter) {
        release();
    }

    void find(const Scene& scene, const Query& query, const Part* part, Collisions& result) override {
        statistics_ = {};
        workers_.run([&] {
            if (scene.triangle_count() >= too_many_) return find_in_chunks(scene, query, part, result);
            try {
                Call call = make_call(scene, query, part);
                PairBudget budget = budget_of(call);
                if (meter_.limit > 0) call.budget = &budget;
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

    std::int64_t bytes_needed(const Scene& scene, const Query& query, const Part* part) override {
        std::int64_t pairs = 0;
        workers_.run([&] { pairs = count_in_chunks(call_in_chunks(scene, query, part)); });
        return meter_.peak + result_bytes(scene, query, pairs);
    }

    bool any(const Scene& scene, const Query& query) override {
        std::atomic<bool> found{false};
        workers_.run([&] {
            try {
                Call call = make_call(scene, query, nullptr);
                call.found = &found;
                find_pairs(call);
            } catch (const MemoryMeter::Exceeded&) {
                found = any_in_chunks(call_in_chunks(scene, query, nullptr));
            }
        });
        return found;
    }

    bool heeds_bodies() const override { return true; }

    void parallel_for(std::size_t n, Task task) override {
        workers_.run([&] { workers_.parallel_for(n, [&](std::size_t i, std::size_t) { task(i); }); });
    }

    void release() override {
        buffers_.reset();
        buffers_ = std::make_unique<Buffers>(&meter_, workers_.workers());
    }

   private:
    Call make_call(const Scene& scene, const Query& query, const Part* part) {
        return {scene,    query, Levels(part),  options_, kernels_,  intersect_,
                workers_, *this, cancellation_, meter_,   *buffers_, statistics_};
    }
    // With nothing kept.
    Call call_in_chunks(const Scene& scene, const Query& query, const Part* part) {
        release();
        statistics_ = {};
        meter_.peak = meter_.used.load();
        return make_call(scene, query, part);
    }
    void find_in_chunks(const Scene& scene, const Query& query, const Part* part, Collisions& result) {
        crumple::release(result);
        cpu::find_in_chunks(call_in_chunks(scene, query, part), result);
    }

    Options options_;
    const StageKernels& kernels_;
    const IntersectKernels& intersect_;
    Cancellation& cancellation_;
    Workers workers_;
    MemoryMeter& meter_;
    std::unique_ptr<Buffers> buffers_;
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
