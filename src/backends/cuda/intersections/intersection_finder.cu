#include "backends/cuda/intersections/intersection_finder.h"

#include <vector>

#include "backends/cuda/device/gather.h"
#include "exact/intersection/decide_intersection.h"

namespace crumple::cuda {

IntersectionFinder::IntersectionFinder(BackendState& state)
    : Finder(state, pass_),
      pass_(geometry_, stream_, options_),
      results_{ResultOnDevice(geometry_, stream_, meter_), ResultOnDevice(geometry_, stream_, meter_)} {}

void IntersectionFinder::release() {
    Finder::release();
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) release_rows(slot);
    for (Input& input : state_.inputs) input.release();
}

void IntersectionFinder::release_rows(std::size_t slot) {
    Finder::release_rows(slot);
    results_[slot].release_contacts();
}

void IntersectionFinder::bring(const PreparedScene& scene) {
    claim_slot(current(), [&] { input().bring(scene); });
}

void IntersectionFinder::view(std::size_t slot, const MeshView& a, const MeshView* b, bool weld, Growth growth) {
    claim_slot(slot, [&] { input().view(a, b, weld, growth); });
}

void IntersectionFinder::pose(std::size_t slot, const std::shared_ptr<const PosedWorlds>& worlds,
                              const DevicePoses& poses, bool weld, bool pairs, Growth growth) {
    claim_slot(slot, [&] { input().pose(worlds, poses, weld, pairs, growth); });
}

void IntersectionFinder::copy_from(const IntersectionQuery& query, Growth growth) {
    queries_[current()] = query;
    queries_[current()].filter = {};
    input().want(query, growth);
    bind();
}

void IntersectionFinder::bind() {
    Finder::bind();
    pass_.policy = policy_of(query().neighbours, query().kind);
    answer().names = input().names();
}

void IntersectionFinder::choose_plan(Plan& plan) const {
    const std::int64_t n = scene().triangle_count();
    if (scene().worlds == 1)
        plan.choose(n, scene().between, options_);
    else
        plan.choose_worlds(n, scene().worlds, scene().largest_world(), options_);
}

void IntersectionFinder::choose_chunks(Plan& plan, std::int64_t bytes) const {
    plan.choose_chunks(scene().triangle_count(), scene().between, options_, bytes);
}

void IntersectionFinder::narrow() { pass_.narrow({Hits::Mode::list, pass_.hits(), answer().output.offsets, nullptr}); }

bool IntersectionFinder::write_rows(Counters* host_counters) {
    answer().write(scene(), pass_.hits(), pass_.counters, host_counters);
    return true;
}

void IntersectionFinder::count_tests(const Counters& c, Statistics& s) const {
    s.edge_tests += static_cast<std::int64_t>(c.survivors);
    s.double_tests += static_cast<std::int64_t>(c.doubles);
    s.exact_tests += static_cast<std::int64_t>(c.undecided);
}

// Decides pairs that expansions could not decide, in rational arithmetic. Leaves the pairs that collide at the front of
// the list of such pairs, on the device.
std::size_t IntersectionFinder::decide_unresolved(std::size_t n) {
    std::vector<Pair> pairs(n), hits;
    copy_now(stream_, pairs.data(), pass_.beyond(), n, cudaMemcpyDeviceToHost);
    Gathered gathered(geometry_, stream_, scene(), meter_);
    gathered.each(pass_.beyond(), n, 0, [&](std::size_t i, const Triangle& a, const Triangle& b) {
        cancellation_.check();
        DecisionCounts counts;
        if (collide(a, b, query().neighbours, query().kind, counts)) hits.push_back(pairs[i]);
    });
    copy_now(stream_, pass_.beyond(), hits.data(), hits.size(), cudaMemcpyHostToDevice);
    return hits.size();
}

void IntersectionFinder::append_decided(std::size_t count, unsigned long long before) {
    append_hits(geometry_, stream_, pass_.beyond(), count, before, pass_.hits());
    rank_hits(geometry_, stream_, pass_.hits(), answer().output.offsets);
}

// Runs make(), which allocates memory for contacts or copies of the result. If memory does not suffice, frees the
// lists. If that is not enough, finds the result again in chunks, because a result found at once has unused capacity.
// `undo` releases the memory that make() has allocated.
template <class Make, class Undo>
void IntersectionFinder::with_capacity(Make make, Undo undo) {
    if (captured_) return make();  // nothing may be freed
    if (fits(make)) return;
    const auto clear = [&] {
        undo();
        answer().release_contacts();
        release_lists();
    };
    clear();
    if (fits(make)) return;
    if (!refuses_at_once()) {
        refuse_at_once();
        clear();
        find();
    }
    clear();
    make();
}

void IntersectionFinder::make_contacts() {
    with_capacity(
        [&] {
            if (query().contacts()) statistics_.rational_contacts = answer().make_contacts(scene(), cancellation_);
        },
        [] {});
}

void IntersectionFinder::copy_to(Intersections& result) {
    with_capacity(
        [&] {
            if (query().contacts()) statistics_.rational_contacts = answer().make_contacts(scene(), cancellation_);
            answer().copy_to(scene(), query().contacts(), result);
        },
        [&] {
            result.pairs.release();
            result.contacts.points.release();
        });
}

DeviceIntersections IntersectionFinder::show() const {
    DeviceIntersections shown = answer().show(scene(), query().contacts());
    shown.statistics = statistics();
    shown.statistics.triangles = scene().triangle_count();
    shown.statistics.pairs = static_cast<std::int64_t>(answer().total);
    return shown;
}

DeviceIntersections IntersectionFinder::show_incomplete() const {
    DeviceIntersections shown;
    shown.complete = false;
    shown.pairs_needed = static_cast<std::int64_t>(slot().counters->hits);
    shown.of_worlds = answer().names.any();
    if (shown.of_worlds) shown.worlds = answer().names.worlds;
    shown.statistics.backend = "cuda";
    shown.statistics.triangles = scene().triangle_count();
    return shown;
}

}  // namespace crumple::cuda
