#pragma once

// Order of the stages, the same for every kind of query (Algorithm 1 of [MZ], the paper cited in ARCHITECTURE.md).

#include <algorithm>
#include <atomic>

#include "backends/cpu/buffers.h"
#include "backends/cpu/leaf_query.h"
#include "backends/cpu/parallel.h"
#include "partition/levels.h"
#include "scene/scene_filter.h"

namespace crumple::cpu {

/// Request, settings and resources of one call. `rule`: the pair filter.
struct Call {
    const PreparedScene& scene;
    const SceneFilter& rule;
    Levels levels;  ///< levels of subdivision above the scene, if it is a part of a larger one
    const Options& options;
    const StageKernels& kernels;
    Workers& workers;
    Cancellation& cancellation;
    MemoryMeter& meter;
    Buffers& buffers;
    Statistics& statistics;
    LeafQuery& query;

    bool low_memory = false;        ///< true: searches one first-level cluster after another, on one worker
    std::int64_t* units = nullptr;  ///< number of units that a stream has begun; null: no stream
    Inflation inflation = {};       ///< inflation of every triangle
    bool* may_lose = nullptr;       ///< set to true if the membership rule may lose pairs; null: it cannot

    /// Returns the normalised vertices. measure() must have run.
    PointRows points() const {
        return scene.float32 ? PointRows{buffers.points.f.data(), nullptr}
                             : PointRows{nullptr, buffers.points.d.data()};
    }
};

/// Calls task(i, worker) for i in [0, n), in parallel. In a stream, each task is a unit (RowStream:
/// queries/row_stream.h); units begin in ascending order.
template <class Task>
void for_each_unit(const Call& call, std::size_t n, Task task) {
    if (!call.units) return call.workers.parallel_for(n, task);
    const std::int64_t first = *call.units;
    *call.units += static_cast<std::int64_t>(n);
    std::atomic<std::size_t> next{0};
    const auto work = [&](std::size_t worker) {
        try {
            for (std::size_t i; (i = next.fetch_add(1)) < n;) {
                call.cancellation.check();
                call.query.begin_unit(first + static_cast<std::int64_t>(i), worker);
                task(i, worker);
                call.query.end_unit(worker);
            }
        } catch (...) {
            call.query.fail();
            throw;
        }
    };
    if (call.low_memory) return work(0);
    call.workers.parallel_for(std::min(n, static_cast<std::size_t>(call.workers.workers())),
                              [&](std::size_t, std::size_t worker) { work(worker); });
}

/// Runs stage `bounds`.
void measure(const Call& call);

/// Runs stage `subdivide` for the whole scene, without a search. measure() must have run.
void subdivide(const Call& call);

/// Runs the stages from `subdivide` to `narrow` on a scene for which measure() has run. `call.query` keeps the results.
void search(const Call& call);

}  // namespace crumple::cpu
