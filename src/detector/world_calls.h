#pragma once

// A detector's calls on worlds of bodies; one mesh in motion, or at rest for nearness and candidates, is a world of one
// body.

#include <utility>

#include "base/stopwatch.h"
#include "crumple/detector.h"
#include "detector/detector_state.h"

namespace crumple {

struct WorldCalls : DetectorState {
    using DetectorState::DetectorState;
    using TakeWorldBlock = Detector::TakeWorldBlock;
    using TakeImpacts = Detector::TakeImpacts;
    using TakeNearby = Detector::TakeNearby;
    using TakeCandidates = Detector::TakeCandidates;

    const WorldCollisions& find(const World& world, const Intersect& question, std::stop_token stop,
                                const WorldBlocks* blocks = nullptr);
    Statistics stream(const World& world, TakeWorldBlock take, const Intersect& question, const Streaming& how,
                      std::stop_token stop);
    const NearestBodies& find_nearest(const World& world, const Nearest& question, std::stop_token stop);

    const Impacts& find_impacts(const World& world, const Motion& question, std::stop_token stop);
    const Impacts& find_impacts(const MeshView& mesh, const VertexView& end, const Motion& question,
                                std::stop_token stop);
    const Nearby& find_near(const World& world, const Near& question, std::stop_token stop);
    const Nearby& find_near(const MeshView& mesh, const Near& question, std::stop_token stop);
    const CandidateLists& find_candidates(const World& world, const CandidateQuestion& question, std::stop_token stop);
    std::vector<Part> partition(const MeshView& mesh, const VertexView& end, const Motion& question, int count,
                                std::stop_token stop);
    std::vector<Part> partition(const MeshView& mesh, const Near& question, int count, std::stop_token stop);
    const Impacts& find_impacts(const Part& part, const Motion& question, std::stop_token stop);
    const Nearby& find_near(const Part& part, const Near& question, std::stop_token stop);

    /// `end`: null at rest.
    const CandidateLists& find_candidates(const MeshView& mesh, const VertexView* end,
                                          const CandidateQuestion& question, std::stop_token stop);

    // On a mesh in device memory:
    void copy_to_host(const MeshView& mesh, const VertexView& end, HostShape& copy);
    void launch_impacts(const MeshView& mesh, const VertexView& end, const Motion& question);
    void launch_near(const MeshView& mesh, const Near& question);
    /// `end`: null at rest.
    void launch_candidates(const MeshView& mesh, const VertexView* end, const CandidateQuestion& question);
    const DeviceImpacts& wait_impacts(std::stop_token stop);
    const DeviceNearby& wait_near(std::stop_token stop);
    const DeviceCandidates& wait_candidates(std::stop_token stop);

    Statistics stream_impacts(const World& world, TakeImpacts take, const Motion& question, const Streaming& how,
                              std::stop_token stop);
    Statistics stream_impacts(const MeshView& mesh, const VertexView& end, TakeImpacts take, const Motion& question,
                              const Streaming& how, std::stop_token stop);
    Statistics stream_near(const World& world, TakeNearby take, const Near& question, const Streaming& how,
                           std::stop_token stop);
    Statistics stream_near(const MeshView& mesh, TakeNearby take, const Near& question, const Streaming& how,
                           std::stop_token stop);
    Statistics stream_candidates(const World& world, TakeCandidates take, const CandidateQuestion& question,
                                 const Streaming& how, std::stop_token stop);
    /// `end`: null at rest.
    Statistics stream_candidates(const MeshView& mesh, const VertexView* end, TakeCandidates take,
                                 const CandidateQuestion& question, const Streaming& how, std::stop_token stop);

   private:
    void search(const World& world, const Intersect& question, const WorldBlocks* blocks);
    bool found_on_device(const World& world, const Intersect& question);
    /// `bodies`: whether the answer names bodies.
    template <class Question, class Answer>
    const Answer& find_features(const World& world, const Question& question, bool bodies, Answer& answer,
                                std::stop_token stop);
    template <class Question>
    std::vector<Part> partition_shape(const Shape& shape, const Question& question, int count, std::stop_token stop);
    template <class Question, class Answer>
    const Answer& find_features(const Part& part, const Question& question, Answer& answer, std::stop_token stop);
    template <class Question, class Answer>
    Statistics stream_features(const World& world, const Question& question, bool bodies,
                               const FeatureBlocks<Answer>& blocks, Answer& answer, std::stop_token stop);
    /// Has search(frugal) make the answer, under the limit. What several workers need depends on who does what, so it
    /// cannot be promised: the second try is frugal.
    template <class Answer, class Search>
    const Answer& answered(Answer& answer, std::stop_token stop, Search search) {
        Stopwatch watch;
        bool frugal = false;
        const auto attempt = [&] { search(frugal); };
        run(std::move(stop), attempt, [&](std::int64_t) { return frugal = true; });
        answer.statistics.peak_memory_bytes = meter.peak;
        answer.statistics.milliseconds = watch.lap();
        return answer;
    }
    /// Of one mesh, wherever it lies.
    template <class Question, class Answer>
    const Answer& find_of_mesh(const MeshView& mesh, const Shape& shape, const Question& question, Answer& answer,
                               std::stop_token stop);
    template <class Question, class Answer>
    const Answer& find_there(const DeviceShape& mesh, const Question& question, Answer& answer, std::stop_token stop);
    template <class Question>
    void launch(const MeshView& mesh, const Shape& shape, const Question& question);
    void copy_to_host(const DeviceShape& mesh, HostShape& copy);
    DeviceAnswer wait_for(Asked asked, std::stop_token stop);
    static Shape with_radii_and_rest(Shape shape, const Near& question);
    Shape host_shape(const MeshView& mesh);
    Shape moving_shape(const MeshView& mesh, const VertexView& end);
    /// An Error, unless there is an end and it can be numbered.
    Shape with_end(Shape shape, const VertexView& end);
    [[noreturn]] void refuse(const char* message);

    DeviceImpacts impacts_there_;
    DeviceNearby nearby_there_;
    DeviceCandidates candidates_there_;
};

}  // namespace crumple
