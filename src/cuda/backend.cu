// The cuda backend: owns the memory, plans passes, brings scenes in and answers out.
//
// A plan gives each list a capacity. After a pass the host reads the counters; if a list was too short, it grows and
// the pass is run again (layout.h). Where that does not fit the memory limit or the device, clusters are done one after
// another, in slices, and each twice: pairs are counted, then written to their places ([MZ] sec. 3.1).
//
// launch() gives a whole pass to the caller's stream, as one CUDA graph, and returns; wait() looks at the counters.

#include "pipeline/backend.h"

#include <limits>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "crumple/error.h"
#include "cuda/answer.h"
#include "cuda/device.h"
#include "cuda/gather.h"
#include "cuda/input.h"
#include "cuda/part.h"
#include "cuda/pass.h"
#include "geometry/decide.h"
#include "pipeline/output.h"

namespace crumple {
namespace cuda {
namespace {

class CudaBackend final : public BackendBase {
   public:
    CudaBackend(const Options& options, MemoryMeter& meter, Cancellation& cancellation)
        : options_(options),
          cancellation_(cancellation),
          meter_(meter),
          device_(options.device),
          geometry_(device_.geometry()),
          input_(stream_.get(), meter),
          state_(meter),
          work_(meter),
          answer_(geometry_, stream_.get(), meter),
          pass_(geometry_, stream_.get(), options_) {}
    ~CudaBackend() override {
        if (launched_) cudaEventSynchronize(done_.get());  // it writes to what is freed now
    }

    void find(const Scene& scene, const Query& query, const Part* part, Collisions& result) override {
        on_device([&] {
            bring(scene);
            find(query, part, result);
        });
    }
    void find(const MeshView& a, const MeshView* b, const Query& query, const Part* part, Collisions& result) override {
        on_device([&] {
            view(a, b, query);
            find(query, part, result);
        });
    }

    bool any(const Scene& scene, const Query& query) override {
        return on_device([&] {
            bring(scene);
            return any(query);
        });
    }
    bool any(const MeshView& a, const MeshView* b, const Query& query) override {
        return on_device([&] {
            view(a, b, query);
            return any(query);
        });
    }

    std::vector<Part> partition(const MeshView& a, const MeshView* b, int count) override {
        return on_device([&] {
            view(a, b, {});
            return make_parts(geometry_, stream_.get(), input_, meter_, count);
        });
    }

    std::int64_t bytes_needed(const Scene& scene, const Query& query, const Part* part) override {
        return on_device([&] {
            bring(scene);
            return bytes_needed(query, part);
        });
    }
    std::int64_t bytes_needed(const MeshView& a, const MeshView* b, const Query& query, const Part* part) override {
        return on_device([&] {
            view(a, b, query);
            return bytes_needed(query, part);
        });
    }

    void launch(const MeshView& a, const MeshView* b, const Query& query) override {
        on_device([&] {
            finish();
            input_.view(a, b, query.weld);
            contacts_wanted_ = query.contacts;
            adopt(query, nullptr);
            const auto stream = static_cast<cudaStream_t>(a.stream);
            if (b && b->stream != a.stream) order(static_cast<cudaStream_t>(b->stream), stream);
            enqueued_ = fits_at_once([&] {
                plan();
                lay_out_lists();
                launch_graph(stream);
            });
            CRUMPLE_CUDA(cudaEventRecord(done_.get(), stream));
            launched_ = true;
        });
    }

    const DeviceCollisions& wait() override {
        if (!launched_) throw Error(ErrorCode::invalid_argument, "wait() needs a launch before it");
        on_device([&] {
            finish();
            statistics_ = {};
            if (!was_complete()) answer();
            with_room_for([&] { make_contacts(contacts_wanted_); }, [] {});
            statistics_.triangles = pass_.scene.triangle_count();
            statistics_.pairs = static_cast<std::int64_t>(answer_.total);
            shown_ = answer_.show(pass_.scene, contacts_wanted_);
            shown_.statistics = statistics_;
        });
        answered_ = true;
        return shown_;
    }

    void download(Collisions& result) override {
        if (!answered_) throw Error(ErrorCode::invalid_argument, "download() needs a wait() before it");
        on_device([&] {
            answer_.copy_to(pass_.scene, contacts_wanted_, result);
            result.statistics = statistics_;
        });
    }

    void release() override {
        const Device::Current current(device_);
        finish();
        input_.release();
        answer_.release();
        for (Block* block : {&state_, &work_}) block->release();
        for (Recorded& recorded : recorded_) recorded.graph = {};
        planned_for_ = {};
        too_many_ = std::numeric_limits<std::int64_t>::max();
    }

    std::int64_t bytes_needed_for_launched() override {
        return on_device([&] {
            answer_.release();
            work_.release();
            return bytes_needed();
        });
    }

   private:
    void find(const Query& query, const Part* part, Collisions& result) {
        adopt(query, part);
        answer();
        with_room_for(
            [&] {
                make_contacts(query.contacts);
                answer_.copy_to(pass_.scene, query.contacts, result);
            },
            [&] {
                result.pairs.release();
                result.contacts.points.release();
            });
        result.statistics = statistics_;
    }

    void make_contacts(bool wanted) {
        if (wanted) statistics_.rational_contacts = answer_.make_contacts(pass_.scene, cancellation_);
    }

    // What is made of the answer. If there is no room for it, the lists go; if there is none then, the answer is found
    // again in chunks, for one that was found at once has room to spare. `undo` releases what was made.
    template <class Make, class Undo>
    void with_room_for(Make make, Undo undo) {
        if (fits(make)) return;
        const auto clear = [&] {
            undo();
            answer_.release_contacts();
            work_.release();
        };
        clear();
        if (fits(make)) return;
        if (pass_.scene.triangle_count() < too_many_) {
            too_many_ = pass_.scene.triangle_count();
            clear();
            answer();
        }
        clear();
        make();
    }

    bool any(const Query& query) {
        adopt(query, nullptr);
        answer();
        return answer_.total > 0;
    }

    std::int64_t bytes_needed(const Query& query, const Part* part) {
        adopt(query, part);
        return bytes_needed();
    }

    std::int64_t bytes_needed() {
        meter_.peak = meter_.used.load();
        const auto pairs = static_cast<std::int64_t>(count_in_chunks());
        const std::size_t room = Answer::bytes(pass_.scene, static_cast<std::size_t>(pairs), query_.contacts);
        return meter_.peak + static_cast<std::int64_t>(room) + result_bytes(pass_.scene, query_, pairs);
    }

    // What follows works on the input, whichever way it came.

    void adopt(const Query& query, const Part* part) {
        query_ = query;
        input_.want(query, part);
        pass_.scene = input_.scene();
        pass_.box = input_.box();
        pass_.part_mask = input_.part_mask();
        pass_.part = input_.part();
        pass_.rules = input_.rules();
        lay_out(state_, [&](Cutter& c) { pass_.centres.cut(c); });
        statistics_ = {};
    }

    void plan() {
        const SceneKind kind{pass_.scene.triangle_count(), pass_.scene.between};
        if (planned_for_ != kind) pass_.plan.choose(kind.triangles, kind.between, options_);
        planned_for_ = kind;
    }

    void lay_out_lists() {
        lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
        answer_.make_room(pass_.scene, pass_.plan.hits);
    }

    // Leaves the answer in answer_.
    void answer() {
        statistics_ = {};
        if (!fits_at_once([&] { answer_at_once(); })) answer_in_chunks();
    }

    // Whether there was memory for the work.
    template <class Work>
    static bool fits(Work work) {
        try {
            work();
            return true;
        } catch (const MemoryMeter::Exceeded&) {
        } catch (const OutOfDeviceMemory&) {
        }
        return false;
    }

    // The same for a pass over the whole scene, which is not tried again for scenes of that size.
    template <class Work>
    bool fits_at_once(Work work) {
        if (pass_.scene.triangle_count() >= too_many_) return false;
        if (fits(work)) return true;
        too_many_ = pass_.scene.triangle_count();
        return false;
    }

    void answer_at_once() {
        plan();
        do {
            cancellation_.check();
            lay_out_lists();
            enqueue(&watch_);
            CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
        } while (!accept(*counters_));
        watch_.read(statistics_);
    }

    // The whole of [MZ] Algorithm 1, given to the stream.
    void enqueue(Stopwatch* watch) {
        const cudaStream_t stream = stream_.get();
        const auto begin = [&](Stage stage) {
            if (watch) watch->begin(stage, stream);
        };
        answer_.clear_offsets(pass_.scene);
        pass_.clear_counters();
        begin(Stage::bounds);
        input_.enqueue(geometry_, stream, pass_.counters);
        pass_.bounds();
        begin(Stage::subdivide);
        pass_.subdivide_scene();
        pass_.subdivide_clusters(~std::uint64_t{0});
        begin(Stage::align);
        pass_.align();
        begin(Stage::sort);
        pass_.sort();
        begin(Stage::sweep);
        pass_.sweep({});
        begin(Stage::narrow);
        pass_.narrow({Hits::Mode::list, pass_.hits(), answer_.output.offsets, nullptr});
        begin(Stage::output);
        answer_.write(pass_.scene, pass_.hits(), pass_.counters);
        if (watch) watch->end(stream);
        CRUMPLE_CUDA(
            cudaMemcpyAsync(counters_.get(), pass_.counters, sizeof(Counters), cudaMemcpyDeviceToHost, stream));
    }

    // Whether the pass that these counters tell of was complete. If not, the plan is another one.
    bool accept(const Counters& counters) {
        input_.throw_error(counters);
        const std::int64_t n = pass_.scene.triangle_count();
        if (!pass_.plan.accepts(counters, n, options_)) return false;
        answer_.total = counters.hits;
        if (counters.beyond > 0) {
            const std::size_t found = decide_beyond(static_cast<std::size_t>(counters.beyond));
            answer_.total += found;
            if (!pass_.plan.accepts_hits(answer_.total)) return false;
            if (found > 0) {
                append_hits(geometry_, stream_.get(), pass_.beyond(), found, counters.hits, pass_.hits());
                answer_.clear_offsets(pass_.scene);
                rank_hits(geometry_, stream_.get(), pass_.hits(), answer_.output.offsets);
                answer_.write(pass_.scene, pass_.hits(), pass_.counters);
                CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
            }
        }
        count(counters);
        pass_.plan.cold = false;
        return true;
    }

    // Whether the launched pass has left the whole answer.
    bool was_complete() {
        bool complete = false;
        return enqueued_ && fits_at_once([&] { complete = accept(*counters_); }) && complete;
    }

    void answer_in_chunks() {
        work_.release();
        answer_.release();
        answer_.total = count_in_chunks();
        // The offsets wait with the host while their block grows.
        const std::size_t n = static_cast<std::size_t>(pass_.scene.triangles[0]) + 1;
        Array<unsigned long long> offsets(&meter_);
        copy(offsets.resize_discard(n), answer_.output.offsets, n, cudaMemcpyDeviceToHost);
        work_.release();
        answer_.release();
        answer_.make_room(pass_.scene, static_cast<std::size_t>(answer_.total));
        const Output& output = answer_.output;
        copy(output.offsets, offsets.data(), n, cudaMemcpyHostToDevice);
        copy(output.next, offsets.data(), n, cudaMemcpyHostToDevice);
        offsets.release();
        statistics_ = {};
        pass_over_chunks({Hits::Mode::fill, {}, output.next, output.second});
        order_buckets(geometry_, stream_.get(), pass_.scene, output, pass_.counters);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_.get()));
        planned_for_ = {};
    }

    unsigned long long count_in_chunks() {
        planned_for_ = {};
        pass_.plan.choose_chunks(pass_.scene.triangle_count(), pass_.scene.between, options_);
        answer_.make_room(pass_.scene, 0);
        answer_.clear_offsets(pass_.scene);
        const Output& output = answer_.output;
        pass_over_chunks({Hits::Mode::count, {}, output.offsets, nullptr});
        make_offsets(stream_.get(), pass_.scene, output);
        unsigned long long total = 0;
        copy(&total, output.offsets + pass_.scene.triangles[0], 1, cudaMemcpyDeviceToHost);
        return total;
    }

    // Cluster by cluster, each in as many slices as the lists demand.
    void pass_over_chunks(Hits hits) {
        bool laid_out = false;
        for (int k = 0; k < pass_.plan.fan_out[0];) {
            if (!laid_out) {
                lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
                pass_.clear_counters();
                input_.enqueue(geometry_, stream_.get(), pass_.counters);
                pass_.bounds();
                input_.throw_error(read_counters());
                pass_.subdivide_scene();
                laid_out = true;
            }
            pass_.clear_counters();
            pass_.subdivide_clusters(std::uint64_t{1} << k);
            laid_out = pass_.plan.accepts_chunk(read_counters());
            if (!laid_out) continue;
            pass_.align();
            pass_.sort();
            count(read_counters());
            hits.list.count = &pass_.counters->hits;
            for (Slice slice{}; slice.turn < slice.turns;) {
                cancellation_.check();
                pass_.clear_counters();
                pass_.sweep(slice);
                if (read_counters().survivors > pass_.plan.survivors) {
                    slice = {2 * slice.turn, 2 * slice.turns};
                    continue;
                }
                pass_.narrow(hits);
                const Counters counters = read_counters();
                count(counters);
                if (counters.beyond > 0) {
                    const std::size_t found = decide_beyond(static_cast<std::size_t>(counters.beyond));
                    add_hits(geometry_, stream_.get(), pass_.scene, pass_.beyond(), found, hits);
                }
                ++slice.turn;
            }
            ++k;
        }
    }

    // Pairs that even expansions could not hold, in rational arithmetic. Leaves those that collide at the front of the
    // list, and returns how many.
    std::size_t decide_beyond(std::size_t n) {
        std::vector<Pair> pairs(n), hits;
        copy(pairs.data(), pass_.beyond(), n, cudaMemcpyDeviceToHost);
        Gathered gathered(geometry_, stream_.get(), pass_.scene, meter_);
        gathered.each(pass_.beyond(), n, 0, [&](std::size_t i, const Triangle& a, const Triangle& b) {
            cancellation_.check();
            DecisionCounts counts;
            if (collide(a, b, query_.neighbours, query_.intersections, counts)) hits.push_back(pairs[i]);
        });
        copy(pass_.beyond(), hits.data(), hits.size(), cudaMemcpyHostToDevice);
        return hits.size();
    }

    // Everything that the commands of a pass were made of. While it stays the same, they are the same.
    struct Key {
        Scene scene;
        Rules rules;
        Plan plan;
        Input::Work input;
        const void *work, *result, *state;
        friend bool operator==(const Key&, const Key&) = default;
    };

    void launch_graph(cudaStream_t stream) {
        const Key key{pass_.scene,  pass_.rules,     pass_.plan,   input_.work(),
                      work_.data(), answer_.place(), state_.data()};
        if (!(recorded_[0].graph && recorded_[0].key == key)) {
            std::swap(recorded_[0], recorded_[1]);
            if (!(recorded_[0].graph && recorded_[0].key == key)) recorded_[0] = {key, capture()};
        }
        CRUMPLE_CUDA(cudaGraphLaunch(recorded_[0].graph.get(), stream));
    }

    GraphExec capture() {
        CRUMPLE_CUDA(cudaStreamBeginCapture(stream_.get(), cudaStreamCaptureModeThreadLocal));
        cudaGraph_t made = nullptr;
        try {
            enqueue(nullptr);
        } catch (...) {
            cudaStreamEndCapture(stream_.get(), &made);
            const Graph spoilt(made);
            throw;
        }
        CRUMPLE_CUDA(cudaStreamEndCapture(stream_.get(), &made));
        const Graph graph(made);
        cudaGraphExec_t executable = nullptr;
        CRUMPLE_CUDA(cudaGraphInstantiate(&executable, graph.get(), 0));
        return GraphExec(executable);
    }

    template <class Work>
    std::invoke_result_t<Work> on_device(Work work) {
        const Device::Current current(device_);
        try {
            return work();
        } catch (const OutOfDeviceMemory& error) {
            throw Error(ErrorCode::device, "cudaMalloc: " + std::to_string(error.bytes) + " bytes: out of memory");
        }
    }

    void bring(const Scene& scene) {
        finish();
        input_.bring(scene);
    }
    // Work of ours begins after what the callers' streams were given.
    void view(const MeshView& a, const MeshView* b, const Query& query) {
        finish();
        order(static_cast<cudaStream_t>(a.stream), stream_.get());
        if (b) order(static_cast<cudaStream_t>(b->stream), stream_.get());
        input_.view(a, b, query.weld);
    }
    void order(cudaStream_t first, cudaStream_t then) {
        CRUMPLE_CUDA(cudaEventRecord(before_.get(), first));
        CRUMPLE_CUDA(cudaStreamWaitEvent(then, before_.get(), 0));
    }
    // A launch that nobody waited for is over before its memory is used again; an answer that wait() gave is gone.
    void finish() {
        if (launched_) CRUMPLE_CUDA(cudaEventSynchronize(done_.get()));
        launched_ = answered_ = false;
    }

    Counters read_counters() {
        copy(counters_.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
        return *counters_;
    }

    void count(const Counters& c) {
        Statistics& s = statistics_;
        s.backend = "cuda";
        s.clusters = pass_.plan.fan_out[0];
        s.leaves = pass_.plan.leaves();
        s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
        s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
        s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
        s.edge_tests += static_cast<std::int64_t>(c.survivors);
        s.double_tests += static_cast<std::int64_t>(c.doubles);
        s.exact_tests += static_cast<std::int64_t>(c.undecided);
        s.rational_tests += static_cast<std::int64_t>(c.beyond);
    }

    template <class T>
    void copy(T* to, const T* from, std::size_t n, cudaMemcpyKind kind) {
        copy_now(stream_.get(), to, from, n, kind);
    }

    const Options& options_;
    Cancellation& cancellation_;
    MemoryMeter& meter_;
    Device device_;
    Geometry geometry_;
    Stream stream_ = make_stream(device_);
    Event before_ = make_event(device_), done_ = make_event(device_);
    Stopwatch watch_{device_};
    Pinned<Counters> counters_{device_};
    Input input_;
    Block state_, work_;
    Answer answer_;
    Pass pass_;
    Query query_;
    Statistics statistics_;
    DeviceCollisions shown_;
    bool launched_ = false, contacts_wanted_ = false;
    bool enqueued_ = false;  ///< the launch gave its work to the stream; if there was no room, wait() does it
    bool answered_ = false;  ///< by wait(), and still there
    /// The latest first; two, for simulations that write their frames to two buffers in turn.
    struct Recorded {
        Key key{};
        GraphExec graph;
    } recorded_[2];
    struct SceneKind {
        std::int64_t triangles = -1;
        bool between = false;
        friend bool operator==(const SceneKind&, const SceneKind&) = default;
    };
    SceneKind planned_for_;                                             ///< what the plan was made for
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace
}  // namespace cuda

std::unique_ptr<BackendBase> make_cuda_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation) {
    return std::make_unique<cuda::CudaBackend>(options, meter, cancellation);
}

}  // namespace crumple
