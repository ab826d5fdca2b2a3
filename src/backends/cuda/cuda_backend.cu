// The cuda backend: uploads scenes, downloads results, and synchronizes its own stream ("our stream") with those of
// callers.
//
// A pass is one run of all stages over a scene (engine/finder.h). launch() enqueues a pass on the caller's stream and
// returns; wait() waits for the pass and reads its counters. At most two launches are in flight
// (device/launch_queue.h). If the caller's stream is being captured, the pass becomes part of the caller's graph, and
// wait() reads the result of that graph's last replay (engine/launches.h).

#include "backends/backend.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "backends/cuda/comparison_cases.h"
#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/engine/launches.h"
#include "backends/cuda/features/device_feature_queries.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/input/host_shape.h"
#include "backends/cuda/intersections/intersection_finder.h"
#include "backends/cuda/intersections/posed_world_calls.h"
#include "backends/cuda/overlaps/device_overlaps.h"
#include "crumple/error.h"
#include "partition/levels.h"
#include "partition/parts_of_scene.h"
#include "results/intersection_output.h"

namespace crumple {
namespace cuda {
namespace {

void check_method(const Method& method) {
    if (method != Method())
        throw Error(ErrorCode::invalid_argument,
                    "the cuda backend sweeps along principal axes and uses the membership rule ball; use the cpu "
                    "backend for other methods",
                    Element::option);
}

class CudaBackend final : public BackendBase {
   public:
    CudaBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : state_((check_method(options.method), options), meter, cancellation) {
        reserve_stacks();
        check_comparison_cases(state_.device, state_.stream.get());
    }
    ~CudaBackend() override {
        const CaptureMode relaxed(cudaStreamCaptureModeRelaxed);  // else waiting would invalidate captures
        try {
            state_.launches_in_flight.finish();  // launches in flight write to memory that is freed now
        } catch (...) {                          // the device has failed
        }
    }

    int worlds_at_once() const override { return max_leaves; }

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
        Intersections all = metered(&state_.meter);
        find(scene, query, nullptr, all);
        statistics = all.statistics;
        take(all.pairs);
    }

    void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) override {
        features_.find(scene, request, result);
    }
    DeviceFeatureCalls& device_feature_calls() override { return features_; }
    OverlapDevice* overlap_device() override { return &overlaps_; }

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
                finder_.copy_from(query);
                finder_.flag_worlds(flags);
                statistics = finder_.statistics();
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
            copy_to_host(Shape(a), Copied::all, state_.stream.get(), host[0]);
            if (b) copy_to_host(Shape(*b), Copied::all, state_.stream.get(), host[1]);
        });
        const auto mesh = [](const Shape& shape) { return MeshView(shape.vertices, shape.triangles, shape.groups); };
        const MeshView first = mesh(host[0].shape), second = mesh(host[1].shape);
        SceneBuffers buffers;
        return make_parts(prepare_scene(first, b ? &second : nullptr, false, *this, buffers), count, *this);
    }

    bool find(const World& world, const IntersectionQuery& query, Intersections& result) override {
        constexpr int several = 2;  // stands for "more than one" in on_device(): memory may suffice for fewer worlds
        return on_device(
            [&] {
                follow(world.device_poses);
                return worlds_.find(world, query, *this, result);
            },
            several);
    }
    std::vector<Pose> poses_of(const DevicePoses& poses) override {
        return on_device([&] {
            follow(poses);
            return to_host(state_.stream.get(), poses);
        });
    }

    LaunchNumber launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query) override {
        const auto stream = static_cast<cudaStream_t>(a.stream);
        const auto other = b ? static_cast<cudaStream_t>(b->stream) : stream;
        const auto bind = [&](std::size_t slot, Growth growth) {
            finder_.view(slot, a, b, query.weld, growth);
            finder_.copy_from(query, growth);
        };
        return launch(stream, other, bind, false);
    }
    LaunchNumber launch(const World& world, const IntersectionQuery& query) override {
        const auto stream = static_cast<cudaStream_t>(world.device_poses.stream);
        const auto bind = [&](std::size_t slot, Growth growth) {
            const auto bodies = worlds_.bodies_of(world, query.filter, *this, growth);
            if (!bodies)
                throw Error(ErrorCode::invalid_argument,
                            "a launch supports at most 65535 worlds, and 16777216 triangles in all of them; find() "
                            "supports more");
            finder_.pose(slot, bodies, world.device_poses, query.weld, query.output >= Output::pairs, growth);
            finder_.copy_from(query, growth);
        };
        return launch(stream, stream, bind, true);
    }

    // Waits for a launch, or reads the last replay of a captured one, and does the work on the result that only the
    // host can do.
    const DeviceIntersections& wait(LaunchNumber launch) override {
        launches_.check_awaited(launch);
        DeviceIntersections& shown = shown_[launch % most_in_flight];
        const bool worlds = shown.of_worlds;
        try {
            on_device(
                [&] {
                    const Launches::Outcome outcome = launches_.wait(finder_);
                    if (outcome == Launches::Outcome::lost) finder_.find();
                    const bool complete = outcome != Launches::Outcome::incomplete;
                    if (complete) finder_.make_contacts();
                    shown = complete ? finder_.show() : finder_.show_incomplete();
                    launches_.mark_reported(launch);
                },
                worlds ? 2 : 1);
        } catch (const MemoryMeter::Exceeded&) {
            if (!worlds || state_.meter.limit > 0) throw;
            throw Error(ErrorCode::device,
                        "the device has no memory for all worlds of a launch at once; find() needs less");
        }
        return shown;
    }
    void download(LaunchNumber launch, Intersections& result) override {
        const DeviceIntersections& shown = shown_[launch % most_in_flight];
        if (!launches_.has_reported(launch) || shown.of_worlds)
            throw Error(ErrorCode::invalid_argument,
                        "download() is for launches of meshes, and must come right after their wait()");
        if (!shown.complete)
            throw Error(ErrorCode::invalid_argument,
                        "download() needs a complete result; call launch() outside of the capture, and capture again");
        on_device([&] {
            finder_.download(result);
            result.statistics = shown.statistics;
        });
    }

    void release() override {
        std::optional<Device::Current> current;
        try {
            current.emplace(state_.device);
            launches_.finish();
        } catch (const Error&) {
            launches_.forget();  // no work is left on a device that has failed
        }
        finder_.release();
        for (Input& input : state_.inputs) input.release();
        worlds_.release();
        features_.release();
        overlaps_.release();
    }

    bool keeps_after(const Error& error) const override {
        if (launches_.was_refused()) return true;
        return launches_.needs_memory() && error.code != ErrorCode::memory_limit && error.code != ErrorCode::device;
    }

   private:
    void find(const IntersectionQuery& query, Intersections& result) {
        finder_.copy_from(query);
        finder_.find();
        finder_.copy_to(result);
        result.statistics = finder_.statistics();
    }

    // Finds all pairs among the triangles of a public part (crumple/part.h), and drops those that another part owns.
    void find_owned(const PreparedScene& scene, IntersectionQuery query, const Levels& levels, Intersections& result) {
        const bool contacts = query.contacts();
        query.output = Output::pairs;
        find(query, result);
        keep_owned(scene, levels, result);
        if (!contacts) return;
        if (state_.meter.limit > 0) finder_.drop_lists();
        result.statistics.rational_contacts = contacts_of_pairs(scene, result, [&](std::size_t n, auto task) {
            for (std::size_t i = 0; i < n; ++i) {
                state_.cancellation.check();
                task(i);
            }
        });
    }

    bool any(const IntersectionQuery& query) {
        finder_.copy_from(query);
        return finder_.any();
    }

    // Launches, without work, the kernels that need a stack. At a kernel's first launch the driver reserves a stack for
    // every thread that the device can hold (docs/cuda.md). That must happen before the lists of later passes take the
    // memory.
    void reserve_stacks() {
        const Device::Current current(state_.device);
        const cudaStream_t stream = state_.stream.get();
        MemoryMeter unlimited;
        Block block(unlimited);
        Counters* counters = nullptr;
        place_arrays(block, [&](ArenaLayout& c) { counters = c.take<Counters>(1); });
        fill(stream, counters, 0, sizeof *counters);
        reserve_exact_stack(state_.geometry, stream, counters);
        reserve_contact_stack(state_.geometry, stream);
        reserve_feature_stacks(state_.geometry, stream, counters);
        reserve_crossing_stack(state_.geometry, stream);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream));
    }

    // Calls work() with the backend's device as the current one. If `worlds` > 1, turns OutOfDeviceMemory into
    // MemoryMeter::Exceeded: memory may suffice for fewer worlds.
    template <class Work>
    std::invoke_result_t<Work> on_device(Work work, int worlds = 1) {
        return with_device(state_.device, [&] {
            try {
                return work();
            } catch (const OutOfDeviceMemory&) {
                if (worlds > 1) throw MemoryMeter::Exceeded{};
                throw;
            }
        });
    }

    LaunchNumber launch(cudaStream_t stream, cudaStream_t other,
                        FunctionRef<void(std::size_t slot, Growth growth)> bind, bool of_worlds) {
        const LaunchNumber launched =
            on_device([&] { return launches_.launch(finder_, stream, other, bind, of_worlds); });
        DeviceIntersections& shown = shown_[launched % most_in_flight] = {};
        shown.of_worlds = of_worlds;
        return launched;
    }

    void bring(const PreparedScene& scene) {
        launches_.finish();
        finder_.bring(scene);
    }
    // Binds meshes on the device. Work that is enqueued on our stream from now on waits for the work that the meshes'
    // streams have so far.
    void view(const MeshView& a, const MeshView* b, const IntersectionQuery& query) {
        launches_.finish();
        state_.follow(a.stream, "a mesh's");
        if (b) state_.follow(b->stream, "a mesh's");
        finder_.view(finder_.current(), a, b, query.weld);
    }
    void follow(const DevicePoses& poses) {
        launches_.finish();
        state_.follow(poses.stream, "the poses'");
    }

    BackendState state_;
    Launches launches_{state_};
    IntersectionFinder finder_{state_};
    PosedWorldCalls worlds_{finder_, state_.stream.get(), state_.meter};
    FeatureCalls features_{state_, launches_};
    DeviceOverlaps overlaps_{state_};
    std::array<DeviceIntersections, most_in_flight> shown_;  ///< results, by launch number modulo most_in_flight
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
