#pragma once

// crumple::Detector for Python: releases the GIL, runs the calls of several threads one at a time, and makes results
// that outlive the detector.

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
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

    /// Exclusive use of the detector during a call; its constructor waits for the calls of other threads. Construct and
    /// destroy it with the GIL. As long as no other thread waits, it takes no lock besides the GIL.
    class Turn {
       public:
        explicit Turn(SharedDetector& detector);
        ~Turn();
        Turn(const Turn&) = delete;
        Turn& operator=(const Turn&) = delete;

       private:
        SharedDetector& detector_;
    };

    /// Runs a query. Call find() and the functions up to call() while a Turn exists, without the GIL. In the main
    /// thread, Python's signal handlers run while a call runs or waits; an exception from a handler ends the call.
    ///
    /// `result` comes from storage(). It is swapped into the detector, which fills it, and swapped back, so it outlives
    /// the detector and the next call.
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
    Clustering cluster(const Scene& scene) { return detector_.cluster(scene, stop_->get_token()); }
    /// Combines the results of all parts; `result` as in find().
    void combine(const Scene& scene, const OverlapQuery& query, std::span<const Overlaps> parts, Overlaps& result) {
        detector_.swap_result(result);
        detector_.combine(scene, query, parts, stop_->get_token());
        detector_.swap_result(result);
    }
    /// Returns the result of stream(detector, sink, stop), which must call `sink` for each block. `sink` calls `take`
    /// with the GIL, in whichever thread of the library calls it. While `take` runs, calls of the detector from this
    /// thread are refused, as are those from the thread of the call.
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
    /// Returns the result of work(detector, stop), where `stop` is the stop token of the current Turn.
    template <class Work>
    auto call(Work work) {
        return work(detector_, stop_->get_token());
    }
    /// Keeps the arguments of a launch alive until the second launch after it. Call with the GIL.
    void keep(std::shared_ptr<void> given) {
        std::swap(launched_[0], launched_[1]);
        launched_[0] = std::move(given);
    }
    /// Returns storage for a result. Reuses the storage of one of the last two results, if Python no longer uses that
    /// result. So a simulation whose frames replace each other's results alternates between two and allocates nothing.
    /// Under a memory limit, storage is never reused. Call with the GIL, which also guards the release of results.
    template <class Result>
    std::shared_ptr<Result> storage() {
        return std::get<Two<Result>>(results_).get(options().memory_limit > 0);
    }
    /// Return the buffers for copies of poses that cannot be read in place. Use them only while a Turn exists.
    std::vector<Pose>& poses() { return poses_; }
    std::vector<Pose>& end_poses() { return end_poses_; }
    const Options& options() const { return detector_.options(); }
    Backend backend() const { return detector_.backend(); }
    std::string_view fallback() const { return detector_.fallback(); }

    /// Ends the call in progress. Calls that wait for it are not ended. Call with the GIL.
    void cancel() {
        if (stop_) stop_->request_stop();
    }
    const std::stop_source& stop() const { return *stop_; }

   private:
    /// Storage of the last two results, for reuse.
    template <class Result>
    class Two {
       public:
        std::shared_ptr<Result> get(bool limited) {
            if (limited) return std::make_shared<Result>();
            if (last_.use_count() != 1) std::swap(last_, before_);
            if (last_.use_count() != 1) last_ = std::make_shared<Result>();
            return last_;
        }

       private:
        std::shared_ptr<Result> last_, before_;
    };

    void wait_for_another_call();

    Detector detector_;
    std::tuple<Two<Intersections>, Two<Impacts>, Two<Proximities>, Two<Candidates>, Two<Distances>, Two<Overlaps>>
        results_;
    std::vector<Pose> poses_, end_poses_;
    std::shared_ptr<void> launched_[2];
    std::optional<std::stop_source> stop_;  ///< stop source of the current Turn, or of the last one
    std::thread::id caller_;  ///< thread of the current Turn; the GIL guards it, and also `stop_` and `waiting_`
    int waiting_ = 0;
    std::uint64_t calls_done_ = 0;  ///< number of Turns that ended while threads waited; guarded by mutex_
    std::mutex mutex_;
    std::condition_variable call_done_;
};

/// Returns the detector that a method is called on. Throws Error if it was not constructed, because a subclass did not
/// call __init__.
SharedDetector& detector_of(nanobind::handle self);

/// Throws Error unless `device`, the place of an array, is the host or the detector's CUDA device.
void check_device(const SharedDetector& detector, int device);

void bind_detector(nanobind::module_& module);

}  // namespace crumple::python
