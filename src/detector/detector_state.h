#pragma once

// What a detector keeps from call to call, and how its calls are guarded: by the memory limit, by cancellation, by the
// floating-point environment.

#include <algorithm>
#include <limits>
#include <memory>
#include <stop_token>
#include <string>
#include <utility>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "base/float_environment.h"
#include "crumple/error.h"
#include "queries/checks.h"
#include "results/feature_output.h"
#include "results/intersection_output.h"
#include "results/nearest_output.h"
#include "results/world_output.h"
#include "search/distances.h"
#include "search/feature_search.h"
#include "search/world_search.h"

namespace crumple {

struct DetectorState {
    Options options;
    MemoryMeter meter;
    SceneBuffers buffers{&meter};
    Collisions result = metered(&meter);
    WorldCollisions world_result = metered_world(&meter);
    Impacts impacts = metered_impacts(&meter);
    Nearby nearby = metered_nearby(&meter);
    CandidateLists candidates = metered_candidates(&meter);
    NearestBodies nearest_bodies = metered_nearest(&meter);
    Cancellation cancellation;
    ShapeTrees named{meter};
    WorldSearch worlds{meter, cancellation, named};
    NearestSearch nearest{meter, cancellation, named};
    FeatureSearch features{meter, cancellation};
    Backend working = Backend::cpu;  ///< what `backend` is
    std::unique_ptr<BackendBase> backend;
    std::string fallback;
    std::int64_t kept_before_launch = 0;  ///< bytes that earlier calls have left

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
            default:
                return make_cpu_backend(options, meter, cancellation);
        }
    }

    void forget() {
        backend->release();
        buffers = SceneBuffers(&meter);
        result = metered(&meter);
        worlds.release();
        nearest.release();
        named.release();
        world_result = metered_world(&meter);
        nearest_bodies = metered_nearest(&meter);
        features.release();
        impacts = metered_impacts(&meter);
        nearby = metered_nearby(&meter);
        candidates = metered_candidates(&meter);
    }

    struct Lifted {
        MemoryMeter& meter;
        std::int64_t limit;
        explicit Lifted(MemoryMeter& m) : meter(m), limit(m.limit) {
            meter.limit = std::numeric_limits<std::int64_t>::max();
        }
        ~Lifted() { meter.limit = limit; }
    };

    // `least`: bytes that are needed at least; count() tells how many suffice.
    template <class Count>
    [[noreturn]] void throw_limit_error(std::int64_t least, Count count) {
        const bool counted = options.count_bytes_needed;
        const std::int64_t needed = counted ? count() : std::max(least, options.memory_limit + 1);
        const std::string message = "the memory limit of " + std::to_string(options.memory_limit) +
                                    " bytes is too small; " + (counted ? "" : "at least ") + std::to_string(needed) +
                                    (counted ? " bytes suffice" : " bytes are needed");
        throw Error(ErrorCode::memory_limit, message, Element::option, -1, needed, 0, !counted);
    }

    // Runs attempt(), and once more with nothing kept if it exceeds the limit and again() is true: perhaps it was what
    // earlier calls have left. `suffices` counts the memory limit that would do. A detector that throws holds an empty
    // result and no kept memory.
    template <class Attempt, class Again, class Suffices>
    void within_limit(std::stop_token stop, Attempt attempt, Again again, Suffices suffices) {
        const FloatEnvironment environment;
        cancellation.begin(std::move(stop));
        meter.peak = meter.used.load();
        try {
            try {
                attempt();
            } catch (const MemoryMeter::Exceeded&) {
                if (!again()) throw;
                forget();
                attempt();
            }
        } catch (const MemoryMeter::Exceeded& exceeded) {
            const std::int64_t least = std::max(exceeded.bytes, options.memory_limit + 1);
            forget();
            throw_limit_error(least, suffices);
        } catch (...) {
            forget();
            throw;
        }
    }

    // A detector that throws holds an empty result and no kept memory, unless a caller's graph works on that.
    template <class Work, class Count>
    void on_the_device(Work work, Count count) {
        const FloatEnvironment environment;
        try {
            try {
                work();
            } catch (const MemoryMeter::Exceeded& exceeded) {
                throw_limit_error(exceeded.bytes - kept_before_launch, count);
            }
        } catch (const Error& error) {
            if (!backend->keeps_after(error)) forget();
            throw;
        } catch (...) {
            forget();
            throw;
        }
    }

    // The peak of attempt() without a limit, with which it will succeed.
    template <class Attempt>
    std::int64_t peak_of(Attempt attempt) {
        std::int64_t needed = 0;
        {
            const Lifted lifted(meter);
            meter.peak = meter.used.load();
            attempt();
            needed = meter.peak;
        }
        forget();
        return needed;
    }
};

}  // namespace crumple
