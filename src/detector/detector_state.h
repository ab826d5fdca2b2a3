#pragma once

// State that a detector keeps between calls, and functions that guard its calls: they set the floating-point
// environment, and handle cancellation and the memory limit.

#include <algorithm>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <tuple>
#include <utility>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "base/float_environment.h"
#include "crumple/error.h"
#include "queries/checks.h"
#include "results/feature_output.h"
#include "results/intersection_output.h"
#include "results/nearest_output.h"
#include "results/overlap_output.h"
#include "results/world_output.h"
#include "search/containment/closed_bodies.h"
#include "search/feature_search.h"
#include "search/nearest_bodies.h"
#include "search/overlap/overlap_search.h"
#include "search/world_search.h"

namespace crumple {

struct DetectorState {
    Options options;
    MemoryMeter meter;
    SceneBuffers buffers{&meter};
    Intersections result = metered(&meter);
    Impacts impacts = metered_impacts(&meter);
    Proximities nearby = metered_nearby(&meter);
    Candidates candidates = metered_candidates(&meter);
    Distances nearest_search = metered_nearest(&meter);
    Overlaps overlaps = metered_overlaps(&meter);
    Cancellation cancellation;
    ShapeTrees named{meter};
    WorldSearch worlds{meter, cancellation, named};
    NearestSearch nearest{meter, cancellation, named};
    ClosedBodies closed_bodies{meter, cancellation};
    OverlapSearch overlap_search{meter, cancellation, closed_bodies};
    FeatureSearch features{meter, cancellation, named};
    Backend working = Backend::cpu;  ///< type of `backend`
    std::unique_ptr<BackendBase> backend;
    std::unique_ptr<BackendBase> beside_device;  ///< see host_backend(); null until it is used
    std::string fallback;
    /// Results of a cancelled call. The next call frees them, and all that is cached, before anything else.
    std::optional<std::tuple<Intersections, Impacts, Proximities, Candidates, Distances, Overlaps>> left_over;
    std::int64_t bytes_before_launch = 0;  ///< metered bytes in use when the last launch began

    // Storage of the result of each query:
    Intersections& result_of(const IntersectionQuery&) { return result; }
    Impacts& result_of(const ImpactQuery&) { return impacts; }
    Proximities& result_of(const ProximityQuery&) { return nearby; }
    Candidates& result_of(const CandidateQuery&) { return candidates; }
    Distances& result_of(const DistanceQuery&) { return nearest_search; }
    Overlaps& result_of(const OverlapQuery&) { return overlaps; }

    explicit DetectorState(const Options& o) : options(o) {
        check_options(o);
        meter.limit = o.memory_limit;
        backend = make_backend();
    }

    std::unique_ptr<BackendBase> make_backend() {
        if (options.backend == Backend::automatic && has_cuda_backend()) {
            try {
                return make_backend(Backend::cuda);
            } catch (const Error& error) {
                fallback = error.what();
            }
        }
        return make_backend(options.backend == Backend::automatic ? Backend::cpu : options.backend);
    }
    std::unique_ptr<BackendBase> make_backend(Backend which) {
        working = which;
        switch (which) {
            case Backend::reference:
                return make_reference_backend(options, meter, cancellation);
            case Backend::cuda:
                if (!options.devices.empty()) return make_devices_backend(options, meter, cancellation);
                return make_cuda_backend(options, meter, cancellation);
            case Backend::automatic:
            case Backend::cpu:
                break;
        }
        return make_cpu_backend(options, meter, cancellation);
    }

    /// Returns the backend for what is computed on the host: `backend`, or with cuda a cpu backend.
    BackendBase& host_backend() {
        if (working != Backend::cuda) return *backend;
        if (!beside_device) beside_device = make_cpu_backend(options, meter, cancellation);
        return *beside_device;
    }

    /// Empties all results, and returns what they contained.
    auto empty_results() {
        return std::tuple(
            std::exchange(result, metered(&meter)), std::exchange(impacts, metered_impacts(&meter)),
            std::exchange(nearby, metered_nearby(&meter)), std::exchange(candidates, metered_candidates(&meter)),
            std::exchange(nearest_search, metered_nearest(&meter)), std::exchange(overlaps, metered_overlaps(&meter)));
    }

    void free_caches() {
        left_over.reset();
        empty_results();
        backend->release();
        if (beside_device) beside_device->release();
        buffers = SceneBuffers(&meter);
        worlds.release();
        nearest.release();
        named.release();
        overlap_search.release();
        closed_bodies.release();
        features.release();
    }

    /// Frees what a cancelled call has left. Checks for cancellation in between, since freeing a GB can take 0.15 s.
    void free_left_over() {
        if (!left_over) return;
        *left_over = {};
        cancellation.check();
        free_caches();
    }

    Error limit_error(std::int64_t least) const {
        least = std::max(least, options.memory_limit + 1);
        const std::int64_t suggested = std::max(2 * options.memory_limit, least + least / 4);
        return Error(ErrorCode::memory_limit,
                     "the memory limit of " + std::to_string(options.memory_limit) + " bytes is too small; at least " +
                         std::to_string(least) + " bytes are needed; try " + std::to_string(suggested),
                     Element::option, -1, least);
    }

    /// Guards one call: floating-point environment, cancellation, memory limit. Runs attempt(). If it exceeds the limit
    /// and again(least) returns true, frees everything that earlier calls have cached and runs it once more. `least` is
    /// a lower bound of the bytes that the attempt itself needs. A call that throws leaves an empty result and nothing
    /// cached, except that after a cancelled call the memory is freed by the next call (abandon()).
    template <class Attempt, class Again>
    void run(std::stop_token stop, Attempt attempt, Again again) {
        cancellation.begin(std::move(stop));
        free_left_over();
        meter.peak = meter.used.load();
        run_above(meter.used, attempt, again, [](const Error&) { return false; });
    }

    /// Guards a launch (run_launch) or the wait for its result (run_wait): floating-point environment, cancellation,
    /// memory limit. Does not try again if the memory limit is exceeded.
    template <class Work>
    LaunchNumber run_launch(Work work) {
        LaunchNumber launched = 0;
        cancellation.begin({});
        bytes_before_launch = meter.used;
        run_launched([&] { launched = work(); });
        return launched;
    }
    template <class Work>
    void run_wait(std::stop_token stop, Work work) {
        cancellation.begin(std::move(stop));
        run_launched([&] {
            cancellation.check();
            work();
        });
    }
    /// Guards a call about a launch. After an error, keeps cached memory if a caller's graph or a launch in flight
    /// needs it (BackendBase::keeps_after).
    template <class Work>
    void run_launched(Work work) {
        run_above(
            bytes_before_launch, work, [](std::int64_t) { return false; },
            [&](const Error& error) { return backend->keeps_after(error); });
    }

   private:
    // Frees everything, or leaves it to the next call if this one was cancelled. The cuda backend always frees at once:
    // freeing waits for the device, and a later launch must not wait.
    void abandon() {
        if (cancellation.stopped() && working != Backend::cuda)
            left_over = empty_results();
        else
            free_caches();
    }
    template <class Attempt, class Again, class Keeps>
    void run_above(std::int64_t kept, Attempt attempt, Again again, Keeps keeps) {
        const FloatEnvironment environment;
        try {
            try {
                try {
                    attempt();
                } catch (const MemoryMeter::Exceeded& exceeded) {
                    if (!again(exceeded.bytes - kept)) throw;
                    free_caches();
                    kept = 0;
                    attempt();
                }
            } catch (const MemoryMeter::Exceeded& exceeded) {
                throw limit_error(exceeded.bytes - kept);
            }
        } catch (const Error& error) {
            if (!keeps(error)) abandon();
            throw;
        } catch (...) {
            abandon();
            throw;
        }
    }
};

}  // namespace crumple
