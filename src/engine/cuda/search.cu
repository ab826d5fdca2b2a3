#include "engine/cuda/search.h"

#include <vector>

#include "engine/cuda/gather.h"
#include "questions/intersect/decide.h"

namespace crumple::cuda {

Search::Search(const Device& device, const Geometry& geometry, cudaStream_t stream, const Options& options,
               MemoryMeter& meter, Cancellation& cancellation, Input& input)
    : options_(options),
      meter_(meter),
      cancellation_(cancellation),
      geometry_(geometry),
      stream_(stream),
      input_(input),
      watch_(device),
      beside_(device),
      counters_(device),
      graphs_(device, stream),
      guides_(meter),
      work_(meter),
      answer_(geometry, stream, meter),
      pass_(geometry, stream, options) {
    pass_.beside = &beside_;
}

void Search::adopt(const Query& query) {
    query_ = query;
    input_.want(query);
    pass_.scene = input_.scene();
    pass_.box = input_.box();
    pass_.worlds = input_.worlds().triangles();
    pass_.wanted = input_.wanted();
    pass_.policy = policy_of(query.neighbours, query.intersections);
    statistics_ = {};
}

void Search::drop_lists() {
    laid_out_.reset();
    answer_.release();
    work_.release();
}

void Search::release() {
    drop_lists();
    guides_.release();
    graphs_.clear();
    planned_for_ = {};
    too_many_ = std::numeric_limits<std::int64_t>::max();
}

void Search::plan() {
    const Scene& scene = pass_.scene;
    const SceneKind kind{scene.triangle_count(), scene.between, scene.worlds};
    if (planned_for_ != kind && scene.worlds == 1) pass_.plan.choose(kind.triangles, kind.between, options_);
    if (planned_for_ != kind && scene.worlds > 1)
        pass_.plan.choose_worlds(kind.triangles, kind.worlds, scene.largest_world(), options_);
    planned_for_ = kind;
}

void Search::lay_out_lists(bool answer) {
    const Layout wanted{pass_.scene.vertices, pass_.scene.triangles, pass_.scene.float32, pass_.plan, answer};
    if (laid_out_ == wanted) return;
    laid_out_.reset();
    lay_out(guides_, [&](Cutter& c) { pass_.guides.cut(c, pass_.plan); });
    lay_out(work_, [&](Cutter& c) { pass_.cut(c); });
    if (answer) answer_.make_room(pass_.scene, pass_.plan.hits);
    laid_out_ = wanted;
}

// Whether there was memory for the work.
template <class Work>
bool Search::fits(Work work) {
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
bool Search::fits_at_once(Work work) {
    if (pass_.scene.triangle_count() >= too_many_) return false;
    if (fits(work)) return true;
    too_many_ = pass_.scene.triangle_count();
    return false;
}

// What is made of the answer. If there is no room for it, the lists go; if there is none then, the answer is found
// again in chunks, for one that was found at once has room to spare. `undo` releases what was made.
template <class Make, class Undo>
void Search::with_room_for(Make make, Undo undo) {
    if (fits(make)) return;
    const auto clear = [&] {
        undo();
        answer_.release_contacts();
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
    if (fits_at_once([&] { find_at_once(); })) return;
    refuse_several_worlds();
    in_chunks([&](Lists lists) { find_in_chunks(lists); });
}

// Fewer worlds at once need less than chunks of all of them.
void Search::refuse_several_worlds() const {
    if (pass_.scene.worlds > 1) throw MemoryMeter::Exceeded{};
}

void Search::find_at_once() {
    plan();
    do {
        cancellation_.check();
        lay_out_lists(true);
        enqueue(&watch_);
        CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
    } while (!accept(*counters_));
    watch_.read(statistics_);
}

bool Search::launch(cudaStream_t stream) {
    return fits_at_once([&] {
        plan();
        lay_out_lists(true);
        graphs_.run({pass_.scene, pass_.wanted, pass_.policy, pass_.plan, input_.work(), work_.data(), answer_.place(),
                     guides_.data()},
                    stream, [&] { enqueue(nullptr); });
    });
}

bool Search::accept_launched() {
    bool complete = false;
    return fits_at_once([&] { complete = accept(*counters_); }) && complete;
}

bool Search::any() {
    statistics_ = {};
    bool found = false;
    if (fits_at_once([&] { found = any_at_once(); })) return found;
    refuse_several_worlds();
    in_chunks([&](Lists lists) { found = any_in_chunks(lists); });
    return found;
}

void Search::flag_worlds(std::span<std::uint8_t> flags) {
    statistics_ = {};
    if (!fits_at_once([&] { flag_worlds_at_once(flags); })) refuse_several_worlds();
}

// In two rounds, for a hit is known only after a sweep: where many collide, a sixteenth of the sweep tells, and kernels
// of the second round end where they begin; where nothing does, the first one costs three launches. The second goes on
// with the lists of the first, so it narrows those few once more.
bool Search::any_at_once() {
    plan();
    for (;;) {
        cancellation_.check();
        lay_out_lists(false);
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
        input_.throw_error(counters);
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
    answer_.clear(clearing, pass_.scene);
    enqueue_until_sorted(clearing, watch);
    begin(Stage::sweep);
    pass_.sweep({});
    begin(Stage::narrow);
    pass_.narrow({Hits::Mode::list, pass_.hits(), answer_.output.offsets, answer_.output.by_tile, nullptr});
    begin(Stage::output);
    answer_.write(pass_.scene, pass_.hits(), pass_.counters, counters_.get());
    if (pass_.plan.guided) beside_.join(stream_);
    if (watch) watch->end(stream_);
}

// What a guided pass does beside has been forked, and is not joined yet.
void Search::enqueue_until_sorted(Clearing& clearing, StageEvents* watch) {
    const auto begin = [&](Stage stage) {
        if (watch) watch->begin(stage, stream_);
    };
    pass_.clear(clearing);
    input_.clear(clearing);
    clearing.launch(geometry_, stream_);
    begin(Stage::bounds);
    input_.enqueue(geometry_, stream_, pass_.counters);
    pass_.bounds();
    begin(Stage::subdivide);
    pass_.subdivide_scene();
    pass_.subdivide_clusters(~std::uint64_t{0});
    begin(Stage::align);
    pass_.align();
    begin(Stage::sort);
    pass_.sort();
}

// Whether the pass that these counters tell of was complete. If not, the plan is another one.
bool Search::accept(const Counters& counters) {
    input_.throw_error(counters);
    const std::int64_t n = pass_.scene.triangle_count();
    if (!pass_.plan.accepts(counters, n, options_)) return false;
    answer_.total = counters.hits;
    if (counters.beyond > 0) {
        const std::size_t found = decide_beyond(static_cast<std::size_t>(counters.beyond));
        answer_.total += found;
        if (!pass_.plan.accepts_hits(answer_.total)) return false;
        if (found > 0) {
            append_hits(geometry_, stream_, pass_.beyond(), found, counters.hits, pass_.hits());
            Clearing clearing;
            answer_.clear(clearing, pass_.scene);
            clearing.add(&pass_.counters->parts, sizeof pass_.counters->parts);
            clearing.launch(geometry_, stream_);
            rank_hits(geometry_, stream_, pass_.hits(), answer_.output.offsets, answer_.output.by_tile);
            answer_.write(pass_.scene, pass_.hits(), pass_.counters, nullptr);
            CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
        }
    }
    count(counters);
    pass_.plan.cold = false;
    pass_.plan.guided = true;
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
        if (collide(a, b, query_.neighbours, query_.intersections, counts)) hits.push_back(pairs[i]);
    });
    copy(pass_.beyond(), hits.data(), hits.size(), cudaMemcpyHostToDevice);
    return hits.size();
}

Counters Search::read_counters() {
    copy(counters_.get(), pass_.counters, 1, cudaMemcpyDeviceToHost);
    return *counters_;
}

void Search::count(const Counters& c) {
    Statistics& s = statistics_;
    s.backend = "cuda";
    s.clusters = pass_.plan.children(0);
    s.leaves = pass_.plan.leaves();
    s.members += static_cast<std::int64_t>(c.members[pass_.plan.levels() - 1]);
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
            if (query_.contacts) statistics_.rational_contacts = answer_.make_contacts(pass_.scene, cancellation_);
        },
        [] {});
}

void Search::copy_to(Collisions& result) {
    with_room_for(
        [&] {
            if (query_.contacts) statistics_.rational_contacts = answer_.make_contacts(pass_.scene, cancellation_);
            answer_.copy_to(pass_.scene, query_.contacts, result);
        },
        [&] {
            result.pairs.release();
            result.contacts.points.release();
        });
}

DeviceCollisions Search::show() const {
    DeviceCollisions shown = answer_.show(pass_.scene, query_.contacts);
    shown.statistics = statistics_;
    shown.statistics.triangles = pass_.scene.triangle_count();
    shown.statistics.pairs = static_cast<std::int64_t>(answer_.total);
    return shown;
}

}  // namespace crumple::cuda
