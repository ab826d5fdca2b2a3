#include "detector/world_calls.h"

#include <utility>

#include "backends/reference/reference_distances.h"
#include "backends/reference/reference_worlds.h"
#include "base/stopwatch.h"
#include "partition/part_centres.h"
#include "scene/lone_bodies.h"

namespace crumple {
namespace {

/// A world as the host can read it: where poses lie on a device, with copies of them.
class PosedOnHost {
   public:
    PosedOnHost(BackendBase& backend, const World& world) : world_(world) {
        if (!lies_on_device(world)) return;
        check_device_poses(world);
        const auto copy = [&](DevicePoses& there, std::vector<Pose>& here, std::span<const Pose>& poses) {
            if (!given(there)) return;
            here = backend.poses_of(there);
            poses = here;
            there = {};
        };
        copy(world_.device_poses, poses_, world_.poses);
        copy(world_.device_end_poses, end_poses_, world_.end_poses);
    }
    PosedOnHost(const PosedOnHost&) = delete;
    PosedOnHost& operator=(const PosedOnHost&) = delete;
    const World& world() const { return world_; }

   private:
    World world_;
    std::vector<Pose> poses_, end_poses_;
};

}  // namespace

const WorldCollisions& WorldCalls::find(const World& world, const Intersect& question, std::stop_token stop,
                                        const WorldBlocks* blocks) {
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
    // A call that has delivered blocks cannot begin again.
    run(std::move(stop), attempt, [&](std::int64_t) { return !handed_over; });
    Statistics& statistics = world_result.statistics;
    statistics.pairs = world_result.count;
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return world_result;
}

template <class Question, class Answer>
const Answer& WorldCalls::find_features(const World& world, const Question& question, bool bodies, Answer& answer,
                                        std::stop_token stop) {
    return answered(answer, std::move(stop), [&](bool frugal) {
        check_question(question, bodies);
        if (!bodies) check_groups(question.rules, world.shapes[0].triangles.rows, !world.shapes[0].groups.empty());
        features.find(*backend, PosedOnHost(*backend, world).world(), question, bodies, frugal, answer);
    });
}

template <class Question, class Answer>
const Answer& WorldCalls::find_features(const Part& part, const Question& question, Answer& answer,
                                        std::stop_token stop) {
    return answered(answer, std::move(stop), [&](bool frugal) {
        check_question(question, false);
        check_groups(question.rules, part.mesh.size(), !part.mesh.groups.empty());
        features.find(*backend, part, question, frugal, answer);
    });
}

template <class Question>
std::vector<Part> WorldCalls::partition_shape(const Shape& shape, const Question& question, int count,
                                              std::stop_token stop) {
    std::vector<Part> parts;
    const Body body{.self = true};
    const World world{{&shape, 1}, {&body, 1}, {}, {}};
    const auto attempt = [&] {
        check(count >= 1 && count <= max_parts, "the number of parts must be 1 to 262144");
        check_question(question, false);
        parts = features.partition(*backend, world, question, count);
    };
    run(std::move(stop), attempt, [](std::int64_t) { return true; });
    return parts;
}

// Under a limit from the start as with nothing kept: a call that has handed over blocks cannot begin again.
template <class Question, class Answer>
Statistics WorldCalls::stream_features(const World& world, const Question& question, bool bodies,
                                       const FeatureBlocks<Answer>& blocks, Answer& answer, std::stop_token stop) {
    Stopwatch watch;
    if (meter.limit > 0) forget();
    const auto stream = [&] {
        check_blocks(blocks.how);
        check_question(question, bodies);
        if (!bodies) check_groups(question.rules, world.shapes[0].triangles.rows, !world.shapes[0].groups.empty());
        check_in_blocks(question);
        const PosedOnHost there(*backend, world);
        features.stream(*backend, there.world(), question, bodies, meter.limit > 0, blocks, answer);
    };
    run(std::move(stop), stream, [](std::int64_t) { return false; });
    Statistics statistics = answer.statistics;
    clear(answer);
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return statistics;
}

Statistics WorldCalls::stream_impacts(const World& world, TakeImpacts take, const Motion& question,
                                      const Streaming& how, std::stop_token stop) {
    return stream_features(world, question, true, {how, take}, impacts, std::move(stop));
}
Statistics WorldCalls::stream_near(const World& world, TakeNearby take, const Near& question, const Streaming& how,
                                   std::stop_token stop) {
    return stream_features(world, question, true, {how, take}, nearby, std::move(stop));
}
Statistics WorldCalls::stream_candidates(const World& world, TakeCandidates take, const CandidateQuestion& question,
                                         const Streaming& how, std::stop_token stop) {
    return stream_features(world, question, true, {how, take}, candidates, std::move(stop));
}
Statistics WorldCalls::stream_impacts(const MeshView& mesh, const VertexView& end, TakeImpacts take,
                                      const Motion& question, const Streaming& how, std::stop_token stop) {
    const Shape shape = moving_shape(mesh, end);
    const Body body{.self = true};
    return stream_features({{&shape, 1}, {&body, 1}, {}, {}}, question, false, {how, take}, impacts, std::move(stop));
}
Statistics WorldCalls::stream_near(const MeshView& mesh, TakeNearby take, const Near& question, const Streaming& how,
                                   std::stop_token stop) {
    const Shape shape = with_radii_and_rest(host_shape(mesh), question);
    const Body body{.self = true};
    return stream_features({{&shape, 1}, {&body, 1}, {}, {}}, question, false, {how, take}, nearby, std::move(stop));
}
Statistics WorldCalls::stream_candidates(const MeshView& mesh, const VertexView* end, TakeCandidates take,
                                         const CandidateQuestion& question, const Streaming& how,
                                         std::stop_token stop) {
    const Shape shape = end ? moving_shape(mesh, *end) : host_shape(mesh);
    const Body body{.self = true};
    return stream_features({{&shape, 1}, {&body, 1}, {}, {}}, question, false, {how, take}, candidates,
                           std::move(stop));
}

const NearestBodies& WorldCalls::find_nearest(const World& world, const Nearest& question, std::stop_token stop) {
    Stopwatch watch;
    bool frugal = false;
    const auto attempt = [&] {
        check(working != Backend::cuda, "distances of bodies need the cpu backend (Options::backend)");
        check_question(question);
        check_bodies_have_triangles(world, question.rules, false, "distances of bodies are those of triangles");
        const PosedOnHost there(*backend, world);
        if (working == Backend::reference)
            find_nearest_by_brute_force(there.world(), question, meter, cancellation, nearest_bodies);
        else
            nearest.find(*backend, there.world(), question, frugal, nearest_bodies);
    };
    run(std::move(stop), attempt, [&](std::int64_t) { return frugal = true; });
    Statistics& statistics = nearest_bodies.statistics;
    statistics.pairs = static_cast<std::int64_t>(nearest_bodies.bodies.size());
    statistics.peak_memory_bytes = meter.peak;
    statistics.milliseconds = watch.lap();
    return nearest_bodies;
}

const Impacts& WorldCalls::find_impacts(const World& world, const Motion& question, std::stop_token stop) {
    return find_features(world, question, true, impacts, std::move(stop));
}
const Nearby& WorldCalls::find_near(const World& world, const Near& question, std::stop_token stop) {
    return find_features(world, question, true, nearby, std::move(stop));
}
const CandidateLists& WorldCalls::find_candidates(const World& world, const CandidateQuestion& question,
                                                  std::stop_token stop) {
    return find_features(world, question, true, candidates, std::move(stop));
}

// One mesh is a world of one body.
const Impacts& WorldCalls::find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question,
                                        std::stop_token stop) {
    return find_of_mesh(mesh, with_end(Shape(mesh), end), question, impacts, std::move(stop));
}
const Nearby& WorldCalls::find_near(const MeshView& mesh, const Near& question, std::stop_token stop) {
    return find_of_mesh(mesh, with_radii_and_rest(Shape(mesh), question), question, nearby, std::move(stop));
}
const CandidateLists& WorldCalls::find_candidates(const MeshView& mesh, const VertexView* end,
                                                  const CandidateQuestion& question, std::stop_token stop) {
    const Shape shape = end ? with_end(Shape(mesh), *end) : Shape(mesh);
    return find_of_mesh(mesh, shape, question, candidates, std::move(stop));
}
const Impacts& WorldCalls::find_impacts(const Part& part, const Motion& question, std::stop_token stop) {
    return find_features(part, question, impacts, std::move(stop));
}
const Nearby& WorldCalls::find_near(const Part& part, const Near& question, std::stop_token stop) {
    return find_features(part, question, nearby, std::move(stop));
}
std::vector<Part> WorldCalls::partition(const MeshView& mesh, const VertexView& end, const Motion& question, int count,
                                        std::stop_token stop) {
    return partition_shape(moving_shape(mesh, end), question, count, std::move(stop));
}
std::vector<Part> WorldCalls::partition(const MeshView& mesh, const Near& question, int count, std::stop_token stop) {
    return partition_shape(with_radii_and_rest(host_shape(mesh), question), question, count, std::move(stop));
}
Shape WorldCalls::with_radii_and_rest(Shape shape, const Near& question) {
    shape.radii = question.radii;
    shape.rest = question.rest;
    return shape;
}
Shape WorldCalls::host_shape(const MeshView& mesh) {
    if (mesh.memory != MemorySpace::host) refuse("blocks and parts of features are made of meshes in host memory");
    return Shape(mesh);
}
Shape WorldCalls::moving_shape(const MeshView& mesh, const VertexView& end) { return with_end(host_shape(mesh), end); }
Shape WorldCalls::with_end(Shape shape, const VertexView& end) {
    shape.end = end;
    if (!end.data && end.rows == 0 && shape.vertices.rows > 0) refuse("the vertices at the end are missing");
    if (shape.vertices.rows > most_moving_vertices) refuse(too_many_moving_vertices);
    return shape;
}
void WorldCalls::refuse(const char* message) {
    forget();
    throw Error(ErrorCode::invalid_argument, message, Element::option);
}

void WorldCalls::search(const World& world, const Intersect& question, const WorldBlocks* blocks) {
    check_bodies_have_triangles(world, question.rules, true, "only triangles intersect");
    if (!blocks && working == Backend::cuda && lies_on_device(world) && found_on_device(world, question)) return;
    const PosedOnHost there(*backend, world);
    if (working == Backend::reference)
        find_by_brute_force(there.world(), question, meter, cancellation, world_result, blocks);
    else
        worlds.find(*backend, there.world(), question, world_result, blocks);
}

// All worlds at once, or, where that is too much, not at all.
bool WorldCalls::found_on_device(const World& world, const Intersect& question) {
    check_device_poses(world);
    try {
        return backend->find(world, question, world_result);
    } catch (const MemoryMeter::Exceeded&) {
        backend->release();
        return false;
    }
}

Statistics WorldCalls::stream(const World& world, TakeWorldBlock take, const Intersect& question, const Streaming& how,
                              std::stop_token stop) {
    check_blocks(how);
    check(question.wants == Wants::pairs || question.wants == Wants::contacts, "blocks have pairs, or contacts");
    if (meter.limit > 0) forget();
    const WorldBlocks blocks{how, take};
    return find(world, question, std::move(stop), &blocks).statistics;
}

template const Impacts& WorldCalls::find_features(const World&, const Motion&, bool, Impacts&, std::stop_token);
template const Nearby& WorldCalls::find_features(const World&, const Near&, bool, Nearby&, std::stop_token);
template const CandidateLists& WorldCalls::find_features(const World&, const CandidateQuestion&, bool, CandidateLists&,
                                                         std::stop_token);

}  // namespace crumple
