// The front door: a detector's calls on meshes, which it checks and hands to a backend. Those on worlds are in
// world_calls.cpp, what all have in common in detector_state.h.

#include "crumple/detector.h"

#include <stop_token>
#include <string>
#include <utility>

#include "base/stopwatch.h"
#include "detector/free_step.h"
#include "detector/world_calls.h"
#include "partition/part_centres.h"
#include "partition/parts_of_scene.h"

namespace crumple {

struct Detector::Implementation : WorldCalls {
    using WorldCalls::find, WorldCalls::partition, WorldCalls::stream, WorldCalls::WorldCalls;

    /// Runs `work` on the prepared scene, or on_device() where the meshes lie on a device.
    template <class Work, class OnDevice>
    void run_on_meshes(const MeshView& a, const MeshView* b, const Part* part, const Query& query, std::stop_token stop,
                       Work work, OnDevice on_device) {
        const auto attempt = [&] {
            cancellation.check();
            check_query(a, b, query);
            if (part) {
                check_part(*part);
                check(!part->features, "the part was made for a question about features");
            }
            if (a.memory == MemorySpace::host)
                work(prepare_scene(a, b, query.weld, *backend, buffers));
            else
                on_device();
        };
        run(std::move(stop), attempt, [&](std::int64_t least) { return least <= meter.limit; });
    }

    const Collisions& find(const MeshView& a, const MeshView* b, const Part* part, const Query& query,
                           std::stop_token stop) {
        Stopwatch watch;
        result.statistics = {};
        run_on_meshes(
            a, b, part, query, std::move(stop), [&](const Scene& scene) { backend->find(scene, query, part, result); },
            [&] { backend->find(a, b, query, result); });
        if (part) name_globally(*part, result.pairs);
        result.statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
        result.statistics.pairs = static_cast<std::int64_t>(result.pairs.size());
        result.statistics.peak_memory_bytes = meter.peak;
        result.statistics.milliseconds = watch.lap();
        return result;
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
        run_on_meshes(
            a, b, nullptr, query, std::move(stop), [&](const Scene& scene) { found = backend->any(scene, query); },
            [&] { found = backend->any(a, b, query); });
        return found;
    }

    Statistics stream(const MeshView& a, const MeshView* b, TakeBlock take, const Query& query, const Streaming& how,
                      std::stop_token stop) {
        Stopwatch watch;
        check_blocks(how);
        if (meter.limit > 0) forget();  // a call that has delivered blocks cannot begin again
        Statistics statistics;
        std::int64_t pairs = 0;
        const auto count = [&](const Collisions& block) {
            pairs += static_cast<std::int64_t>(block.pairs.size());
            take(block);
        };
        run_on_meshes(
            a, b, nullptr, query, std::move(stop),
            [&](const Scene& scene) { backend->stream(scene, query, how, count, statistics); },
            [] { check(false, "answers in blocks are made of meshes in host memory"); });
        statistics.triangles = a.triangles.rows + (b ? b->triangles.rows : 0);
        statistics.pairs = pairs;
        statistics.peak_memory_bytes = meter.peak;
        statistics.milliseconds = watch.lap();
        return statistics;
    }

    void launch(const MeshView& a, const MeshView* b, const Query& query) {
        cancellation.begin({});
        kept_before_launch = meter.used;
        run_launched([&] {
            check_query(a, b, query);
            if (a.memory == MemorySpace::host)
                throw Error(ErrorCode::invalid_argument, "launch_self and launch_between take meshes in device memory");
            backend->launch(a, b, query);
        });
    }
    void launch(const World& world, const Intersect& question) {
        cancellation.begin({});
        kept_before_launch = meter.used;
        run_launched([&] {
            check(lies_on_device(world) || world.bodies.empty(),
                  "launch takes worlds whose poses lie in device memory");
            check_device_poses(world);
            check_on_device(question);
            backend->launch(world, question);
        });
    }
    const DeviceWorldCollisions& wait_worlds(std::stop_token stop) {
        const DeviceWorldCollisions* answer = nullptr;
        cancellation.begin(std::move(stop));
        run_launched([&] {
            cancellation.check();
            answer = &backend->wait_worlds();
        });
        return *answer;
    }
    const DeviceCollisions& wait(std::stop_token stop) {
        const DeviceCollisions* answer = nullptr;
        cancellation.begin(std::move(stop));
        run_launched([&] {
            cancellation.check();
            answer = &backend->wait();
        });
        return *answer;
    }
    const Collisions& download() {
        run_launched([&] { backend->download(result); });
        return result;
    }
    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count, std::stop_token stop) {
        if (count < 1 || count > max_parts) {
            forget();
            throw Error(ErrorCode::invalid_argument, "the number of parts must be 1 to 262144", Element::option);
        }
        std::vector<Part> parts;
        run_on_meshes(
            a, b, nullptr, {}, std::move(stop), [&](const Scene& scene) { parts = make_parts(scene, count, *backend); },
            [&] { parts = backend->partition(a, b, count); });
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
    return implementation_->find_impacts(world, question, std::move(stop));
}
const Impacts& Detector::find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question,
                                      std::stop_token stop) {
    return implementation_->find_impacts(mesh, end, question, std::move(stop));
}
const Impacts& Detector::find_impacts(const Part& part, const Motion& question, std::stop_token stop) {
    return implementation_->find_impacts(part, question, std::move(stop));
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
FreeStep Detector::find_free_step(const MeshView& mesh, const VertexView& end, const Motion& question,
                                  std::stop_token given) {
    const std::stop_token stop = std::move(given);
    if (mesh.memory == MemorySpace::host) return free_step(*this, mesh, end, question, stop);
    HostShape copy;
    implementation_->copy_to_host(mesh, end, copy);
    MeshView here(copy.shape.vertices, copy.shape.triangles, copy.shape.groups);
    here.edges = copy.shape.edges;
    here.points = copy.shape.points;
    return free_step(*this, here, copy.shape.end, question, stop);
}
const Nearby& Detector::find_near(const World& world, const Near& question, std::stop_token stop) {
    return implementation_->find_near(world, question, std::move(stop));
}
const Nearby& Detector::find_near(const MeshView& mesh, const Near& question, std::stop_token stop) {
    return implementation_->find_near(mesh, question, std::move(stop));
}
const Nearby& Detector::find_near(const Part& part, const Near& question, std::stop_token stop) {
    return implementation_->find_near(part, question, std::move(stop));
}
const CandidateLists& Detector::find_candidates(const World& world, const CandidateQuestion& question,
                                                std::stop_token stop) {
    return implementation_->find_candidates(world, question, std::move(stop));
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
Statistics Detector::stream_impacts(const World& world, TakeImpacts take, const Motion& question, const Streaming& how,
                                    std::stop_token stop) {
    return implementation_->stream_impacts(world, take, question, how, std::move(stop));
}
Statistics Detector::stream_impacts(const MeshView& mesh, const VertexView& end, TakeImpacts take,
                                    const Motion& question, const Streaming& how, std::stop_token stop) {
    return implementation_->stream_impacts(mesh, end, take, question, how, std::move(stop));
}
Statistics Detector::stream_near(const World& world, TakeNearby take, const Near& question, const Streaming& how,
                                 std::stop_token stop) {
    return implementation_->stream_near(world, take, question, how, std::move(stop));
}
Statistics Detector::stream_near(const MeshView& mesh, TakeNearby take, const Near& question, const Streaming& how,
                                 std::stop_token stop) {
    return implementation_->stream_near(mesh, take, question, how, std::move(stop));
}
Statistics Detector::stream_candidates(const World& world, TakeCandidates take, const CandidateQuestion& question,
                                       const Streaming& how, std::stop_token stop) {
    return implementation_->stream_candidates(world, take, question, how, std::move(stop));
}
Statistics Detector::stream_candidates(const MeshView& mesh, TakeCandidates take, const CandidateQuestion& question,
                                       const Streaming& how, std::stop_token stop) {
    return implementation_->stream_candidates(mesh, nullptr, take, question, how, std::move(stop));
}
Statistics Detector::stream_candidates(const MeshView& mesh, const VertexView& end, TakeCandidates take,
                                       const CandidateQuestion& question, const Streaming& how, std::stop_token stop) {
    return implementation_->stream_candidates(mesh, &end, take, question, how, std::move(stop));
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
std::vector<Part> Detector::partition(const MeshView& mesh, const VertexView& end, const Motion& question, int count,
                                      std::stop_token stop) {
    return implementation_->partition(mesh, end, question, count, std::move(stop));
}
std::vector<Part> Detector::partition(const MeshView& mesh, const Near& question, int count, std::stop_token stop) {
    return implementation_->partition(mesh, question, count, std::move(stop));
}
void Detector::launch_impacts(const MeshView& mesh, const VertexView& end, const Motion& question) {
    implementation_->launch_impacts(mesh, end, question);
}
void Detector::launch_near(const MeshView& mesh, const Near& question) { implementation_->launch_near(mesh, question); }
void Detector::launch_candidates(const MeshView& mesh, const CandidateQuestion& question) {
    implementation_->launch_candidates(mesh, nullptr, question);
}
void Detector::launch_candidates(const MeshView& mesh, const VertexView& end, const CandidateQuestion& question) {
    implementation_->launch_candidates(mesh, &end, question);
}
const DeviceImpacts& Detector::wait_impacts(std::stop_token stop) {
    return implementation_->wait_impacts(std::move(stop));
}
const DeviceNearby& Detector::wait_near(std::stop_token stop) { return implementation_->wait_near(std::move(stop)); }
const DeviceCandidates& Detector::wait_candidates(std::stop_token stop) {
    return implementation_->wait_candidates(std::move(stop));
}
void Detector::launch_self(const MeshView& mesh, const Query& query) { implementation_->launch(mesh, nullptr, query); }
void Detector::launch_between(const MeshView& a, const MeshView& b, const Query& query) {
    implementation_->launch(a, &b, query);
}
const DeviceCollisions& Detector::wait(std::stop_token stop) { return implementation_->wait(std::move(stop)); }
void Detector::launch(const World& world, const Intersect& question) { implementation_->launch(world, question); }
const DeviceWorldCollisions& Detector::wait_worlds(std::stop_token stop) {
    return implementation_->wait_worlds(std::move(stop));
}
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
