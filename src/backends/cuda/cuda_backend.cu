// The cuda backend: brings scenes in and answers out, and keeps the callers' streams and ours in order.
//
// launch() gives a whole pass to the caller's stream and returns; wait() looks at the counters of the oldest launch, of
// two at most (flights.h). In a capture the pass becomes part of the caller's graph, and wait() looks at what its last
// replay has left.

#include "backends/backend.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/turns.h"
#include "backends/cuda/features/device_feature_queries.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/input/host_shape.h"
#include "backends/cuda/intersections/intersection_search.h"
#include "backends/cuda/intersections/world_finder.h"
#include "backends/cuda/known_answers.h"
#include "crumple/error.h"
#include "partition/levels.h"
#include "partition/parts_of_scene.h"
#include "results/intersection_output.h"

namespace crumple {
namespace cuda {
namespace {

class CudaBackend final : public BackendBase {
   public:
    CudaBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          meter_(meter),
          cancellation_(cancellation),
          device_(options.device),
          geometry_(device_.geometry()),
          search_(device_, geometry_, stream_.get(), options_, meter, cancellation, turns_.flights),
          worlds_(search_, stream_.get(), meter),
          features_(device_, geometry_, stream_.get(), options_, meter, cancellation, turns_, search_.inputs()) {
        reserve_stacks();
        check_known_answers(device_, stream_.get());
    }
    ~CudaBackend() override {
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);  // waiting would spoil captures
        try {
            turns_.flights.finish();  // they write to what is freed now
        } catch (...) {               // the device has failed
        }
    }

    int worlds_at_once() const override { return max_leaves; }

    using BackendBase::find;  // what is refused stays in sight
    void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
              Intersections& result) override {
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
    void find(const MeshView& a, const MeshView* b, const IntersectionQuery& query, Intersections& result) override {
        on_device([&] {
            view(a, b, query);
            find(query, result);
        });
    }

    void visit(const PreparedScene& scene, const IntersectionQuery& query,
               FunctionRef<void(const Array<Pair>& some)> take, Statistics& statistics) override {
        Intersections all = metered(&meter_);
        find(scene, query, nullptr, all);
        statistics = all.statistics;
        take(all.pairs);
    }

    void find(const PreparedScene& scene, const FeatureRequest& query, FeatureAnswer& answer) override {
        features_.find(scene, query, answer);
    }
    void find(const PreparedScene& scene, const CandidateRequest& query, CandidateAnswer& answer) override {
        features_.find(scene, query, answer);
    }
    DeviceFeatureCalls& features_there() override { return features_; }

    bool any(const PreparedScene& scene, const IntersectionQuery& query) override {
        return on_device(
            [&] {
                bring(scene);
                return any(query);
            },
            scene.worlds);
    }
    void any_by_world(const PreparedScene& scene, const IntersectionQuery& query, std::span<std::uint8_t> flags,
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
    bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query) override {
        return on_device([&] {
            view(a, b, query);
            return any(query);
        });
    }

    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count) override {
        HostShape host[2];
        on_device([&] {
            view(a, b, {});
            copy_to_host(Shape(a), Copied::all, stream_.get(), host[0]);
            if (b) copy_to_host(Shape(*b), Copied::all, stream_.get(), host[1]);
        });
        const auto mesh = [](const Shape& shape) { return MeshView(shape.vertices, shape.triangles, shape.groups); };
        const MeshView first = mesh(host[0].shape), second = mesh(host[1].shape);
        SceneBuffers buffers;
        return make_parts(prepare_scene(first, b ? &second : nullptr, false, *this, buffers), count, *this);
    }

    void launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query) override {
        turns_.refuse_third();
        on_device([&] {
            const auto stream = static_cast<cudaStream_t>(a.stream);
            const auto other = b ? static_cast<cudaStream_t>(b->stream) : stream;
            launch(Asked::intersections, stream, other, query,
                   [&](auto slot, Room room) { search_.view(slot, a, b, query.weld, room); });
        });
    }

    bool find(const World& world, const IntersectionQuery& question, Intersections& result) override {
        constexpr int several = 2;  // where they do not fit, fewer may
        return on_device(
            [&] {
                turns_.finish();
                wait_for(world.device_poses);
                return worlds_.find(world, question, *this, result);
            },
            several);
    }
    std::vector<Pose> poses_of(const DevicePoses& poses) override {
        return on_device([&] {
            turns_.finish();
            wait_for(poses);
            return to_host(stream_.get(), poses);
        });
    }
    void launch(const World& world, const IntersectionQuery& question) override {
        turns_.refuse_third();
        on_device([&] {
            const auto stream = static_cast<cudaStream_t>(world.device_poses.stream);
            launch(Asked::worlds, stream, stream, question, [&](auto slot, Room room) {
                const auto bodies = worlds_.bodies_of(world, question.filter, *this, room);
                if (!bodies)
                    throw Error(ErrorCode::invalid_argument,
                                "a launch takes at most 65535 worlds, and 16777216 triangles together");
                search_.pose(slot, bodies, world.device_poses, question.weld, question.output >= Output::pairs, room);
            });
        });
    }

    const DeviceIntersections& wait() override {
        return turns_.awaits(Asked::worlds) ? wait_for_worlds() : wait_for_meshes();
    }
    void download(Intersections& result) override {
        if (!turns_.has_answered(Asked::intersections))
            throw Error(ErrorCode::invalid_argument, "download() needs a wait() for meshes before it");
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
            turns_.finish();
        } catch (const Error&) {
            turns_.state = Turns::State::idle;  // a device that has failed has nothing left to wait for
            turns_.flights.forget();
        }
        search_.release();
        worlds_.release();
        features_.release();
    }

    bool keeps_after(const Error& error) const override {
        if (turns_.state == Turns::State::refused) return true;
        const bool needed = turns_.state == Turns::State::captured || turns_.flights.count() > 0;
        return needed && error.code != ErrorCode::memory_limit && error.code != ErrorCode::device;
    }

   private:
    // view(slot, room) has a slot's input see what is asked about, which is ready on both streams.
    template <class View>
    void launch(Asked asked, cudaStream_t stream, cudaStream_t other, const IntersectionQuery& query, View view) {
        const auto first = capture_of(stream), second = other == stream ? first : capture_of(other);
        const auto bring = [&](std::size_t slot, Room room) {
            view(slot, room);
            search_.adopt(query, room);
            if (other != stream) order(before_, other, stream);
        };
        if (first || second)
            turns_.launch_in_capture(asked, first == second, [&] {
                bring(search_.current(), Room::fixed);
                search_.capture(stream);
            });
        else
            turns_.launch(
                asked, stream, search_.alone(), [&](std::size_t slot) { bring(slot, Room::grows); },
                [&] { search_.launch(stream); });
    }

    const DeviceIntersections& wait_for_worlds() {
        if (turns_.waits_for_replay(Asked::worlds)) {
            on_device([&] {
                shown() = replay_is_complete(Asked::worlds) ? search_.show_worlds() : search_.show_incomplete_worlds();
            });
            return shown();
        }
        turns_.refuse_other(Asked::worlds);
        try {
            constexpr int several = 2;
            on_device([&] { land(), shown() = search_.show_worlds(); }, several);
        } catch (const MemoryMeter::Exceeded&) {
            if (meter_.limit > 0) throw;
            throw Error(ErrorCode::device, "the device has no memory for all worlds at once");
        }
        turns_.answer(Asked::worlds);
        return shown();
    }

    const DeviceIntersections& wait_for_meshes() {
        if (turns_.waits_for_replay(Asked::intersections)) {
            on_device([&] {
                shown() = replay_is_complete(Asked::intersections) ? search_.show() : search_.show_incomplete();
            });
            return shown();
        }
        turns_.refuse_other(Asked::intersections);
        on_device([&] { land(), shown() = search_.show(); });
        turns_.answer(Asked::intersections);
        return shown();
    }

    // What the oldest launch has left, with all that only the host can do.
    void land() {
        turns_.end_state();
        search_.resume(turns_.flights.land());
        if (!search_.accept_launched()) search_.find();
        search_.make_contacts();
    }

    // The stream that it was on is done, says the caller.
    bool replay_is_complete(Asked asked) {
        turns_.begin_replay(asked, search_.has_replayed());
        const bool complete = search_.accept_replay();
        if (complete) search_.make_contacts();
        turns_.replayed = true;
        return complete;
    }

    void find(const IntersectionQuery& query, Intersections& result) {
        search_.adopt(query);
        search_.find();
        search_.copy_to(result);
        result.statistics = search_.statistics();
    }

    // Finds all pairs of the part's triangles, and leaves out those that a lower part owns.
    void find_owned(const PreparedScene& scene, IntersectionQuery query, const Levels& levels, Intersections& result) {
        const bool contacts = query.contacts();
        query.output = Output::pairs;
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

    bool any(const IntersectionQuery& query) {
        search_.adopt(query);
        return search_.any();
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

    void bring(const PreparedScene& scene) {
        turns_.finish();
        search_.bring(scene);
    }
    // Work of ours begins after what the callers' streams were given.
    void view(const MeshView& a, const MeshView* b, const IntersectionQuery& query) {
        turns_.finish();
        refuse_captured(a, b);
        order(before_, static_cast<cudaStream_t>(a.stream), stream_.get());
        if (b) order(before_, static_cast<cudaStream_t>(b->stream), stream_.get());
        search_.view(search_.current(), a, b, query.weld);
    }
    void wait_for(const DevicePoses& poses) {
        const auto stream = static_cast<cudaStream_t>(poses.stream);
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
    DeviceIntersections& shown() { return shown_[search_.current()]; }

    Options options_;  // the others refer to it
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    Device device_;
    Geometry geometry_;
    Stream stream_ = make_stream(device_);
    Event before_ = make_event(device_);
    Turns turns_{device_, stream_.get()};
    Search search_;
    WorldFinder worlds_;
    FeatureCalls features_;
    std::array<DeviceIntersections, Flights::slots> shown_;  ///< by slot
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
