// A detector's calls about the features of one mesh, on the host or in device memory.

#include <utility>

#include "detector/world_calls.h"

namespace crumple {
namespace {

void tell(const DeviceRows& rows, DeviceImpactList& list) { list = {rows.count, rows.pairs, rows.value, rows.flag}; }
void tell(const DeviceRows& rows, DeviceNearList& list) { list = {rows.count, rows.pairs, rows.value, rows.flag}; }
void tell(const DeviceRows& rows, DeviceCandidateList& list) { list = {rows.count, rows.pairs}; }

template <class Answer>
void tell(const DeviceAnswer& found, Answer& answer) {
    static_cast<DeviceFeatures&>(answer) = found;
    for (std::size_t k = 0; k < answer.lists.size(); ++k) tell(found.rows[k], answer.lists[k]);
}

}  // namespace

template <class Question, class Answer>
const Answer& WorldCalls::find_there(const DeviceShape& mesh, const Question& question, Answer& answer,
                                     std::stop_token stop) {
    return answered(answer, std::move(stop), [&](bool frugal) {
        check_question(question, false);
        check_groups(question.rules, mesh.shape.triangles.rows, !mesh.shape.groups.empty());
        features.find_there(*backend, mesh, question, frugal, answer);
    });
}

template <class Question, class Answer>
const Answer& WorldCalls::find_of_mesh(const MeshView& mesh, const Shape& shape, const Question& question,
                                       Answer& answer, std::stop_token stop) {
    const Body body{.self = true};
    const auto find_here = [&](const Shape& here) -> const Answer& {
        return find_features({{&here, 1}, {&body, 1}, {}, {}}, question, false, answer, std::move(stop));
    };
    if (mesh.memory == MemorySpace::host) return find_here(shape);
    const DeviceShape there{shape, mesh.stream};
    if (FeatureSearch::answers_there(shape, question)) return find_there(there, question, answer, std::move(stop));
    HostShape copy;
    copy_to_host(there, copy);
    return find_here(copy.shape);
}

void WorldCalls::copy_to_host(const DeviceShape& mesh, HostShape& copy) {
    run(
        {}, [&] { backend->features_there().copy_to_host(mesh, Copied::all, copy); },
        [](std::int64_t) { return false; });
}
void WorldCalls::copy_to_host(const MeshView& mesh, const VertexView& end, HostShape& copy) {
    copy_to_host({with_end(Shape(mesh), end), mesh.stream}, copy);
}

template <class Question>
void WorldCalls::launch(const MeshView& mesh, const Shape& shape, const Question& question) {
    cancellation.begin({});
    kept_before_launch = meter.used;
    const DeviceShape there{shape, mesh.stream};
    run_launched([&] {
        check_question(question, false);
        check_groups(question.rules, shape.triangles.rows, !shape.groups.empty());
        check(mesh.memory != MemorySpace::host, "launches take meshes in device memory");
        features.launch(*backend, there, question);
    });
}

void WorldCalls::launch_impacts(const MeshView& mesh, const VertexView& end, const Motion& question) {
    launch(mesh, with_end(Shape(mesh), end), question);
}
void WorldCalls::launch_near(const MeshView& mesh, const Near& question) {
    launch(mesh, with_radii_and_rest(Shape(mesh), question), question);
}
void WorldCalls::launch_candidates(const MeshView& mesh, const VertexView* end, const CandidateQuestion& question) {
    launch(mesh, end ? with_end(Shape(mesh), *end) : Shape(mesh), question);
}

DeviceAnswer WorldCalls::wait_for(Asked asked, std::stop_token stop) {
    DeviceAnswer answer;
    cancellation.begin(std::move(stop));
    run_launched([&] {
        cancellation.check();
        answer = features.wait(*backend, asked);
    });
    return answer;
}
const DeviceImpacts& WorldCalls::wait_impacts(std::stop_token stop) {
    const DeviceAnswer answer = wait_for(Asked::impacts, std::move(stop));
    tell(answer, impacts_there_);
    impacts_there_.any = answer.any;
    impacts_there_.first = answer.first;
    return impacts_there_;
}
const DeviceNearby& WorldCalls::wait_near(std::stop_token stop) {
    const DeviceAnswer answer = wait_for(Asked::near, std::move(stop));
    tell(answer, nearby_there_);
    nearby_there_.any = answer.any;
    return nearby_there_;
}
const DeviceCandidates& WorldCalls::wait_candidates(std::stop_token stop) {
    tell(wait_for(Asked::candidates, std::move(stop)), candidates_there_);
    return candidates_there_;
}

template const Impacts& WorldCalls::find_of_mesh(const MeshView&, const Shape&, const Motion&, Impacts&,
                                                 std::stop_token);
template const Nearby& WorldCalls::find_of_mesh(const MeshView&, const Shape&, const Near&, Nearby&, std::stop_token);
template const CandidateLists& WorldCalls::find_of_mesh(const MeshView&, const Shape&, const CandidateQuestion&,
                                                        CandidateLists&, std::stop_token);

}  // namespace crumple
