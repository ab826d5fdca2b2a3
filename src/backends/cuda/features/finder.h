#pragma once

// What searches for pairs of features have in common: planned, passed over, and passed over again where a list was too
// short, as intersection_search.h has it for triangles. Where that does not fit the memory limit or the device,
// clusters are done one after another, in slices, and what each finds is brought to the host.
//
// Scenes lie on the host, or on the device as meshes whose features are known (known_mesh.h). Of the latter a pass can
// be launched, or put into a caller's capture, with a slot for what its wait looks at (flights.h).

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "backends/cuda/device/captures.h"
#include "backends/cuda/device/cuda_device.h"
#include "backends/cuda/device/flights.h"
#include "backends/cuda/device/graph_cache.h"
#include "backends/cuda/device/memory.h"
#include "backends/cuda/features/finder_slot.h"
#include "backends/cuda/input/device_input.h"
#include "backends/cuda/stages/pass.h"
#include "base/cancellation.h"
#include "crumple/options.h"
#include "queries/device_answer.h"
#include "queries/feature_request.h"

namespace crumple::cuda {

/// `QuestionPass`: a Pass with cut(), sort(), sweep(slice), and `asked`. `Slot`: a FinderSlot with what else there is
/// to remember. `Key`: for GraphCache. `Question`: what derives from it, with
///
///     look()                    has the pass see what the slot has brought, once more
///     plan(), cut_answer(c)     capacities; the arrays of the answer
///     enqueue(watch)            a whole pass, to our stream
///     accept()                  whether it was complete; if not, the plan is another one
///     find_in_chunks(lists)     leaves the answer on the host
///     rest(), firsts(), extent(), all_kinds()      for the key
template <class Question, class QuestionPass, class Slot, class Key>
class Finder {
   public:
    Finder(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
           MemoryMeter& meter, Cancellation& cancellation, Flights& flights,
           const std::array<Input*, Flights::slots>& inputs)
        : options_(options),
          meter_(meter),
          cancellation_(cancellation),
          geometry_(geometry),
          stream_(stream),
          flights_(flights),
          watch_(device),
          beside_(device),
          graphs_(device, stream),
          capture_(device, stream, beside_),
          guides_(meter),
          work_(meter),
          slots_{Slot(device, stream, meter, *inputs[0]), Slot(device, stream, meter, *inputs[1])},
          pass_(geometry, stream, options) {
        pass_.beside = &beside_;
    }

    /// Whether two slots were more than memory holds: one is then used as long as one will do.
    bool alone() const { return alone_; }
    std::size_t current() const { return now_; }
    /// Works on a slot again, as it was left.
    void resume(std::size_t slot) {
        now_ = slot;
        question().look();
    }

    /// Leaves the answer. Throws MeshChanged, and so do all that accept one.
    void find() {
        slot().on_host = false;
        flights_.settle();  // passes work on the same lists
        if (slot().frugal || !fits_at_once([&] { find_at_once(); })) find_in_chunks();
        slot().statistics = statistics_;
        slot().lost = false;
    }
    /// Gives a whole pass to `stream`; if there is no room for it, it is lost.
    void launch(cudaStream_t stream) {
        slot().on_host = false;
        const auto enqueue = [&] { question().enqueue(nullptr); };
        slot().lost = !fits_at_once([&] {
            prepare_pass();
            if (pass_.plan.guided)
                graphs_.run(key(), stream, enqueue);
            else
                graphs_.run_once(stream, enqueue);
        });
    }
    /// After it is done: whether that pass has left the whole answer, about features that are those of the latest call.
    bool accept_launched(std::uint64_t revision) {
        if (slot().lost || slot().revision != revision) return false;
        bool complete = false;
        if (!fits_at_once([&] { complete = question().accept(); }) || !complete) return false;
        slot().statistics = statistics_;
        return true;
    }

    /// Puts a whole pass into the capture of `stream`, or throws NoRoom.
    void capture(cudaStream_t stream) {
        slot().on_host = false;
        plan();
        if (!pass_.plan.guided || laid_out_ != layout()) throw NoRoom{};
        lay_out_answer(Room::fixed);
        has_replayed();
        capture_.add(stream, [&] { question().enqueue(nullptr); });
    }
    /// Whether a replay was done since the capture, or since this was last asked. A pass ends by writing all counters,
    /// and none has so many units.
    bool has_replayed() {
        constexpr unsigned long long never = ~0ull;
        return std::exchange(slot().counters->next_unit, never) != never;
    }
    /// After that: whether the last replay has left the whole answer. If not, the next pass will have longer lists.
    bool accept_replay() {
        statistics_ = {};
        bool complete = false;
        try {
            complete = question().accept();
        } catch (const MeshChanged&) {  // a graph cannot take other features
        }
        if (!complete) grown_ = std::exchange(pass_.plan, slot().plan);
        slot().statistics = statistics_;
        return complete;
    }
    /// Of one that has not.
    DeviceAnswer show_incomplete() const {
        DeviceAnswer shown;
        shown.complete = false;
        shown.rows_needed = static_cast<std::int64_t>(slot().counters->hits);
        shown.statistics.backend = "cuda";
        return shown;
    }

   protected:
    enum class Lists : std::uint8_t { shortest, roomy };  ///< of chunks

    Slot& slot() { return slots_[now_]; }
    const Slot& slot() const { return slots_[now_]; }
    Input& input() { return slot().input; }

    void drop_lists() {
        free_others();
        laid_out_.reset();
        lists_of_ = nobody;
        work_.release();
        slot().room.release();
    }
    void release() {
        drop_lists();
        guides_.release();
        graphs_.clear();
        too_many_ = std::numeric_limits<std::int64_t>::max();
        alone_ = false;
        grown_.reset();
    }

    /// Works on a slot, whose last answer goes.
    void take_slot(std::size_t slot) {
        now_ = slot;
        this->slot().lost = true;
    }
    /// Has the pass see what the slot's input has brought.
    void look() {
        pass_.scene = input().scene();
        pass_.box = input().box();
        pass_.wanted = input().wanted();
        statistics_ = {};
    }
    static Primitives primitives(const PreparedScene& scene, const Inflation* inflation, bool along_axes) {
        return {true, scene.moving, scene.moving ? static_cast<std::int32_t>(scene.vertex_count()) : 0, inflation,
                along_axes};
    }

    /// Of the slot's pass: whether it was complete. If not, the plan is another one, unless it has become one since,
    /// for another launch. `listed`: whether the hits were.
    bool accepts(const Counters& counters, bool listed) {
        Plan plan = slot().plan;
        const bool latest = pass_.plan == plan;
        const bool complete = plan.accepts(counters, pass_.scene.triangle_count(), options_, listed);
        if (latest) pass_.plan = plan;
        return complete;
    }
    void accepted() {
        if (pass_.plan != slot().plan) return;
        pass_.plan.cold = false;
        pass_.plan.guided = true;
    }

    /// `make_ready`: work between that of the input and `bounds`. `watch`: null where nobody times the stages.
    template <class MakeReady>
    void enqueue_until_sorted(Clearing& clearing, StageEvents* watch, MakeReady make_ready) {
        pass_.clear(clearing);
        input().clear(clearing);
        clearing.launch(geometry_, stream_);
        begin(watch, Stage::bounds);
        input().enqueue(geometry_, stream_, pass_.counters);
        make_ready();
        pass_.bounds();
        begin(watch, Stage::subdivide);
        pass_.subdivide_scene();
        pass_.subdivide_clusters(~std::uint64_t{0});
        begin(watch, Stage::align);
        pass_.align();
        begin(watch, Stage::sort);
        pass_.sort();
    }
    void begin(StageEvents* watch, Stage stage) {
        if (watch) watch->begin(stage, stream_);
    }
    /// Ends a pass: what was done beside is joined, and the host is told the counters, unless a kernel has.
    void enqueue_end(StageEvents* watch, bool told) {
        if (pass_.plan.guided) beside_.join(stream_);
        if (watch) watch->end(stream_);
        if (!told)
            CRUMPLE_CUDA(cudaMemcpyAsync(slot().counters.get(), pass_.counters, sizeof(Counters),
                                         cudaMemcpyDeviceToHost, stream_));
    }

    /// Cluster by cluster: calls slice(counters) for each slice whose pairs of triangles fit their list, which ends the
    /// search by returning false. `cut_answer`: what of the answer lies on the device.
    template <class CutAnswer, class MakeReady, class NarrowSlice>
    void over_chunks(CutAnswer cut_answer, MakeReady make_ready, NarrowSlice slice) {
        bool laid_out = false;
        for (int k = 0; k < pass_.plan.fan_out[0];) {
            if (!laid_out) lay_out_chunks(cut_answer, make_ready);
            Clearing clearing;
            pass_.clear(clearing);
            clearing.launch(geometry_, stream_);
            pass_.subdivide_clusters(std::uint64_t{1} << k);
            laid_out = pass_.plan.accepts_chunk(read_counters());
            if (!laid_out) continue;
            pass_.align();
            pass_.sort();
            const Counters sorted = read_counters();
            laid_out = pass_.plan.accepts_units(sorted);
            if (!laid_out) continue;
            count(sorted);
            if (!over_slices(slice)) return;
            ++k;
        }
    }

    Counters read_counters() {
        copy_now(stream_, slot().counters.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
        return *slot().counters;
    }
    void count(const Counters& c) {
        Statistics& s = statistics_;
        s.backend = "cuda";
        s.clusters = pass_.plan.fan_out[0];
        s.leaves = pass_.plan.leaves();
        s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
        s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
        s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
        s.edge_tests += static_cast<std::int64_t>(c.listed);
        for (const unsigned long long tests : c.tests) {
            s.double_tests += static_cast<std::int64_t>(tests);
            s.exact_tests += static_cast<std::int64_t>(tests);
        }
        s.rational_tests += static_cast<std::int64_t>(c.beyond);
    }

   private:
    Question& question() { return static_cast<Question&>(*this); }
    const Question& question() const { return static_cast<const Question&>(*this); }

    void plan() {
        if (grown_) pass_.plan = *std::exchange(grown_, std::nullopt);
        question().plan();
    }
    // Lists, and room for the answer, for a pass that this slot will tell of.
    void prepare_pass() {
        plan();
        if (laid_out_ != layout()) {
            flights_.settle();  // passes work on what may move now
            laid_out_.reset();
            lists_of_ = nobody;
            lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
            lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
            laid_out_ = layout();
        }
        lay_out_answer(Room::grows);
    }
    void lay_out_answer(Room room) {
        lay_out(
            slot().room, [&](Cutter& c) { question().cut_answer(c); }, room);
        slot().plan = pass_.plan;
        lists_of_ = now_;
    }
    void find_at_once() {
        do {
            cancellation_.check();
            prepare_pass();
            question().enqueue(&watch_);
            CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        } while (!question().accept());
        watch_.read(statistics_);
    }
    // With as long lists as memory seems to allow, or with the shortest.
    void find_in_chunks() {
        slot().on_host = true;
        const auto with = [&](Lists lists) {
            drop_lists();
            statistics_ = {};
            question().find_in_chunks(lists);
        };
        if (slot().frugal || !fits([&] { with(Lists::roomy); })) with(Lists::shortest);
    }
    // Whether there was memory for a pass over the whole scene, which is not tried again for scenes of that size.
    template <class Work>
    bool fits_at_once(Work work) {
        const std::int64_t n = pass_.scene.triangle_count();
        if (n >= too_many_) return false;
        if (fits(work) || (free_others() && fits(work))) return true;
        too_many_ = n;
        return false;
    }
    Key key() {
        return {pass_.scene,        pass_.wanted,        pass_.plan,           input().work(),         pass_.asked,
                question().rest(),  question().firsts(), question().extent(),  question().all_kinds(), work_.data(),
                slot().room.data(), guides_.data(),      slot().counters.get()};
    }

    /// What sizes and places of all lists follow from.
    struct Layout {
        std::int64_t vertices, triangles;
        bool float32, moving;
        Plan plan;
        friend bool operator==(const Layout&, const Layout&) = default;
    };
    Layout layout() const {
        return {pass_.scene.vertex_count(), pass_.scene.triangle_count(), pass_.scene.float32, pass_.scene.moving,
                pass_.plan};
    }

    // What earlier launches have left goes where there is no memory for this one. Those in flight are done again in
    // their wait, by what they were given.
    bool free_others() {
        flights_.settle();
        const std::int64_t before = meter_.used;
        for (std::size_t i = 0; i < slots_.size(); ++i) {
            if (i == now_) continue;
            slots_[i].lost = true;
            slots_[i].room.release();
        }
        const bool freed = meter_.used < before;
        alone_ = alone_ || freed;
        return freed;
    }

    template <class CutAnswer, class MakeReady>
    void lay_out_chunks(CutAnswer cut_answer, MakeReady make_ready) {
        lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
        lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
        lay_out(slot().room, cut_answer);
        Clearing clearing;
        pass_.clear(clearing);
        input().clear(clearing);
        clearing.launch(geometry_, stream_);
        input().enqueue(geometry_, stream_, pass_.counters);
        make_ready();
        pass_.bounds();
        input().throw_error(read_counters());
        pass_.subdivide_scene();
    }

    // A slice is halved until its pairs of triangles fit their list; then all lists do.
    template <class NarrowSlice>
    bool over_slices(NarrowSlice narrow) {
        for (Slice slice{}; slice.turn < slice.turns;) {
            cancellation_.check();
            pass_.clear_counters();
            pass_.sweep(slice);
            if (read_counters().survivors > pass_.plan.survivors) {
                slice = {2 * slice.turn, 2 * slice.turns};
                continue;
            }
            if (!narrow()) return false;
            ++slice.turn;
        }
        return true;
    }

   protected:
    static constexpr std::size_t nobody = Flights::slots;

    const Options& options_;
    MemoryMeter& meter_;
    Cancellation& cancellation_;
    const Geometry& geometry_;
    cudaStream_t stream_;
    Flights& flights_;
    StageEvents watch_;
    Branch beside_;
    GraphCache<Key> graphs_;
    CallersCapture capture_;
    Block guides_, work_;
    std::array<Slot, Flights::slots> slots_;
    QuestionPass pass_;
    Statistics statistics_;
    std::size_t lists_of_ = nobody;  ///< slot whose pass the lists are of

   private:
    std::size_t now_ = 0;             ///< slot that is worked on
    std::optional<Layout> laid_out_;  ///< what the lists are laid out for
    std::optional<Plan> grown_;       ///< what the last incomplete replay asks for
    bool alone_ = false;
    std::int64_t too_many_ = std::numeric_limits<std::int64_t>::max();  ///< triangles that did not fit at once
};

}  // namespace crumple::cuda
