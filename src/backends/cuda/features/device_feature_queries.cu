#include "backends/cuda/features/device_feature_queries.h"

#include "backends/cuda/input/host_shape.h"
#include "crumple/error.h"
#include "results/owned_features.h"

namespace crumple::cuda {
namespace {

Asked asked(const FeatureRequest& query) { return query.motion ? Asked::impacts : Asked::near; }

}  // namespace

FeatureCalls::FeatureCalls(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
                           MemoryMeter& meter, Cancellation& cancellation, Turns& turns,
                           const std::array<Input*, Flights::slots>& inputs)
    : device_(device),
      stream_(stream),
      turns_(turns),
      before_(make_event(device)),
      features_there_(stream, meter, turns.flights),
      features_(device, geometry, stream, options, meter, cancellation, turns.flights, inputs, features_there_),
      candidates_(device, geometry, stream, options, meter, cancellation, turns.flights, inputs, features_there_) {}

void FeatureCalls::release() {
    features_.release();
    candidates_.release();
    features_there_.release();
}

template <class Finder, class Query, class Answer>
void FeatureCalls::find_of_scene(Finder& finder, const PreparedScene& scene, const Query& query, Answer& answer) {
    with_device(device_, [&] {
        turns_.finish();
        clear(answer);
        answer.statistics.backend = "cuda";
        if (scene.triangle_count() == 0) return;  // lists have a least size, which no limit need hold for nothing
        finder.bring(finder.current(), scene, query);
        finder.find();
        finder.copy_to(answer);
    });
}
// Of a part all pairs are found, and those that another part owns are left out.
void FeatureCalls::find(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer) {
    if (!query.part) return find_of_scene(features_, scene, query, answer);
    FeatureRequest all = query;
    all.part = nullptr;
    all.extent = Extent::all;
    find_of_scene(features_, scene, all, answer);
    keep_owned(scene, query, answer);
}
void FeatureCalls::find(const PreparedScene& scene, const CandidateRequest& query, CandidateAnswer& answer) {
    find_of_scene(candidates_, scene, query, answer);
}

bool FeatureCalls::is_captured(const DeviceShape& mesh) {
    return with_device(device_, [&] { return capture_of(static_cast<cudaStream_t>(mesh.stream)) != 0; });
}

// We wait for the stream, which a capture forbids, and would spoil it.
void FeatureCalls::follow(const DeviceShape& mesh) {
    const auto stream = static_cast<cudaStream_t>(mesh.stream);
    if (capture_of(stream) != 0)
        throw Error(ErrorCode::invalid_argument, "a mesh's stream is being captured, and cannot be waited for");
    order(before_, stream, stream_);
}

void FeatureCalls::copy_to_host(const DeviceShape& mesh, Copied what, HostShape& host) {
    with_device(device_, [&] {
        Places(device_.index()).check(mesh.shape);
        follow(mesh);
        cuda::copy_to_host(mesh.shape, what, stream_, host);
    });
}

template <class Finder, class Query, class Answer>
bool FeatureCalls::find_of_mesh(Finder& finder, const DeviceShape& mesh, const Query& query, Answer& answer) {
    return with_device(device_, [&] {
        turns_.finish();
        clear(answer);
        follow(mesh);
        try {
            finder.view(finder.current(), mesh.shape, query);
            finder.find();
        } catch (const MeshChanged&) {
            return false;
        }
        finder.copy_to(answer);
        return true;
    });
}
bool FeatureCalls::find(const DeviceShape& mesh, const FeatureRequest& query, FeatureAnswer& answer) {
    return find_of_mesh(features_, mesh, query, answer);
}
bool FeatureCalls::find(const DeviceShape& mesh, const CandidateRequest& query, CandidateAnswer& answer) {
    return find_of_mesh(candidates_, mesh, query, answer);
}

template <class Finder, class Query>
std::size_t FeatureCalls::launch_with(Finder& finder, Asked question, const DeviceShape& mesh, const Query& query) {
    const auto stream = static_cast<cudaStream_t>(mesh.stream);
    with_device(device_, [&] {
        turns_.refuse_third();
        if (capture_of(stream) != 0) {
            turns_.launch_in_capture(question, true, [&] {
                finder.view(finder.current(), mesh.shape, query, Room::fixed);
                finder.capture(stream);
            });
            return;
        }
        turns_.launch(
            question, stream, finder.alone(), [&](std::size_t slot) { finder.view(slot, mesh.shape, query); },
            [&] { finder.launch(stream); });
    });
    return finder.current();
}
std::size_t FeatureCalls::launch(const DeviceShape& mesh, const FeatureRequest& query) {
    return launch_with(features_, asked(query), mesh, query);
}
std::size_t FeatureCalls::launch(const DeviceShape& mesh, const CandidateRequest& query) {
    return launch_with(candidates_, Asked::candidates, mesh, query);
}

template <class Finder>
FeatureCalls::Landed FeatureCalls::wait_with(Finder& finder, Asked question) {
    return with_device(device_, [&]() -> Landed {
        if (turns_.waits_for_replay(question)) {
            turns_.begin_replay(question, finder.has_replayed());
            const bool complete = finder.accept_replay();
            DeviceAnswer answer = complete ? finder.show() : finder.show_incomplete();
            turns_.replayed = true;
            return {finder.current(), std::move(answer)};
        }
        turns_.refuse_other(question);
        turns_.end_state();
        finder.resume(turns_.flights.land());
        const std::size_t slot = finder.current();
        try {
            if (!finder.accept_launched(features_there_.known().revision)) return {slot, {}};
        } catch (const MeshChanged&) {
            return {slot, {}};
        }
        turns_.answer(question);
        return {slot, finder.show()};
    });
}
FeatureCalls::Landed FeatureCalls::wait(Asked question) {
    return question == Asked::candidates ? wait_with(candidates_, question) : wait_with(features_, question);
}

template <class Finder, class Query>
std::optional<DeviceAnswer> FeatureCalls::again_with(Finder& finder, Asked question, std::size_t slot,
                                                     const DeviceShape& mesh, const Query& query) {
    return with_device(device_, [&]() -> std::optional<DeviceAnswer> {
        try {
            follow(mesh);
            finder.view(slot, mesh.shape, query);
            finder.find();
        } catch (const MeshChanged&) {
            return {};
        }
        turns_.answer(question);
        return finder.show();
    });
}
std::optional<DeviceAnswer> FeatureCalls::find_again(std::size_t slot, const DeviceShape& mesh,
                                                     const FeatureRequest& query) {
    return again_with(features_, asked(query), slot, mesh, query);
}
std::optional<DeviceAnswer> FeatureCalls::find_again(std::size_t slot, const DeviceShape& mesh,
                                                     const CandidateRequest& query) {
    return again_with(candidates_, Asked::candidates, slot, mesh, query);
}

}  // namespace crumple::cuda
