// The cuda backend: brings scenes in and answers out, and keeps the callers' streams and ours in order.
//
// launch() gives a whole pass to the caller's stream and returns; wait() looks at the counters of the oldest launch, of
// two at most (flights.h). In a capture the pass becomes part of the caller's graph, and wait() looks at what its last
// replay has left.

#include "engine/backend.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "crumple/error.h"
#include "engine/cuda/candidate_finder.h"
#include "engine/cuda/device.h"
#include "engine/cuda/feature_finder.h"
#include "engine/cuda/flights.h"
#include "engine/cuda/host_mesh.h"
#include "engine/cuda/input.h"
#include "engine/cuda/search.h"
#include "engine/cuda/world_finder.h"
#include "engine/output.h"
#include "model/levels.h"
#include "model/part.h"

namespace crumple {
namespace cuda {
namespace {

class CudaBackend final : public BackendBase {
   public:
    CudaBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : meter_(meter),
          cancellation_(cancellation),
          device_(options.device),
          geometry_(device_.geometry()),
          search_(device_, geometry_, stream_.get(), options, meter, cancellation, flights_),
          worlds_(search_, stream_.get(), meter),
          features_there_(stream_.get(), meter),
          features_(device_, geometry_, stream_.get(), options, meter, cancellation, search_.lent_input(),
                    features_there_),
          candidates_(device_, geometry_, stream_.get(), options, meter, cancellation, search_.lent_input(),
                      features_there_) {
        reserve_stacks();
    }
    ~CudaBackend() override {
        try {
            flights_.finish();  // they write to what is freed now
        } catch (...) {         // the device has failed
        }
    }

    int worlds_at_once() const override { return max_leaves; }

    using BackendBase::find;  // what is refused stays in sight
    void find(const Scene& scene, const Query& query, const Part* part, Collisions& result) override {
        on_device(
            [&] {
                bring(scene);
                if (part)
                    find_owned(scene, query, Levels(part), result);
                else
                    find(query, result);
            },
            scene.worlds);
    }
    void find(const MeshView& a, const MeshView* b, const Query& query, Collisions& result) override {
        on_device([&] {
            view(a, b, query);
            find(query, result);
        });
    }

    void visit(const Scene& scene, const Query& query, BlockSink take, Statistics& statistics) override {
        Collisions all = metered(&meter_);
        find(scene, query, nullptr, all);
        statistics = all.statistics;
        take(all);
    }

    void find(const Scene& scene, const FeatureQuery& query, FeatureAnswer& answer) override {
        on_device([&] {
            finish();
            features_.find(scene, query, answer);
        });
    }

    void find_candidates(const Scene& scene, const CandidateQuery& query, CandidateAnswer& answer) override {
        on_device([&] {
            finish();
            candidates_.find(scene, query, answer);
        });
    }

    bool any(const Scene& scene, const Query& query) override {
        return on_device(
            [&] {
                bring(scene);
                return any(query);
            },
            scene.worlds);
    }
    void any_by_world(const Scene& scene, const Query& query, std::span<std::uint8_t> flags,
                      Statistics& statistics) override {
        if (scene.worlds == 1) return BackendBase::any_by_world(scene, query, flags, statistics);
        on_device(
            [&] {
                bring(scene);
                search_.adopt(query);
                search_.flag_worlds(flags);
                statistics = search_.statistics();
            },
            scene.worlds);
    }
    bool any(const MeshView& a, const MeshView* b, const Query& query) override {
        return on_device([&] {
            view(a, b, query);
            return any(query);
        });
    }

    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count) override {
        std::array<std::optional<HostMesh>, 2> host;
        on_device([&] {
            view(a, b, {});
            host[0].emplace(a, stream_.get());
            if (b) host[1].emplace(*b, stream_.get());
        });
        SceneBuffers buffers;
        return make_parts(prepare_scene(host[0]->view(), b ? &host[1]->view() : nullptr, false, *this, buffers), count,
                          *this);
    }

    std::int64_t bytes_needed(const Scene& scene, const Query& query, const Part*) override {
        return on_device([&] {
            bring(scene);
            return bytes_needed(query);
        });
    }
    std::int64_t bytes_needed(const MeshView& a, const MeshView* b, const Query& query) override {
        return on_device([&] {
            view(a, b, query);
            return bytes_needed(query);
        });
    }

    void launch(const MeshView& a, const MeshView* b, const Query& query) override {
        refuse_third();
        on_device([&] {
            const auto stream = static_cast<cudaStream_t>(a.stream);
            const auto other = b ? static_cast<cudaStream_t>(b->stream) : stream;
            launch(stream, other, query, "meshes of the same shape and the same query",
                   [&](auto slot, Room room) { search_.view(slot, a, b, query.weld, room); });
        });
    }

    bool find(const World& world, const Intersect& question, WorldCollisions& result) override {
        constexpr int several = 2;  // where they do not fit, fewer may
        return on_device(
            [&] {
                finish();
                wait_for_poses(world);
                return worlds_.find(world, question, *this, result);
            },
            several);
    }
    std::vector<Pose> poses_of(const World& world) override {
        return on_device([&] {
            finish();
            wait_for_poses(world);
            return to_host(stream_.get(), world.device_poses);
        });
    }
    void launch(const World& world, const Intersect& question) override {
        refuse_third();
        on_device([&] {
            const auto stream = static_cast<cudaStream_t>(world.device_poses.stream);
            launch(
                stream, stream, query_of(question), "the same bodies and the same question", [&](auto slot, Room room) {
                    const auto bodies = worlds_.bodies_of(world, question.rules, *this, room);
                    if (!bodies)
                        throw Error(ErrorCode::invalid_argument,
                                    "a launch takes at most 65535 worlds, and 16777216 triangles together");
                    search_.pose(slot, bodies, world.device_poses, question.weld, question.wants >= Wants::pairs, room);
                });
        });
    }

    const DeviceWorldCollisions& wait_worlds() override {
        if (state_ == State::captured) {
            if (!search_.input().posed())
                throw Error(ErrorCode::invalid_argument, "what was captured is about meshes: wait() tells of it");
            on_device([&] {
                shown_worlds() =
                    replay_is_complete("wait_worlds()") ? search_.show_worlds() : search_.show_incomplete_worlds();
            });
            return shown_worlds();
        }
        if (flights_.count() == 0) throw Error(ErrorCode::invalid_argument, "wait_worlds() needs a launch before it");
        if (!search_.input_of(flights_.oldest()).posed())
            throw Error(ErrorCode::invalid_argument, "the oldest launch is about meshes: wait() tells of it");
        try {
            constexpr int several = 2;
            on_device([&] { land(), shown_worlds() = search_.show_worlds(); }, several);
        } catch (const MemoryMeter::Exceeded&) {
            if (meter_.limit > 0) throw;
            throw Error(ErrorCode::device, "the device has no memory for all worlds at once");
        }
        return shown_worlds();
    }

    const DeviceCollisions& wait() override {
        if (state_ == State::captured) return wait_for_replay();
        if (flights_.count() == 0) throw Error(ErrorCode::invalid_argument, "wait() needs a launch before it");
        if (search_.input_of(flights_.oldest()).posed())
            throw Error(ErrorCode::invalid_argument, "the oldest launch is about worlds: wait_worlds() tells of it");
        on_device([&] { land(), shown() = search_.show(); });
        state_ = State::answered;
        return shown();
    }

    void download(Collisions& result) override {
        const bool told = state_ == State::answered || (state_ == State::captured && replayed_);
        if (!told || search_.input().posed())
            throw Error(ErrorCode::invalid_argument, "download() needs a wait() before it");
        if (!shown().complete) throw Error(ErrorCode::invalid_argument, "download() needs an answer that is complete");
        on_device([&] {
            search_.download(result);
            result.statistics = shown().statistics;
        });
    }

    void release() override {
        std::optional<Device::Current> current;
        try {
            current.emplace(device_);
            finish();
        } catch (const Error&) {
            state_ = State::idle;  // a device that has failed has nothing left to wait for
            flights_.forget();
        }
        search_.release();
        worlds_.release();
        features_.release();
        candidates_.release();
        features_there_.release();
    }

    std::int64_t bytes_needed_for_launched() override {
        return on_device([&] {
            search_.drop_lists();
            return search_.input().posed() ? bytes_needed_for_worlds() : bytes_needed();
        });
    }

    bool keeps_after(const Error& error) const override {
        if (state_ == State::refused) return true;
        const bool needed = state_ == State::captured || flights_.count() > 0;
        return needed && error.code != ErrorCode::memory_limit && error.code != ErrorCode::device;
    }

   private:
    void refuse_third() const {
        if (flights_.full())
            throw Error(ErrorCode::invalid_argument, "two launches are in flight: the next one comes after a wait()");
    }

    // view(slot, room) has a slot's input see what is asked about, which is ready on both streams; `same`: what has to
    // come again if a capture is to find its lists.
    template <class View>
    void launch(cudaStream_t stream, cudaStream_t other, const Query& query, const char* same, View view) {
        const auto first = capture_of(stream), second = other == stream ? first : capture_of(other);
        if (first || second) return launch_in_capture(stream, other, query, first == second, same, view);
        end_state();
        const bool again = search_.alone() && flights_.count() == 0;
        const std::size_t slot = again ? flights_.newest() : flights_.next();
        view(slot, Room::grows);
        search_.adopt(query);
        if (other != stream) order(before_, other, stream);
        flights_.queue(stream);
        search_.launch(stream);
        flights_.add(slot, stream);
    }

    // What the oldest launch has left, with all that only the host can do.
    void land() {
        end_state();
        search_.resume(flights_.land());
        if (!search_.accept_launched()) search_.find();
        search_.make_contacts();
    }

    // Nothing is allocated, freed, copied or waited for.
    template <class View>
    void launch_in_capture(cudaStream_t stream, cudaStream_t other, const Query& query, bool one, const char* same,
                           View view) {
        if (flights_.count() > 0)
            throw Error(ErrorCode::invalid_argument, "a launch in a capture comes after wait() for the one before");
        if (search_.capture_is_open())
            throw Error(ErrorCode::invalid_argument, "a detector's launches in a capture are one at most");
        state_ = State::refused;
        if (!one)
            throw Error(ErrorCode::invalid_argument, "the streams of two meshes take part in one capture, or in none");
        try {
            view(search_.current(), Room::fixed);
            search_.adopt(query, Room::fixed);
            if (other != stream) order(before_, other, stream);
            search_.capture(stream);
        } catch (const NoRoom&) {
            throw Error(ErrorCode::invalid_argument,
                        "a launch in a capture needs two calls before it, outside of the capture, with " +
                            std::string(same) + ": they make its lists");
        }
        replayed_ = false;
        state_ = State::captured;
    }

    // The stream that it was on is done, says the caller.
    const DeviceCollisions& wait_for_replay() {
        if (search_.input().posed())
            throw Error(ErrorCode::invalid_argument, "what was captured is about worlds: wait_worlds() tells of it");
        on_device([&] { shown() = replay_is_complete("wait()") ? search_.show() : search_.show_incomplete(); });
        return shown();
    }
    bool replay_is_complete(const char* call) {
        refuse_open_capture();
        if (!search_.has_replayed())
            throw Error(ErrorCode::invalid_argument,
                        std::string(call) + " needs a replay of the captured launch before it");
        replayed_ = false;
        const bool complete = search_.accept_replay();
        if (complete) search_.make_contacts();
        replayed_ = true;
        return complete;
    }

    void find(const Query& query, Collisions& result) {
        search_.adopt(query);
        search_.find();
        search_.copy_to(result);
        result.statistics = search_.statistics();
    }

    // Finds all pairs of the part's triangles, and leaves out those that a lower part owns.
    void find_owned(const Scene& scene, Query query, const Levels& levels, Collisions& result) {
        const bool contacts = std::exchange(query.contacts, false);
        find(query, result);
        keep_owned(scene, levels, result);
        if (!contacts) return;
        if (meter_.limit > 0) search_.drop_lists();
        result.statistics.rational_contacts = contacts_of_pairs(scene, result, [&](std::size_t n, auto task) {
            for (std::size_t i = 0; i < n; ++i) {
                cancellation_.check();
                task(i);
            }
        });
    }

    bool any(const Query& query) {
        search_.adopt(query);
        return search_.any();
    }

    std::int64_t bytes_needed(const Query& query) {
        search_.adopt(query);
        return bytes_needed();
    }

    std::int64_t bytes_needed() {
        meter_.peak = meter_.used.load();
        const auto pairs = static_cast<std::int64_t>(search_.count_in_chunks());
        const std::size_t room =
            Answer::bytes(search_.scene(), static_cast<std::size_t>(pairs), search_.query().contacts);
        return meter_.peak + static_cast<std::int64_t>(room) + result_bytes(search_.scene(), search_.query(), pairs);
    }

    // Worlds are found at once, or not at all.
    std::int64_t bytes_needed_for_worlds() {
        meter_.peak = meter_.used.load();
        search_.hope_again();
        search_.find();
        search_.make_contacts();
        return meter_.peak;
    }

    // Launches without work the kernels that keep data on their stacks. The driver keeps a stack for every thread that
    // the device can hold from the first launch on (docs/cuda.md): now, and not when lists have taken what memory there
    // is.
    void reserve_stacks() {
        const Device::Current current(device_);
        MemoryMeter unlimited;
        Block block(unlimited);
        Counters* counters = nullptr;
        lay_out(block, [&](Cutter& c) { counters = c.take<Counters>(1); });
        fill(stream_.get(), counters, 0, sizeof *counters);
        reserve_exact_stack(geometry_, stream_.get(), counters);
        reserve_contact_stack(geometry_, stream_.get());
        reserve_feature_stacks(geometry_, stream_.get(), counters);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
    }

    // Several worlds may fit if there are fewer of them.
    template <class Work>
    std::invoke_result_t<Work> on_device(Work work, int worlds = 1) {
        const Device::Current current(device_);
        try {
            return work();
        } catch (const OutOfDeviceMemory& error) {
            if (worlds > 1) throw MemoryMeter::Exceeded{};
            throw Error(ErrorCode::device, error.message());
        }
    }

    void bring(const Scene& scene) {
        finish();
        search_.bring(scene);
    }
    // Work of ours begins after what the callers' streams were given.
    void view(const MeshView& a, const MeshView* b, const Query& query) {
        finish();
        refuse_captured(a, b);
        order(before_, static_cast<cudaStream_t>(a.stream), stream_.get());
        if (b) order(before_, static_cast<cudaStream_t>(b->stream), stream_.get());
        search_.view(search_.current(), a, b, query.weld);
    }
    void wait_for_poses(const World& world) {
        const auto stream = static_cast<cudaStream_t>(world.device_poses.stream);
        if (capture_of(stream) != 0)
            throw Error(ErrorCode::invalid_argument, "the poses' stream is being captured, and cannot be waited for");
        order(before_, stream, stream_.get());
    }
    // We wait for the streams, which a capture forbids, and would spoil it.
    static void refuse_captured(const MeshView& a, const MeshView* b) {
        for (const MeshView* mesh : {&a, b})
            if (mesh && capture_of(static_cast<cudaStream_t>(mesh->stream)) != 0)
                throw Error(ErrorCode::invalid_argument, "a mesh's stream is being captured, and cannot be waited for");
    }
    // Streams of ours take part in it, and what they are given now would, too.
    void refuse_open_capture() const {
        if (search_.capture_is_open())
            throw Error(ErrorCode::invalid_argument, "the capture that a launch was put into has not ended");
    }
    // A launch in a capture ends here, and so does download().
    void end_state() {
        if (state_ == State::captured) refuse_open_capture();
        state_ = State::idle;
    }
    // Launches that nobody waited for are over before their memory is used again.
    void finish() {
        end_state();
        flights_.finish();
    }
    DeviceCollisions& shown() { return shown_[search_.current()]; }
    DeviceWorldCollisions& shown_worlds() { return shown_worlds_[search_.current()]; }

    enum class State : std::uint8_t {
        idle,
        answered,  ///< by wait(), and no call came after that
        captured,  ///< a pass is in a caller's graph, and its memory stays
        refused,   ///< a launch in a capture, which nothing may be freed in
    };

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    Device device_;
    Geometry geometry_;
    Stream stream_ = make_stream(device_);
    Event before_ = make_event(device_);
    Flights flights_{device_};
    Search search_;
    WorldFinder worlds_;
    FeaturesOnDevice features_there_;
    FeatureFinder features_;
    CandidateFinder candidates_;
    State state_ = State::idle;
    bool replayed_ = false;                               ///< since the capture: wait() has told of it
    std::array<DeviceCollisions, Flights::slots> shown_;  ///< by slot
    std::array<DeviceWorldCollisions, Flights::slots> shown_worlds_;
};

}  // namespace
}  // namespace cuda

std::unique_ptr<BackendBase> make_cuda_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation) {
    try {
        return std::make_unique<cuda::CudaBackend>(options, meter, cancellation);
    } catch (const cuda::OutOfDeviceMemory& error) {
        throw Error(ErrorCode::backend_unavailable,
                    "the cuda backend is not available: device " + std::to_string(options.device) +
                        " has no memory left for it (" + error.message() + ")",
                    Element::option);
    }
}

}  // namespace crumple
