// The front door: checks what comes in, sets the floating point environment, keeps the one result, and hands prepared
// scenes to a backend.

#include "crumple/detector.h"

#include <algorithm>
#include <limits>
#include <stop_token>
#include <string>
#include <utility>

#include "base/cancellation.h"
#include "base/float_environment.h"
#include "base/stopwatch.h"
#include "checks.h"
#include "crumple/error.h"
#include "engine/backend.h"
#include "engine/feature_output.h"
#include "engine/feature_search.h"
#include "engine/nearest.h"
#include "engine/nearest_output.h"
#include "engine/output.h"
#include "engine/reference/nearest.h"
#include "engine/reference/worlds.h"
#include "engine/world_output.h"
#include "engine/worlds.h"
#include "model/part.h"
#include "model/part_centres.h"

namespace crumple {

struct Detector::Implementation {
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

    explicit Implementation(const Options& o) : options(o) {
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

    // Runs `work` on the prepared scene, or on_device() where the meshes lie on a device; a detector that throws holds
    // an empty result and no kept memory.
    // `suffices` counts the memory limit that would do.
    template <class Work, class OnDevice, class Suffices>
    void guarded(const MeshView& a, const MeshView* b, const Part* part, const Query& query, std::stop_token stop,
                 Work work, OnDevice on_device, Suffices suffices) {
        const FloatEnvironment environment;
        cancellation.begin(std::move(stop));
        const auto attempt = [&] {
            if (a.memory == MemorySpace::host)
                work(prepare_scene(a, b, query.weld, *backend, buffers));
            else
                on_device();
        };
        try {
            cancellation.check();
            check_query(a, b, query);
            if (part) check_part(*part);
            std::int64_t kept = meter.used;
            try {
                try {
                    attempt();
                } catch (const MemoryMeter::Exceeded& exceeded) {
                    if (exceeded.bytes - kept > meter.limit) throw;
                    // Perhaps it was what earlier calls have left: once more, with nothing kept.
                    forget();
                    kept = 0;
                    attempt();
                }
            } catch (const MemoryMeter::Exceeded& exceeded) {
                throw_limit_error(exceeded.bytes - kept, suffices);
            }
        } catch (...) {
            forget();
            throw;
        }
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

    // The limit that suffices, counted with records beyond the limit but without storing pairs.
    std::int64_t bytes_needed(const MeshView& a, const MeshView* b, const Part* part, const Query& query) {
        forget();
        const Lifted lifted(meter);
        if (a.memory != MemorySpace::host) return backend->bytes_needed(a, b, query);
        return backend->bytes_needed(prepare_scene(a, b, query.weld, *backend, buffers), query, part);
    }

    const Collisions& find(const MeshView& a, const MeshView* b, const Part* part, const Query& query,
                           std::stop_token stop) {
        Stopwatch watch;
        meter.peak = meter.used.load();
        result.statistics = {};
        guarded(
            a, b, part, query, std::move(stop), [&](const Scene& scene) { backend->find(scene, query, part, result); },
            [&] { backend->find(a, b, query, result); }, [&] { return bytes_needed(a, b, part, query); });
        if (part) name_globally(*part, result.pairs);
        result.statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
        result.statistics.pairs = static_cast<std::int64_t>(result.pairs.size());
        result.statistics.peak_memory_bytes = meter.peak;
        result.statistics.milliseconds = watch.lap();
        return result;
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

    const WorldCollisions& find(const World& world, const Intersect& question, std::stop_token stop,
                                const WorldBlocks* blocks = nullptr) {
        Stopwatch watch;
        bool handed_over = false;
        const auto noting = [&](const WorldCollisions& block) {
            handed_over = true;
            blocks->take(block);
        };
        const auto attempt = [&] {
            if (!blocks) return search(world, question, nullptr);
            const WorldBlocks noted{blocks->how, noting};
            search(world, question, &noted);
        };
        // Who has taken blocks cannot begin again.
        within_limit(
            std::move(stop), attempt, [&] { return !handed_over; },
            [&] { return bytes_needed(world, question, blocks); });
        Statistics& statistics = world_result.statistics;
        statistics.pairs = world_result.count;
        statistics.peak_memory_bytes = meter.peak;
        statistics.milliseconds = watch.lap();
        return world_result;
    }

    template <class Question, class Answer>
    const Answer& find(const World& world, const Question& question, bool bodies, Answer& answer,
                       std::stop_token stop) {
        Stopwatch watch;
        bool frugal = false;
        const auto attempt = [&] {
            check_question(question, bodies);
            features.find(*backend, world, question, bodies, frugal, answer);
        };
        // What several workers need depends on who does what, so it cannot be promised.
        within_limit(
            std::move(stop), attempt, [&] { return frugal = true; }, [&] { return peak_of(attempt); });
        answer.statistics.peak_memory_bytes = meter.peak;
        answer.statistics.milliseconds = watch.lap();
        return answer;
    }
    const NearestBodies& find_nearest(const World& world, const Nearest& question, std::stop_token stop) {
        Stopwatch watch;
        bool frugal = false;
        const auto attempt = [&] {
            check(working != Backend::cuda, "distances of bodies need the cpu backend (Options::backend)");
            check_question(question);
            if (working == Backend::reference)
                find_nearest_by_brute_force(world, question, meter, cancellation, nearest_bodies);
            else
                nearest.find(*backend, world, question, frugal, nearest_bodies);
        };
        within_limit(
            std::move(stop), attempt, [&] { return frugal = true; }, [&] { return peak_of(attempt); });
        Statistics& statistics = nearest_bodies.statistics;
        statistics.pairs = static_cast<std::int64_t>(nearest_bodies.bodies.size());
        statistics.peak_memory_bytes = meter.peak;
        statistics.milliseconds = watch.lap();
        return nearest_bodies;
    }
    // One mesh is a world of one body.
    const Impacts& find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question,
                                std::stop_token stop) {
        const Shape shape = moving_shape(mesh, end);
        const Body body;
        return find({{&shape, 1}, {&body, 1}, {}, {}}, question, false, impacts, std::move(stop));
    }
    const Nearby& find_near(const MeshView& mesh, const Near& question, std::stop_token stop) {
        Shape shape = host_shape(mesh);
        shape.radii = question.radii;
        shape.rest = question.rest;
        const Body body;
        return find({{&shape, 1}, {&body, 1}, {}, {}}, question, false, nearby, std::move(stop));
    }
    /// `end`: null at rest.
    const CandidateLists& find_candidates(const MeshView& mesh, const VertexView* end,
                                          const CandidateQuestion& question, std::stop_token stop) {
        const Shape shape = end ? moving_shape(mesh, *end) : host_shape(mesh);
        const Body body;
        return find({{&shape, 1}, {&body, 1}, {}, {}}, question, false, candidates, std::move(stop));
    }
    Shape host_shape(const MeshView& mesh) {
        if (mesh.memory != MemorySpace::host) refuse("motion, nearness and candidates take meshes in host memory");
        return Shape(mesh);
    }
    Shape moving_shape(const MeshView& mesh, const VertexView& end) {
        Shape shape = host_shape(mesh);
        shape.end = end;
        if (!end.data && end.rows == 0 && mesh.vertices.rows > 0) refuse("the vertices at the end are missing");
        return shape;
    }
    [[noreturn]] void refuse(const char* message) {
        forget();
        throw Error(ErrorCode::invalid_argument, message, Element::option);
    }

    void search(const World& world, const Intersect& question, const WorldBlocks* blocks) {
        if (working == Backend::reference)
            find_by_brute_force(world, question, meter, cancellation, world_result, blocks);
        else
            worlds.find(*backend, world, question, world_result, blocks);
    }

    Statistics stream(const World& world, TakeWorldBlock take, const Intersect& question, const Streaming& how,
                      std::stop_token stop) {
        check_blocks(how);
        check(question.wants == Wants::pairs || question.wants == Wants::contacts, "blocks have pairs, or contacts");
        if (meter.limit > 0) forget();
        const WorldBlocks blocks{how, take};
        return find(world, question, std::move(stop), &blocks).statistics;
    }

    // The limit that suffices: found by answering without one.
    std::int64_t bytes_needed(const World& world, const Intersect& question, const WorldBlocks* blocks) {
        const auto ignore = [](const WorldCollisions&) {};
        const WorldBlocks ignored{blocks ? blocks->how : Streaming(), ignore};
        return peak_of([&] { search(world, question, blocks ? &ignored : nullptr); });
    }

    void swap_result(Collisions& other) {
        if (meter.limit > 0) other = {};
        const auto swap_arrays = [](auto& mine, auto& theirs) {
            mine.swap_elements(theirs);  // throws under a limit only, and then there is nothing to count
            mine.clear();
        };
        swap_arrays(result.pairs, other.pairs);
        swap_arrays(result.offsets, other.offsets);
        swap_arrays(result.hit, other.hit);
        swap_arrays(result.hit_second, other.hit_second);
        swap_arrays(result.contacts.kinds, other.contacts.kinds);
        swap_arrays(result.contacts.offsets, other.contacts.offsets);
        swap_arrays(result.contacts.points, other.contacts.points);
        other.statistics = std::exchange(result.statistics, {});
    }
    void swap_result(WorldCollisions& other) {
        if (meter.limit > 0) other = {};
        hand_over(world_result, other);
    }
    template <class Answer>
    void swap_answer(Answer& answer, Answer& other) {
        if (meter.limit > 0) other = {};
        hand_over(answer, other);
    }

    bool any(const MeshView& a, const MeshView* b, const Query& query, std::stop_token stop) {
        bool found = false;
        guarded(
            a, b, nullptr, query, std::move(stop), [&](const Scene& scene) { found = backend->any(scene, query); },
            [&] { found = backend->any(a, b, query); }, [&] { return bytes_needed(a, b, nullptr, query); });
        return found;
    }

    Statistics stream(const MeshView& a, const MeshView* b, TakeBlock take, const Query& query, const Streaming& how,
                      std::stop_token stop) {
        Stopwatch watch;
        check_blocks(how);
        if (meter.limit > 0) forget();  // a call that has handed over blocks cannot begin again
        meter.peak = meter.used.load();
        Statistics statistics;
        const auto work = [&](const Scene& scene, TakeBlock sink) {
            backend->stream(scene, query, how, sink, statistics);
        };
        std::int64_t pairs = 0;
        const auto count = [&](const Collisions& block) {
            pairs += static_cast<std::int64_t>(block.pairs.size());
            take(block);
        };
        guarded(
            a, b, nullptr, query, std::move(stop), [&](const Scene& scene) { work(scene, count); },
            [] { check(false, "answers in blocks are made of meshes in host memory"); },
            [&] {
                forget();
                const Lifted lifted(meter);
                meter.peak = meter.used.load();
                work(prepare_scene(a, b, query.weld, *backend, buffers), [](const Collisions&) {});
                return meter.peak.load();
            });
        statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
        statistics.pairs = pairs;
        statistics.peak_memory_bytes = meter.peak;
        statistics.milliseconds = watch.lap();
        return statistics;
    }

    void launch(const MeshView& a, const MeshView* b, const Query& query) {
        cancellation.begin({});
        kept_before_launch = meter.used;
        on_the_device(
            [&] {
                check_query(a, b, query);
                if (a.memory == MemorySpace::host)
                    throw Error(ErrorCode::invalid_argument,
                                "launch_self and launch_between take meshes in device memory");
                backend->launch(a, b, query);
            },
            [&] { return bytes_needed(a, b, nullptr, query); });
    }
    const DeviceCollisions& wait(std::stop_token stop) {
        const DeviceCollisions* answer = nullptr;
        cancellation.begin(std::move(stop));
        on_the_device(
            [&] {
                cancellation.check();
                answer = &backend->wait();
            },
            [&] { return bytes_needed_for_launched(); });
        return *answer;
    }
    const Collisions& download() {
        on_the_device([&] { backend->download(result); }, [&] { return bytes_needed_for_launched(); });
        return result;
    }
    std::int64_t bytes_needed_for_launched() {
        const Lifted lifted(meter);
        return backend->bytes_needed_for_launched();
    }
    // A detector that throws holds an empty result and no kept memory.
    template <class Work, class Count>
    void on_the_device(Work work, Count count) {
        const FloatEnvironment environment;
        try {
            try {
                work();
            } catch (const MemoryMeter::Exceeded& exceeded) {
                throw_limit_error(exceeded.bytes - kept_before_launch, count);
            }
        } catch (...) {
            forget();
            throw;
        }
    }

    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count, std::stop_token stop) {
        if (count < 1 || count > max_parts) {
            forget();
            throw Error(ErrorCode::invalid_argument, "the number of parts must be 1 to 262144", Element::option);
        }
        std::vector<Part> parts;
        guarded(
            a, b, nullptr, {}, std::move(stop), [&](const Scene& scene) { parts = make_parts(scene, count, *backend); },
            [&] { parts = backend->partition(a, b, count); }, [&] { return bytes_needed(a, b, nullptr, {}); });
        return parts;
    }
};

Detector::Detector(const Options& options) : implementation_(std::make_unique<Implementation>(options)) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

const Collisions& Detector::find_self(const MeshView& mesh, const Query& query, std::stop_token stop) {
    return implementation_->find(mesh, nullptr, nullptr, query, std::move(stop));
}
const Collisions& Detector::find_between(const MeshView& a, const MeshView& b, const Query& query,
                                         std::stop_token stop) {
    return implementation_->find(a, &b, nullptr, query, std::move(stop));
}
Statistics Detector::stream_self(const MeshView& mesh, TakeBlock take, const Query& query, const Streaming& how,
                                 std::stop_token stop) {
    return implementation_->stream(mesh, nullptr, take, query, how, std::move(stop));
}
Statistics Detector::stream_between(const MeshView& a, const MeshView& b, TakeBlock take, const Query& query,
                                    const Streaming& how, std::stop_token stop) {
    return implementation_->stream(a, &b, take, query, how, std::move(stop));
}
const Collisions& Detector::find(const Part& part, const Query& query, std::stop_token stop) {
    const MeshView first = part.mesh.view(), second = part.second ? part.second->view() : MeshView();
    return implementation_->find(first, part.second ? &second : nullptr, &part, query, std::move(stop));
}
const WorldCollisions& Detector::find(const World& world, const Intersect& question, std::stop_token stop) {
    return implementation_->find(world, question, std::move(stop));
}
const Impacts& Detector::find_impacts(const World& world, const Motion& question, std::stop_token stop) {
    return implementation_->find(world, question, true, implementation_->impacts, std::move(stop));
}
const Impacts& Detector::find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question,
                                      std::stop_token stop) {
    return implementation_->find_impacts(mesh, end, question, std::move(stop));
}
FirstImpact Detector::time_of_first_impact(const MeshView& mesh, const VertexView& end, const Motion& question,
                                           std::stop_token stop) {
    Motion asked = question;
    asked.wants = MotionWants::earliest;
    return find_impacts(mesh, end, asked, std::move(stop)).first;
}
bool Detector::is_free(const MeshView& mesh, const VertexView& end, const Motion& question, std::stop_token stop) {
    Motion asked = question;
    asked.wants = MotionWants::any;
    return !find_impacts(mesh, end, asked, std::move(stop)).any;
}
const Nearby& Detector::find_near(const World& world, const Near& question, std::stop_token stop) {
    return implementation_->find(world, question, true, implementation_->nearby, std::move(stop));
}
const Nearby& Detector::find_near(const MeshView& mesh, const Near& question, std::stop_token stop) {
    return implementation_->find_near(mesh, question, std::move(stop));
}
const CandidateLists& Detector::find_candidates(const World& world, const CandidateQuestion& question,
                                                std::stop_token stop) {
    return implementation_->find(world, question, true, implementation_->candidates, std::move(stop));
}
const CandidateLists& Detector::find_candidates(const MeshView& mesh, const CandidateQuestion& question,
                                                std::stop_token stop) {
    return implementation_->find_candidates(mesh, nullptr, question, std::move(stop));
}
const CandidateLists& Detector::find_candidates(const MeshView& mesh, DefaultQuery, std::stop_token stop) {
    return find_candidates(mesh, CandidateQuestion(), std::move(stop));
}
const CandidateLists& Detector::find_candidates(const MeshView& mesh, const VertexView& end,
                                                const CandidateQuestion& question, std::stop_token stop) {
    return implementation_->find_candidates(mesh, &end, question, std::move(stop));
}
const NearestBodies& Detector::find_nearest(const World& world, const Nearest& question, std::stop_token stop) {
    return implementation_->find_nearest(world, question, std::move(stop));
}
Statistics Detector::stream(const World& world, TakeWorldBlock take, const Intersect& question, const Streaming& how,
                            std::stop_token stop) {
    return implementation_->stream(world, take, question, how, std::move(stop));
}
bool Detector::has_collision(const MeshView& mesh, const Query& query, std::stop_token stop) {
    return implementation_->any(mesh, nullptr, query, std::move(stop));
}
bool Detector::has_collision(const MeshView& a, const MeshView& b, const Query& query, std::stop_token stop) {
    return implementation_->any(a, &b, query, std::move(stop));
}
bool Detector::has_collision(const MeshView& mesh, DefaultQuery, std::stop_token stop) {
    return has_collision(mesh, Query(), std::move(stop));
}
std::vector<Part> Detector::partition(const MeshView& mesh, int count, std::stop_token stop) {
    return implementation_->partition(mesh, nullptr, count, std::move(stop));
}
std::vector<Part> Detector::partition(const MeshView& a, const MeshView& b, int count, std::stop_token stop) {
    return implementation_->partition(a, &b, count, std::move(stop));
}
void Detector::launch_self(const MeshView& mesh, const Query& query) { implementation_->launch(mesh, nullptr, query); }
void Detector::launch_between(const MeshView& a, const MeshView& b, const Query& query) {
    implementation_->launch(a, &b, query);
}
const DeviceCollisions& Detector::wait(std::stop_token stop) { return implementation_->wait(std::move(stop)); }
const Collisions& Detector::download() { return implementation_->download(); }
void Detector::swap_result(Collisions& other) { implementation_->swap_result(other); }
void Detector::swap_result(WorldCollisions& other) { implementation_->swap_result(other); }
void Detector::swap_result(Impacts& other) { implementation_->swap_answer(implementation_->impacts, other); }
void Detector::swap_result(Nearby& other) { implementation_->swap_answer(implementation_->nearby, other); }
void Detector::swap_result(CandidateLists& other) { implementation_->swap_answer(implementation_->candidates, other); }
void Detector::swap_result(NearestBodies& other) {
    implementation_->swap_answer(implementation_->nearest_bodies, other);
}
void Detector::set_poll(std::function<void()> poll) { implementation_->cancellation.set_poll(std::move(poll)); }
const Options& Detector::options() const { return implementation_->options; }
Backend Detector::backend() const { return implementation_->working; }
std::string_view Detector::fallback() const { return implementation_->fallback; }

}  // namespace crumple
