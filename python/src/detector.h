#pragma once

// crumple::Detector for Python: the GIL released, calls from several threads one after another, results that outlive
// it.

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>

#include "crumple/detector.h"
#include "gil.h"

namespace crumple::python {

class SharedDetector {
   public:
    explicit SharedDetector(const Options& options);

    /// Calls take turns. Comes and goes with the GIL, which is all that it costs while nobody waits.
    class Turn {
       public:
        explicit Turn(SharedDetector& detector);
        ~Turn();
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

       private:
        SharedDetector& detector_;
    };

    /// Call in a turn of one's own, without the GIL. In the main thread, signals are handled while a call runs or waits
    /// for its turn; what their handlers raise ends the call. `result` is storage, as `storage` gives it: it moves in
    /// and comes back, and outlives the detector and its next call.
    template <class Query>
    void find(const Scene& scene, const Query& query, typename Query::Result& result) {
        detector_.swap_result(result);
        detector_.find(scene, query, stop_->get_token());
        detector_.swap_result(result);
    }
    template <class Query>
    typename Query::Result find(const Scene& scene, const Query& query) {
        return detector_.find(scene, query, stop_->get_token());
    }
    template <class Query>
    bool any(const Scene& scene, const Query& query) {
        return detector_.any(scene, query, stop_->get_token());
    }
    template <class Query>
    std::vector<Part> partition(const Scene& scene, const Query& query, int count) {
        return detector_.partition(scene, query, count, stop_->get_token());
    }
    /// What stream(detector, sink, stop) gives, whose sink takes each block by `take`, with the GIL, in any thread of
    /// the library. That may be another thread than the one whose turn it is; it is refused a call all the same.
    template <class Block, class Stream>
    Statistics stream(FunctionRef<void(const Block&)> take, Stream stream) {
        const auto with_gil = [&](const Block& block) {
            const WithGil acquired;
            const std::thread::id caller = std::exchange(caller_, std::this_thread::get_id());
            struct Back {
                std::thread::id& caller_;
                std::thread::id caller;
                ~Back() { caller_ = caller; }
            } const back{caller_, caller};
            take(block);
        };
        return stream(detector_, with_gil, stop_->get_token());
    }
    /// Calls work(detector, stop).
    template <class Work>
    auto call(Work work) {
        return work(detector_, stop_->get_token());
    }
    /// Keeps what a launch is given until the second launch after it. Call with the GIL.
    void keep(std::shared_ptr<void> given) {
        std::swap(launched_[0], launched_[1]);
        launched_[0] = std::move(given);
    }
    /// Storage for an answer: that of one of the last two, if nobody holds it any more. So frames of a simulation go
    /// back and forth between two and allocate nothing. Under a memory limit none is kept. Call with the GIL, under
    /// which results come and go.
    template <class Answer>
    std::shared_ptr<Answer> storage() {
        return std::get<Two<Answer>>(answers_).get(options().memory_limit > 0);
    }
    /// For poses that cannot be read in place. In a turn of one's own.
    std::vector<Pose>& poses() { return poses_; }
    std::vector<Pose>& end_poses() { return end_poses_; }
    const Options& options() const { return detector_.options(); }
    Backend backend() const { return detector_.backend(); }
    std::string_view fallback() const { return detector_.fallback(); }

    /// Ends the call whose turn it is; one that waits for its turn goes on waiting. Call with the GIL.
    void cancel() {
        if (stop_) stop_->request_stop();
    }
    const std::stop_source& stop() const { return *stop_; }

   private:
    /// The last two answers, of which one may be free.
    template <class Answer>
    class Two {
       public:
        std::shared_ptr<Answer> get(bool limited) {
            if (limited) return std::make_shared<Answer>();
            if (last_.use_count() != 1) std::swap(last_, before_);
            if (last_.use_count() != 1) last_ = std::make_shared<Answer>();
            return last_;
        }

       private:
        std::shared_ptr<Answer> last_, before_;
    };

    void wait_for_another_turn();

    Detector detector_;
    std::tuple<Two<Intersections>, Two<Impacts>, Two<Proximities>, Two<Candidates>, Two<Distances>, Two<Overlaps>>
        answers_;
    std::vector<Pose> poses_, end_poses_;
    std::shared_ptr<void> launched_[2];
    std::optional<std::stop_source> stop_;  ///< of the turn; each has its own
    std::thread::id caller_;                ///< whose turn it is; guarded by the GIL, as `stop_` and `waiting_` are
    int waiting_ = 0;
    std::uint64_t turns_ = 0;  ///< that ended while somebody waited; guarded by the mutex
    std::mutex mutex_;
    std::condition_variable turn_ended_;
};

/// The detector that a method is called on. A class of Python may leave it without what __init__ makes.
SharedDetector& detector_of(nanobind::handle self);

/// Refuses arrays that do not lie on the host, or on the device that the detector works on.
void check_device(const SharedDetector& detector, int device);

void bind_detector(nanobind::module_& module);

}  // namespace crumple::python
