// The cuda backend: brings scenes in and answers out, and keeps the callers' streams and ours in order.
//
// launch() gives a whole pass to the caller's stream and returns; wait() looks at the counters.

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
#include "engine/cuda/host_mesh.h"
#include "engine/cuda/input.h"
#include "engine/cuda/search.h"
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
          input_(options.device, stream_.get(), meter),
          search_(device_, geometry_, stream_.get(), options, meter, cancellation, input_),
          features_there_(stream_.get(), meter),
          features_(device_, geometry_, stream_.get(), options, meter, cancellation, input_, features_there_),
          candidates_(device_, geometry_, stream_.get(), options, meter, cancellation, input_, features_there_) {
        reserve_stacks();
    }
    ~CudaBackend() override {
        if (state_ == State::launched) cudaEventSynchronize(done_.get());  // it writes to what is freed now
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
        on_device([&] {
            finish();
            refuse_captured(a, b);
            input_.view(a, b, query.weld);
            search_.adopt(query);
            const auto stream = static_cast<cudaStream_t>(a.stream);
            if (b && b->stream != a.stream) order(before_, static_cast<cudaStream_t>(b->stream), stream);
            const bool fits = search_.launch(stream);
            CRUMPLE_CUDA(cudaEventRecord(done_.get(), stream));
            state_ = fits ? State::launched : State::postponed;
        });
    }

    const DeviceCollisions& wait() override {
        if (state_ != State::launched && state_ != State::postponed)
            throw Error(ErrorCode::invalid_argument, "wait() needs a launch before it");
        on_device([&] {
            const bool launched = state_ == State::launched;
            finish();
            search_.forget_statistics();
            if (!(launched && search_.accept_launched())) search_.find();
            search_.make_contacts();
            shown_ = search_.show();
        });
        state_ = State::answered;
        return shown_;
    }

    void download(Collisions& result) override {
        if (state_ != State::answered) throw Error(ErrorCode::invalid_argument, "download() needs a wait() before it");
        on_device([&] {
            search_.download(result);
            result.statistics = shown_.statistics;
        });
    }

    void release() override {
        std::optional<Device::Current> current;
        try {
            current.emplace(device_);
            finish();
        } catch (const Error&) {
            state_ = State::idle;  // a device that has failed has nothing left to wait for
        }
        input_.release();
        search_.release();
        features_.release();
        candidates_.release();
        features_there_.release();
    }

    std::int64_t bytes_needed_for_launched() override {
        return on_device([&] {
            search_.drop_lists();
            return bytes_needed();
        });
    }

   private:
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
        input_.bring(scene);
    }
    // Work of ours begins after what the callers' streams were given.
    void view(const MeshView& a, const MeshView* b, const Query& query) {
        finish();
        refuse_captured(a, b);
        order(before_, static_cast<cudaStream_t>(a.stream), stream_.get());
        if (b) order(before_, static_cast<cudaStream_t>(b->stream), stream_.get());
        input_.view(a, b, query.weld);
    }
    // We wait for the streams, which a capture forbids, and would spoil it.
    static void refuse_captured(const MeshView& a, const MeshView* b) {
        for (const MeshView* mesh : {&a, b}) {
            if (!mesh || !mesh->stream) continue;
            cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
            CRUMPLE_CUDA(cudaStreamIsCapturing(static_cast<cudaStream_t>(mesh->stream), &status));
            if (status != cudaStreamCaptureStatusNone)
                throw Error(ErrorCode::invalid_argument, "a mesh's stream is being captured, and cannot be waited for");
        }
    }
    // A launch that nobody waited for is over before its memory is used again; an answer that wait() gave is gone.
    void finish() {
        const State before = std::exchange(state_, State::idle);
        if (before == State::launched || before == State::postponed) CRUMPLE_CUDA(cudaEventSynchronize(done_.get()));
    }

    enum class State : std::uint8_t {
        idle,
        launched,   ///< a pass is on a caller's stream
        postponed,  ///< there was no room for it: wait() does the work, after the stream's
        answered,   ///< by wait(), and still there
    };

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    Device device_;
    Geometry geometry_;
    Stream stream_ = make_stream(device_);
    Event before_ = make_event(device_), done_ = make_event(device_);
    Input input_;
    Search search_;
    FeaturesOnDevice features_there_;
    FeatureFinder features_;
    CandidateFinder candidates_;
    State state_ = State::idle;
    DeviceCollisions shown_;
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
