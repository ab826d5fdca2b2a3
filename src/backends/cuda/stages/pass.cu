#include "backends/cuda/stages/pass.h"

#include <algorithm>
#include <cstddef>

#include "backends/cuda/stages/align.h"

namespace crumple::cuda {
namespace {

constexpr int samples_of_scene = 2048, samples_per_child = 32;  // samples for fuzzy C-means

}  // namespace

void WarmStarts::cut(ArenaLayout& cutter, const Plan& plan) {
    const std::size_t children[2] = {static_cast<std::size_t>(plan.children(0)),
                                     static_cast<std::size_t>(plan.children(1))};
    for (WarmStart* warm_start : {&now, &next}) {
        for (int i = 0; i < 2; ++i) {
            warm_start->centre[i] = cutter.take<Row<float>>(children[i]);
            warm_start->first[i] = cutter.take<unsigned long long>(children[i] + 1);
        }
        warm_start->frame = cutter.take<BinnedFrame>(static_cast<std::size_t>(plan.leaves()));
    }
    moved[0] = cutter.take<float>(static_cast<std::size_t>(plan.worlds));
    moved[1] = cutter.take<float>(children[0]);
}

void Pass::cut(ArenaLayout& c) {
    const std::size_t vertices = primitives.rows(scene.vertex_count());
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const auto leaves = static_cast<std::size_t>(plan.leaves());
    const std::size_t rows = plan.last_members();

    counters = c.take<Counters>(1);
    points_ = {};
    if (scene.float32)
        points_.f = c.take<Row<float>>(vertices);
    else
        points_.d = c.take<Row<double>>(vertices);
    balls_ = c.take<Ball>(triangles);
    std::size_t partial = 0;
    for (int i = 0; i < plan.levels(); ++i) partial = std::max(partial, fuzzy_scratch(level(i), fuzziness(i)));
    partial_ = c.take<Row<float>>(partial);
    for (int i = 0; i < plan.levels(); ++i) {
        count_[i] = c.take<unsigned long long>(static_cast<std::size_t>(plan.children(i)));
        mask_[i] = c.take<std::uint64_t>(i == 0 ? triangles : plan.members[0]);
        const auto buffer = plan.members[i];
        members_[i] = {c.take<std::int32_t>(buffer), c.take<std::uint32_t>(buffer), buffer};
    }
    reach_ = c.take<unsigned>(leaves);
    sorted_.bin = c.take<std::uint32_t>(rows);
    sorted_.rank = c.take<std::uint32_t>(rows);
    sorted_.bin_first = c.take<std::uint32_t>(leaves * (bins + 1));
    sorted_.binned = c.take<unsigned>(leaves);
    sorted_.row = c.take<SortedRow>(rows);
    sorted_.leaf = c.take<std::uint16_t>(rows);
    units_ = c.take<SweepUnit>(plan.units);
    survivors_ = c.take<Candidate>(plan.survivors);
}

Level Pass::level(int i) const {
    Level level{};
    level.parents = i == 0 ? plan.worlds : plan.children(0);
    level.fan_out = plan.fan_out[i];
    level.items_of = i == 0 ? worlds : members_of(0);
    level.items = static_cast<unsigned long long>(scene.triangle_count());
    level.triangle = i == 0 ? nullptr : members_[0].triangle;
    level.centre = warm_starts.now.centre[i];
    level.next_centre = warm_starts.next.centre[i];
    level.moved = warm_starts.moved[i];
    level.mask = mask_[i];
    level.members_of = members_of(i);
    level.next_first = warm_starts.next.first[i];
    return level;
}

Fuzziness Pass::fuzziness(int i) const {
    const FuzzyCMeans& means = options_.fuzzy_c_means;
    return {static_cast<float>(means.fuzziness), plan.cold ? means.first_iterations : means.max_iterations,
            static_cast<float>(plan.cold ? means.first_stop : means.stop), plan.cold,
            i == 0 && plan.worlds == 1 ? samples_of_scene : samples_per_child * plan.fan_out[i]};
}

Ownership Pass::ownership() const {
    if (plan.levels() == 1) return {nullptr, mask_[0], plan.fan_out[0], 1};
    return {mask_[0], mask_[1], plan.fan_out[1], plan.fan_out[0]};
}

void Pass::clear(BatchedClear& batch) const {
    cuda::clear(batch, counters);
    for (int i = 0; i < plan.levels(); ++i) {
        const Level it = level(i);
        const auto children = static_cast<std::size_t>(it.children());
        const std::size_t firsts = (children + 1) * sizeof *it.next_first;
        cuda::clear(batch, it);
        batch.add(it.members_of.count, children * sizeof *it.members_of.count);
        if (plan.warm_started) {
            batch.copy(warm_starts.now.centre[i], it.next_centre, children * sizeof *it.centre);
            batch.copy(it.members_of.first, it.next_first, firsts);
        } else {
            batch.add(it.members_of.first, firsts);  // no child has places yet
        }
    }
    const auto leaves = static_cast<std::size_t>(plan.leaves());
    if (plan.warm_started)
        batch.copy(warm_starts.now.frame, warm_starts.next.frame, leaves * sizeof *warm_starts.now.frame);
    batch.add(reach_, leaves * sizeof *reach_);
    cuda::clear(batch, sorted_, plan.leaves());
}

void Pass::clear_counters() {
    BatchedClear batch;
    constexpr std::size_t kept = offsetof(Counters, members);
    batch.add(counters->members, sizeof *counters - kept);
    batch.launch(geometry_, stream_);
}

void Pass::bounds() { compute_bounds(geometry_, stream_, scene, primitives, box, points_, balls_, counters); }

// Computes the level's centres for this pass.
void Pass::move_centres(int i) {
    const Level it = level(i);
    fuzzy_c_means(geometry_, stream_, it, balls_, fuzziness(i), partial_);
    BatchedClear batch;
    batch.copy(warm_starts.now.centre[i], it.next_centre, static_cast<std::size_t>(it.children()) * sizeof *it.centre);
    batch.launch(geometry_, stream_);
}

void Pass::list_members(int i, std::uint64_t listed) {
    const std::size_t items = i == 0 ? static_cast<std::size_t>(scene.triangle_count()) : plan.members[0];
    const bool reaching = plan.warm_started && i == last_level();
    make_members(geometry_, stream_, level(i), items, balls_, listed, members_[i],
                 {reaching ? frames() : Frames{}, scene, primitives, points_.rows()}, &counters->members[i],
                 &counters->unplaced[i]);
}

void Pass::subdivide_scene() {
    if (!plan.warm_started) move_centres(0);
}

void Pass::subdivide_clusters(std::uint64_t listed) {
    for (int i = 0; i < plan.levels(); ++i) {
        if (!plan.warm_started) {
            if (i > 0) move_centres(i);
            list_members(i, listed);  // no child has places: only counts
            const Level it = level(i);
            make_places(stream_, it, members_[i].capacity, &counters->places[i]);
            BatchedClear batch;
            clear_members(batch, it, &counters->members[i], &counters->unplaced[i]);
            batch.copy(it.members_of.first, it.next_first,
                       (static_cast<std::size_t>(it.children()) + 1) * sizeof *it.next_first);
            batch.launch(geometry_, stream_);
        }
        list_members(i, listed);
        listed = ~std::uint64_t{0};
        if (plan.warm_started) prepare_next(i, beside->fork(stream_));
    }
}

// Computes the level's data for the warm start of the next pass, once the level's members are listed.
void Pass::prepare_next(int i, cudaStream_t stream) {
    const Level it = level(i);
    fuzzy_c_means(geometry_, stream, it, balls_, fuzziness(i), partial_);
    make_places(stream, it, members_[i].capacity, &counters->places[i]);
    if (i != last_level()) return;
    make_frames(geometry_, stream, plan.leaves(), it.members_of, members_[i].triangle, scene, points_, balls_,
                primitives.along_axes, warm_starts.next.frame);
}

void Pass::align() {
    if (plan.warm_started) return;
    const Segments leaves = members_of(last_level());
    const Members& members = members_[last_level()];
    make_frames(geometry_, stream_, plan.leaves(), leaves, members.triangle, scene, points_, balls_,
                primitives.along_axes, warm_starts.next.frame);
    BatchedClear batch;
    batch.copy(warm_starts.now.frame, warm_starts.next.frame,
               static_cast<std::size_t>(plan.leaves()) * sizeof *warm_starts.now.frame);
    batch.launch(geometry_, stream_);
    measure_extent(geometry_, stream_, plan.leaves(), leaves, members, scene, primitives, points_, balls_, frames());
}

}  // namespace crumple::cuda
