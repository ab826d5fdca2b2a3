#include "backends/cuda/engine/finder.h"

#include <utility>

namespace crumple::cuda {

Finder::Finder(BackendState& state, Pass& stages)
    : state_(state),
      options_(state.options),
      meter_(state.meter),
      cancellation_(state.cancellation),
      geometry_(state.geometry),
      stream_(state.stream.get()),
      slots_{Slot(state.device, state.meter), Slot(state.device, state.meter)},
      stages_(stages),
      watch_(state.device),
      beside_(state.device),
      graphs_(state.device, stream_),
      capture_(state.device, stream_, beside_),
      warm_starts_(state.meter),
      work_(state.meter) {}

// ---- A pass: the whole of [MZ] Algorithm 1, enqueued on our stream. `watch` is null if stages are not timed.

void Finder::enqueue(StageEvents* watch) {
    Counters* const host_counters = slot().counters.get();
    BatchedClear batch;
    clear_rows(batch);
    enqueue_until_sorted(batch, watch);
    begin(watch, Stage::sweep);
    stages_.sweep({});
    begin(watch, Stage::narrow);
    narrow();
    begin(watch, Stage::output);
    const bool are_copied = write_rows(host_counters);
    if (stages_.plan.warm_started) beside_.join(stream_);
    if (watch) watch->end(stream_);
    if (!are_copied)
        CRUMPLE_CUDA(
            cudaMemcpyAsync(host_counters, stages_.counters, sizeof(Counters), cudaMemcpyDeviceToHost, stream_));
}

// Enqueues a pass up to `sort`. The side branch of a warm-started pass stays forked: the caller has to join it.
void Finder::enqueue_until_sorted(BatchedClear& batch, StageEvents* watch) {
    stages_.clear(batch);
    input().clear(batch);
    batch.launch(geometry_, stream_);
    begin(watch, Stage::bounds);
    input().enqueue(geometry_, stream_, stages_.counters);
    make_ready();
    stages_.bounds();
    begin(watch, Stage::subdivide);
    stages_.subdivide_scene();
    stages_.subdivide_clusters(~std::uint64_t{0});
    begin(watch, Stage::align);
    stages_.align();
    begin(watch, Stage::sort);
    stages_.sort();
}

void Finder::begin(StageEvents* watch, Stage stage) {
    if (watch) watch->begin(stage, stream_);
}

bool Finder::pass_without_rows(FunctionRef<void()> rounds, Counters& counters) {
    cancellation_.check();
    plan();
    place_lists();
    lists_of_ = no_slot;
    BatchedClear batch;
    enqueue_until_sorted(batch, nullptr);
    rounds();
    if (stages_.plan.warm_started) beside_.join(stream_);
    counters = read_counters();
    input().throw_error(counters);
    const bool complete = stages_.plan.accepts(counters, scene().triangle_count(), options_, false);
    if (complete) prepare_warm_start();
    return complete;
}

// Returns true if the slot's pass has left the whole result, or a hit where one is enough. Adapts the plan if a list
// was too short, unless another launch has changed the plan since.
bool Finder::accept() {
    const Counters counters = *slot().counters;
    input().throw_error(counters);
    Plan plan = slot().plan;
    const bool latest = stages_.plan == plan;
    const bool complete = plan.accepts(counters, scene().triangle_count(), options_, !is_any_output());
    if (latest) stages_.plan = plan;
    // If one hit is enough, a pass with a hit counts even if a list was too short: any hit found is valid by itself.
    const bool proven = is_any_output() && counters.hits > 0;
    if (!complete && !proven) return false;
    unsigned long long total = counters.hits;
    if (counters.beyond > 0 && !proven && !add_unresolved(counters, total)) return false;
    count(counters, plan);
    if (complete && latest) prepare_warm_start();
    read_rows(total);
    return true;
}

// Decides on the host what the device could not, and adds the hits to the rows. Returns false if the list of hits
// cannot hold them, or if a later pass has overwritten the list of unresolved tests.
bool Finder::add_unresolved(const Counters& counters, unsigned long long& total) {
    if (lists_of_ != now_) return false;
    const std::size_t decided = decide_unresolved(static_cast<std::size_t>(counters.beyond));
    total += decided;
    if (is_any_output() || decided == 0) return true;
    if (!stages_.plan.accepts_hits(total)) {
        slot().counters->hits = total;  // reported if this is an incomplete replay
        return false;
    }
    BatchedClear batch;
    clear_rows(batch);
    batch.add(&stages_.counters->parts, sizeof stages_.counters->parts);
    batch.launch(geometry_, stream_);
    append_decided(decided, counters.hits);
    write_rows(nullptr);
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    return true;
}

// Makes the next pass warm-start from what this one, which was complete, has left.
void Finder::prepare_warm_start() {
    stages_.plan.cold = false;
    stages_.plan.warm_started = true;
}

Counters Finder::read_counters() {
    copy_now(stream_, slot().counters.get(), stages_.counters, 1, cudaMemcpyDeviceToHost);
    return *slot().counters;
}

void Finder::count(const Counters& c, const Plan& plan) {
    Statistics& s = statistics_;
    s.backend = "cuda";
    s.clusters = plan.children(0);
    s.leaves = plan.leaves();
    s.members += static_cast<std::int64_t>(c.members[plan.levels() - 1]);
    s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
    s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
    s.rational_tests += static_cast<std::int64_t>(c.beyond);
    count_tests(c, s);
}

// ---- Calls: a pass run at once, launched, or put into a caller's graph.

void Finder::find() {
    statistics_ = {};
    state_.launches_in_flight.synchronize();  // passes in flight use the same lists
    if (slot().low_memory || !fits_at_once([&] { find_at_once(); })) {
        refuse_worlds();
        in_chunks([&] { find_in_chunks(); });
    }
    slot().lost = false;
}

void Finder::find_at_once() {
    do {
        cancellation_.check();
        prepare_pass();
        enqueue(&watch_);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    } while (!accept());
    watch_.read(statistics_);
}

void Finder::launch(cudaStream_t stream) {
    const auto pass = [&] { enqueue(nullptr); };
    slot().lost = !fits_at_once([&] {
        prepare_pass();
        if (stages_.plan.warm_started)
            graphs_.run(key(), stream, pass);
        else
            graphs_.run_once(stream, pass);
    });
}

bool Finder::accept_launched(std::uint64_t revision) {
    if (slot().lost || slot().revision != revision) return false;
    bool complete = false;
    return fits_at_once([&] { complete = accept(); }) && complete;
}

void Finder::capture(cudaStream_t stream) {
    plan();
    if (!stages_.plan.warm_started || layout_done_ != layout()) throw CapacityError{};
    place_rows(Growth::fixed);
    has_replayed();
    capture_.add(stream, [&] { enqueue(nullptr); });
    captured_ = true;
}

// A pass ends by writing all counters. The value `never`, which no pass writes, marks that no pass has ended since it
// was set.
bool Finder::has_replayed() {
    constexpr unsigned long long never = ~0ull;
    return std::exchange(slot().counters->parts, never) != never;
}

bool Finder::accept_replay() {
    statistics_ = {};
    bool complete = false;
    try {
        complete = accept();
    } catch (const MeshChanged&) {  // a caller's graph cannot be given the new mesh's features
    }
    if (!complete) plan_of_replay_ = std::exchange(stages_.plan, slot().plan);
    return complete;
}

GraphKey Finder::key() const {
    return {scene(),      stages_.wanted,     stages_.plan,        input().work(),       parameters(),
            work_.data(), slot().rows.data(), warm_starts_.data(), slot().counters.get()};
}

// ---- Slots, lists and memory.

void Finder::claim_slot(std::size_t slot, FunctionRef<void()> bring) {
    now_ = slot;
    this->slot().lost = true;
    captured_ = false;
    if (fits(bring)) return;
    free_others();
    bring();
}

void Finder::resume(std::size_t slot) {
    now_ = slot;
    bind();
}

void Finder::bind() {
    stages_.beside = &beside_;
    stages_.scene = input().scene();
    stages_.box = input().box();
    stages_.worlds = input().worlds().triangles();
    stages_.wanted = input().wanted();
    statistics_ = {};
}

void Finder::plan() {
    if (plan_of_replay_) stages_.plan = *std::exchange(plan_of_replay_, std::nullopt);
    const SceneKind kind{scene().triangle_count(), scene().between, scene().worlds, all_kinds()};
    if (planned_for_ != kind) choose_plan(stages_.plan);
    planned_for_ = kind;
}

Finder::Layout Finder::layout() const {
    return {scene().vertices, scene().triangles, scene().float32, scene().moving, stages_.plan};
}

void Finder::place_lists() {
    if (layout_done_ == layout()) return;
    state_.launches_in_flight.synchronize();  // passes in flight use memory that may move now
    layout_done_.reset();
    lists_of_ = no_slot;
    place_arrays(warm_starts_, [&](ArenaLayout& c) { stages_.warm_starts.cut(c, stages_.plan); });
    place_arrays(work_, [&](ArenaLayout& c) { stages_.cut(c); });
    layout_done_ = layout();
}

void Finder::place_rows(Growth growth) {
    place_arrays(
        slot().rows, [&](ArenaLayout& c) { cut_rows(c); }, growth);
    slot().on_host = false;
    slot().plan = stages_.plan;
    lists_of_ = now_;
}

// Makes the plan for a pass of the current slot, and places its lists and the memory for its rows.
void Finder::prepare_pass() {
    plan();
    place_lists();
    place_rows(Growth::grows);
}

bool Finder::fits_at_once(FunctionRef<void()> work) {
    if (refuses_at_once()) return false;
    if (fits(work) || (free_others() && fits(work))) return true;
    refuse_at_once();
    return false;
}

bool Finder::free_others() {
    state_.launches_in_flight.synchronize();
    const std::int64_t before = meter_.used;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (i == now_) continue;
        slots_[i].lost = true;
        release_rows(i);
        if (!state_.launches_in_flight.holds(i)) state_.inputs[i].release();
    }
    const bool freed = meter_.used < before;
    alone_ = alone_ || freed;
    return freed;
}

void Finder::release_lists() {
    free_others();
    layout_done_.reset();
    lists_of_ = no_slot;
    work_.release();
}

void Finder::drop_lists() {
    release_lists();
    release_rows(now_);
}

void Finder::release() {
    drop_lists();
    warm_starts_.release();
    graphs_.clear();
    planned_for_ = {};
    plan_of_replay_.reset();
    too_many_ = std::numeric_limits<std::int64_t>::max();
    alone_ = false;
}

}  // namespace crumple::cuda
