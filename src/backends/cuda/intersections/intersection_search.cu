#include "backends/cuda/intersections/intersection_search.h"

#include <algorithm>
#include <vector>

#include "backends/cuda/device/gather.h"
#include "exact/intersection/decide_intersection.h"

namespace crumple::cuda {

Search::Search(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
               MemoryMeter& meter, Cancellation& cancellation, Flights& flights)
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
      slots_{Slot(device, geometry, stream, meter), Slot(device, geometry, stream, meter)},
      pass_(geometry, stream, options) {
    pass_.beside = &beside_;
}

Search::Key Search::Key::shape() const {
    Key shape = *this;
    for (VertexReader& reader : shape.scene.reader) forget_place(reader.data);
    for (TriangleView& view : shape.input.triangles) forget_place(view.data);
    for (const void*& of : shape.input.groups) forget_place(of);
    forget_place(shape.input.poses);
    forget_place(shape.scene.corners);
    forget_place(shape.scene.groups);
    forget_place(shape.wanted.groups.excluded);
    forget_place(shape.wanted.bodies.excluded);
    forget_place(shape.wanted.classes);
    shape.input.block = shape.work = shape.result = shape.guides = shape.counters = nullptr;
    shape.plan = {};
    shape.plan.worlds = plan.worlds;
    std::ranges::copy(plan.fan_out, shape.plan.fan_out);
    return shape;
}

Slot::Slot(const Device& device, const Geometry& geometry, cudaStream_t stream, MemoryMeter& meter)
    : input(device.index(), stream, meter), counters(device), answer(geometry, stream, meter) {}

void Slot::release() {
    input.release();
    answer.release();
}

// What a call is given comes first: all that earlier ones have left may go for it.
template <class Work>
void Search::bring_with_room(Work work) {
    if (fits(work)) return;
    free_others();
    work();
}

void Search::view(std::size_t slot, const MeshView& a, const MeshView* b, bool weld, Room room) {
    now_ = slot;
    this->slot().lost = true;
    bring_with_room([&] { input().view(a, b, weld, room); });
}

void Search::pose(std::size_t slot, const std::shared_ptr<const PosedWorlds>& worlds, const DevicePoses& poses,
                  bool weld, bool pairs, Room room) {
    now_ = slot;
    this->slot().lost = true;
    bring_with_room([&] { input().pose(worlds, poses, weld, pairs, room); });
}

void Search::bring(const PreparedScene& scene) {
    bring_with_room([&] { input().bring(scene); });
}

void Search::adopt(const IntersectionQuery& query, Room room) {
    captured_ = false;
    slot().query = query;
    slot().query.filter = {};
    input().want(query, room);
    look();
}

void Search::resume(std::size_t slot) {
    now_ = slot;
    look();
}

// Has the pass see what the slot holds.
void Search::look() {
    pass_.scene = input().scene();
    pass_.box = input().box();
    pass_.worlds = input().worlds().triangles();
    pass_.wanted = input().wanted();
    pass_.policy = policy_of(query().neighbours, query().kind);
    answer().names = input().names();
    statistics_ = {};
}

// What earlier launches have left goes where there is no memory for this one. Those in flight are done again in their
// wait(), by what they were given.
bool Search::free_others() {
    flights_.settle();
    const std::int64_t before = meter_.used;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (i == now_) continue;
        slots_[i].lost = true;
        slots_[i].answer.release();
        if (!flights_.holds(i)) slots_[i].input.release();
    }
    const bool freed = meter_.used < before;
    alone_ = alone_ || freed;
    return freed;
}

void Search::drop_lists() {
    free_others();
    lists_of_ = nobody;
    laid_out_.reset();
    answer().release();
    work_.release();
}

void Search::release() {
    drop_lists();
    for (Slot& slot : slots_) slot.release();
    guides_.release();
    graphs_.clear();
    planned_for_ = {};
    grown_.reset();
    too_many_ = std::numeric_limits<std::int64_t>::max();
    alone_ = false;
}

void Search::plan() {
    if (grown_) pass_.plan = *std::exchange(grown_, std::nullopt);
    const PreparedScene& scene = pass_.scene;
    const SceneKind kind{scene.triangle_count(), scene.between, scene.worlds};
    if (planned_for_ != kind && scene.worlds == 1) pass_.plan.choose(kind.triangles, kind.between, options_);
    if (planned_for_ != kind && scene.worlds > 1)
        pass_.plan.choose_worlds(kind.triangles, kind.worlds, scene.largest_world(), options_);
    planned_for_ = kind;
}

Search::Layout Search::layout() const {
    return {pass_.scene.vertices, pass_.scene.triangles, pass_.scene.float32, pass_.plan};
}

void Search::lay_out_lists() {
    if (laid_out_ == layout()) return;
    flights_.settle();  // passes work on what may move now
    laid_out_.reset();
    lists_of_ = nobody;
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    laid_out_ = layout();
}

// Lists, and room for the answer, for a pass that this slot will tell of.
void Search::prepare_pass() {
    plan();
    lay_out_lists();
    answer().make_room(pass_.scene, pass_.plan.hits);
    slot().plan = pass_.plan;
    lists_of_ = now_;
}

// Whether there was memory for a pass over the whole scene, which is not tried again for scenes of that size.
template <class Work>
bool Search::fits_at_once(Work work) {
    if (pass_.scene.triangle_count() >= too_many_) return false;
    if (fits(work) || (free_others() && fits(work))) return true;
    too_many_ = pass_.scene.triangle_count();
    return false;
}

// What is made of the answer. If there is no room for it, the lists go; if there is none then, the answer is found
// again in chunks, for one that was found at once has room to spare. `undo` releases what was made.
template <class Make, class Undo>
void Search::with_room_for(Make make, Undo undo) {
    if (captured_) return make();  // nothing may go
    if (fits(make)) return;
    const auto clear = [&] {
        undo();
        free_others();
        lists_of_ = nobody;
        answer().release_contacts();
        laid_out_.reset();
        work_.release();
    };
    clear();
    if (fits(make)) return;
    if (pass_.scene.triangle_count() < too_many_) {
        too_many_ = pass_.scene.triangle_count();
        clear();
        find();
    }
    clear();
    make();
}

// With as long lists as memory seems to allow; if that was too bold, with the shortest.
template <class Work>
void Search::in_chunks(Work work) {
    if (!fits([&] { work(Lists::roomy); })) work(Lists::shortest);
}

void Search::find() {
    statistics_ = {};
    flights_.settle();  // passes work on the same lists
    if (fits_at_once([&] { find_at_once(); })) return;
    refuse_worlds();
    in_chunks([&](Lists lists) { find_in_chunks(lists); });
}

// Fewer worlds at once need less than chunks of all of them, and chunks name no pairs by bodies.
void Search::refuse_worlds() {
    if (pass_.scene.worlds > 1 || input().posed()) throw MemoryMeter::Exceeded{};
}

void Search::find_at_once() {
    do {
        cancellation_.check();
        prepare_pass();
        enqueue(&watch_);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    } while (!accept(*slot().counters));
    watch_.read(statistics_);
}

bool Search::launch(cudaStream_t stream) {
    const bool launched = fits_at_once([&] {
        prepare_pass();
        const auto pass = [&] { enqueue(nullptr); };
        if (pass_.plan.guided)
            graphs_.run({pass_.scene, pass_.wanted, pass_.policy, pass_.plan, input().work(), work_.data(),
                         answer().place(), guides_.data(), slot().counters.get()},
                        stream, pass);
        else
            graphs_.run_once(stream, pass);
    });
    slot().lost = !launched;
    return launched;
}

bool Search::accept_launched() {
    if (slot().lost) return false;
    bool complete = false;
    return fits_at_once([&] { complete = accept(*slot().counters); }) && complete;
}

void Search::capture(cudaStream_t stream) {
    plan();
    if (!pass_.plan.guided || laid_out_ != layout()) throw NoRoom{};
    answer().make_room(pass_.scene, pass_.plan.hits, Room::fixed);
    slot().plan = pass_.plan;
    lists_of_ = now_;
    has_replayed();
    capture_.add(stream, [&] { enqueue(nullptr); });
    captured_ = true;
}

// A pass ends by writing all counters, and none has so many units.
bool Search::has_replayed() {
    constexpr unsigned long long never = ~0ull;
    return std::exchange(slot().counters->next_unit, never) != never;
}

bool Search::accept_replay() {
    statistics_ = {};
    if (accept(*slot().counters)) return true;
    grown_ = std::exchange(pass_.plan, slot().plan);
    return false;
}

bool Search::any() {
    statistics_ = {};
    bool found = false;
    if (fits_at_once([&] { found = any_at_once(); })) return found;
    refuse_worlds();
    in_chunks([&](Lists lists) { found = any_in_chunks(lists); });
    return found;
}

void Search::flag_worlds(std::span<std::uint8_t> flags) {
    statistics_ = {};
    if (!fits_at_once([&] { flag_worlds_at_once(flags); })) refuse_worlds();
}

// In two rounds, for a hit is known only after a sweep: where many collide, a sixteenth of the sweep tells, and kernels
// of the second round end where they begin; where nothing does, the first one costs three launches. The second goes on
// with the lists of the first, so it narrows those few once more.
bool Search::any_at_once() {
    plan();
    for (;;) {
        cancellation_.check();
        lay_out_lists();
        lists_of_ = nobody;
        Clearing clearing;
        enqueue_until_sorted(clearing, nullptr);
        unsigned long long* const found = &pass_.counters->hits;
        for (const Slice& slice : {Slice{0, 16, 1, found}, Slice{1, 16, 15, found}}) {
            pass_.sweep(slice);
            pass_.narrow({Hits::Mode::any, pass_.hits(), nullptr, nullptr, nullptr});
            fill(stream_, &pass_.counters->next_unit, 0, sizeof pass_.counters->next_unit);
        }
        if (pass_.plan.guided) beside_.join(stream_);
        const Counters counters = read_counters();
        input().throw_error(counters);
        const bool complete = pass_.plan.accepts(counters, pass_.scene.triangle_count(), options_, false);
        if (complete) {
            pass_.plan.cold = false;
            pass_.plan.guided = true;
        }
        if (counters.hits > 0) return true;
        if (complete) return counters.beyond > 0 && decide_beyond(static_cast<std::size_t>(counters.beyond)) > 0;
    }
}

// The whole of [MZ] Algorithm 1, given to the stream.
void Search::enqueue(StageEvents* watch) {
    const auto begin = [&](Stage stage) {
        if (watch) watch->begin(stage, stream_);
    };
    Clearing clearing;
    answer().clear(clearing, pass_.scene);
    enqueue_until_sorted(clearing, watch);
    begin(Stage::sweep);
    pass_.sweep({});
    begin(Stage::narrow);
    pass_.narrow({Hits::Mode::list, pass_.hits(), answer().output.offsets, answer().output.by_tile, nullptr});
    begin(Stage::output);
    answer().write(pass_.scene, pass_.hits(), pass_.counters, slot().counters.get());
    if (pass_.plan.guided) beside_.join(stream_);
    if (watch) watch->end(stream_);
}

// What a guided pass does beside has been forked, and is not joined yet.
void Search::enqueue_until_sorted(Clearing& clearing, StageEvents* watch) {
    const auto begin = [&](Stage stage) {
        if (watch) watch->begin(stage, stream_);
    };
    pass_.clear(clearing);
    input().clear(clearing);
    clearing.launch(geometry_, stream_);
    begin(Stage::bounds);
    input().enqueue(geometry_, stream_, pass_.counters);
    pass_.bounds();
    begin(Stage::subdivide);
    pass_.subdivide_scene();
    pass_.subdivide_clusters(~std::uint64_t{0});
    begin(Stage::align);
    pass_.align();
    begin(Stage::sort);
    pass_.sort();
}

// Whether the slot's pass, which these counters tell of, was complete. If not, the plan is another one, unless it has
// become one since, for another launch.
bool Search::accept(const Counters& counters) {
    input().throw_error(counters);
    Plan plan = slot().plan;
    const bool latest = pass_.plan == plan, complete = plan.accepts(counters, pass_.scene.triangle_count(), options_);
    if (latest) pass_.plan = plan;
    if (!complete) return false;
    answer().total = counters.hits;
    if (counters.beyond > 0) {
        if (lists_of_ != now_) return false;  // a later pass has written there
        const std::size_t found = decide_beyond(static_cast<std::size_t>(counters.beyond));
        answer().total += found;
        if (!pass_.plan.accepts_hits(answer().total)) return false;
        if (found > 0) {
            append_hits(geometry_, stream_, pass_.beyond(), found, counters.hits, pass_.hits());
            Clearing clearing;
            answer().clear(clearing, pass_.scene);
            clearing.add(&pass_.counters->parts, sizeof pass_.counters->parts);
            clearing.launch(geometry_, stream_);
            rank_hits(geometry_, stream_, pass_.hits(), answer().output.offsets, answer().output.by_tile);
            answer().write(pass_.scene, pass_.hits(), pass_.counters, nullptr);
            CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        }
    }
    count(counters, plan);
    if (latest) {
        pass_.plan.cold = false;
        pass_.plan.guided = true;
    }
    return true;
}

// Pairs that even expansions could not hold, in rational arithmetic. Leaves those that collide at the front of the
// list, and returns how many.
std::size_t Search::decide_beyond(std::size_t n) {
    std::vector<Pair> pairs(n), hits;
    copy(pairs.data(), pass_.beyond(), n, cudaMemcpyDeviceToHost);
    Gathered gathered(geometry_, stream_, pass_.scene, meter_);
    gathered.each(pass_.beyond(), n, 0, [&](std::size_t i, const Triangle& a, const Triangle& b) {
        cancellation_.check();
        DecisionCounts counts;
        if (collide(a, b, query().neighbours, query().kind, counts)) hits.push_back(pairs[i]);
    });
    copy(pass_.beyond(), hits.data(), hits.size(), cudaMemcpyHostToDevice);
    return hits.size();
}

Counters Search::read_counters() {
    copy(slot().counters.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
    return *slot().counters;
}

void Search::count(const Counters& c, const Plan& plan) {
    Statistics& s = statistics_;
    s.backend = "cuda";
    s.clusters = plan.children(0);
    s.leaves = plan.leaves();
    s.members += static_cast<std::int64_t>(c.members[plan.levels() - 1]);
    s.interval_tests += static_cast<std::int64_t>(c.interval_tests);
    s.box_overlaps += static_cast<std::int64_t>(c.box_overlaps);
    s.edge_tests += static_cast<std::int64_t>(c.survivors);
    s.double_tests += static_cast<std::int64_t>(c.doubles);
    s.exact_tests += static_cast<std::int64_t>(c.undecided);
    s.rational_tests += static_cast<std::int64_t>(c.beyond);
}

void Search::make_contacts() {
    with_room_for(
        [&] {
            if (query().contacts()) statistics_.rational_contacts = answer().make_contacts(pass_.scene, cancellation_);
        },
        [] {});
}

void Search::copy_to(Intersections& result) {
    with_room_for(
        [&] {
            if (query().contacts()) statistics_.rational_contacts = answer().make_contacts(pass_.scene, cancellation_);
            answer().copy_to(pass_.scene, query().contacts(), result);
        },
        [&] {
            result.pairs.release();
            result.contacts.points.release();
        });
}

Statistics Search::shown_statistics() const {
    Statistics shown = statistics_;
    shown.triangles = pass_.scene.triangle_count();
    shown.pairs = static_cast<std::int64_t>(answer().total);
    return shown;
}

DeviceIntersections Search::show() const {
    DeviceIntersections shown = answer().show(pass_.scene, query().contacts());
    shown.statistics = shown_statistics();
    return shown;
}

DeviceIntersections Search::show_worlds() const {
    DeviceIntersections shown = answer().show_worlds(query().contacts());
    shown.statistics = shown_statistics();
    return shown;
}

DeviceIntersections Search::show_incomplete() const {
    DeviceIntersections shown;
    shown.complete = false;
    shown.pairs_needed = static_cast<std::int64_t>(slot().counters->hits);
    shown.statistics.backend = "cuda";
    shown.statistics.triangles = pass_.scene.triangle_count();
    return shown;
}

DeviceIntersections Search::show_incomplete_worlds() const {
    const DeviceIntersections scene = show_incomplete();
    DeviceIntersections shown;
    shown.complete = false;
    shown.of_worlds = true;
    shown.pairs_needed = scene.pairs_needed;
    shown.worlds = answer().names.worlds;
    shown.statistics = scene.statistics;
    return shown;
}

}  // namespace crumple::cuda
