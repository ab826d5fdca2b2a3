#pragma once

// One rank's engine: answers about one part after another, under the rank's memory limit.

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <utility>

#include "crumple/part.h"
#include "detector/detector_state.h"

namespace crumple::distribute {

class PartSearch : private DetectorState {
   public:
    explicit PartSearch(const Options& options) : DetectorState(options) {}

    /// The pairs that the part owns, by place in it. Valid until the next call. `memory`: the part's own.
    const Intersections& find(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                              std::stop_token stop);
    /// Whether there is a pair among the part's triangles.
    bool any(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
             std::stop_token stop);

    /// What the part owns of questions about features, by its ids. Valid until the next call.
    const Impacts& find(const Part& part, const ImpactQuery& question, std::unique_ptr<SceneMemory>& memory,
                        std::stop_token stop);
    const Proximities& find(const Part& part, const ProximityQuery& question, std::unique_ptr<SceneMemory>& memory,
                            std::stop_token stop);

    /// Called as Detector::set_poll's is.
    void set_poll(std::function<void()> poll) { cancellation.set_poll(std::move(poll)); }

    ParallelFor& workers() { return *backend; }
    /// Throws Error where the backend is not cuda.
    void copy_to_host(const DeviceShape& there, HostShape& here) {
        backend->features_there().copy_to_host(there, Copied::all, here);
    }
    MemoryMeter& memory() { return meter; }
    void release() { forget(); }

   private:
    template <class Question, class Answer>
    const Answer& find_features(const Part& part, const Question& question, std::unique_ptr<SceneMemory>& memory,
                                std::stop_token stop, Answer& answer);
    template <class Work>
    void guarded(const Part& part, const IntersectionQuery& query, std::unique_ptr<SceneMemory>& memory,
                 std::stop_token stop, Work work);
};

}  // namespace crumple::distribute
