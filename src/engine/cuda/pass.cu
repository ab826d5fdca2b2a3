#include "engine/cuda/pass.h"

#include <algorithm>

#include "engine/cuda/align.h"

namespace crumple::cuda {
namespace {

constexpr int samples_of_scene = 2048, samples_per_child = 32;  // points that place centres

}  // namespace

void Centres::cut(Cutter& cutter) {
    centre[0] = cutter.take<Row<float>>(max_fan_out);
    centre[1] = cutter.take<Row<float>>(max_fan_out * max_fan_out);
    moved[0] = cutter.take<float>(1);
    moved[1] = cutter.take<float>(max_fan_out);
}

void Pass::cut(Cutter& c) {
    const auto vertices = static_cast<std::size_t>(scene.vertex_count());
    const auto triangles = static_cast<std::size_t>(scene.triangle_count());
    const auto leaves = static_cast<std::size_t>(plan.leaves());
    const std::size_t rows = plan.last_members(), groups = (rows + 31) / 32 + 1;

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
    cursor_ = c.take<unsigned long long>(leaves);
    for (int i = 0; i < plan.levels(); ++i) {
        count_[i] = c.take<unsigned long long>(i == 0 ? static_cast<std::size_t>(plan.fan_out[0]) : leaves);
        mask_[i] = c.take<std::uint64_t>(i == 0 ? triangles : plan.members[0]);
        child_first_[i] = c.take<unsigned long long>((i == 0 ? static_cast<std::size_t>(plan.fan_out[0]) : leaves) + 1);
        const auto room = plan.members[i];
        members_[i] = {c.take<std::int32_t>(room), c.take<std::uint32_t>(room), c.take<std::uint16_t>(room), room};
    }
    frames_ = c.take<Frame>(leaves);
    sorted_.bin = c.take<std::uint32_t>(rows);
    sorted_.rank = c.take<std::uint32_t>(rows);
    sorted_.bin_first = c.take<std::uint32_t>(leaves * bins + 1);
    sorted_.box = c.take<CrossBox>(rows);
    records_.record = c.take<Record>(rows);
    sorted_.conflict = c.take<std::uint64_t>(rows);
    sorted_.end = c.take<std::uint32_t>(rows);
    sorted_.triangle = c.take<std::int32_t>(rows);
    sorted_.leaf = c.take<std::uint16_t>(rows);
    sorted_.group_end = c.take<std::uint32_t>(groups);
    sorted_.unit_first = c.take<unsigned long long>(groups);
    scratch_.scan_bytes = sort_scratch_bytes(plan.leaves(), rows);
    scratch_.scan = c.take<std::byte>(scratch_.scan_bytes);
    survivors_ = c.take<Candidate>(plan.survivors);
    undecided_ = c.take<Candidate>(plan.undecided);
    beyond_ = c.take<Pair>(plan.beyond);
    hits_ = c.take<Hit>(plan.hits);
}

Level Pass::level(int i) const {
    if (i == 0)
        return {1,         plan.fan_out[0],   nullptr,          static_cast<unsigned long long>(scene.triangle_count()),
                nullptr,   centres.centre[0], centres.moved[0], mask_[0],
                count_[0], cursor_,           child_first_[0]};
    return {plan.fan_out[0],  plan.fan_out[1], child_first_[0], 0,       members_[0].triangle, centres.centre[1],
            centres.moved[1], mask_[1],        count_[1],       cursor_, child_first_[1]};
}

Fuzziness Pass::fuzziness(int i) const {
    return {static_cast<float>(options_.fuzziness), plan.cold ? options_.first_iterations : options_.max_iterations,
            static_cast<float>(plan.cold ? options_.first_stop : options_.stop), plan.cold,
            i == 0 ? samples_of_scene : samples_per_child * plan.fan_out[1]};
}

Ownership Pass::ownership() const {
    if (plan.levels() == 1) return {nullptr, mask_[0], plan.fan_out[0]};
    return {mask_[0], mask_[1], plan.fan_out[1]};
}

void Pass::clear(Clearing& clearing) const {
    cuda::clear(clearing, counters);
    for (int i = 0; i < plan.levels(); ++i) cuda::clear(clearing, level(i));
    cuda::clear(clearing, sorted_, plan.leaves());
}

void Pass::clear_counters() {
    Clearing clearing;
    cuda::clear(clearing, counters);
    clearing.launch(geometry_, stream_);
}

void Pass::bounds() { compute_bounds(geometry_, stream_, scene, box, points_, balls_, counters); }

void Pass::subdivide_scene() { fuzzy_c_means(geometry_, stream_, level(0), balls_, fuzziness(0), partial_); }

void Pass::subdivide_clusters(std::uint64_t listed) {
    make_members(geometry_, stream_, level(0), static_cast<std::size_t>(scene.triangle_count()), balls_, listed,
                 members_[0], &counters->members[0]);
    if (plan.levels() == 1) return;
    fuzzy_c_means(geometry_, stream_, level(1), balls_, fuzziness(1), partial_);
    make_members(geometry_, stream_, level(1), plan.members[0], balls_, ~std::uint64_t{0}, members_[1],
                 &counters->members[1]);
}

void Pass::align() {
    make_frames(geometry_, stream_, plan.leaves(), leaf_first(), members_[plan.levels() - 1].triangle, scene, points_,
                balls_, frames_);
}

void Pass::sort() {
    sort_members(geometry_, stream_, scene, points_, plan.leaves(), leaf_first(), members_[plan.levels() - 1], frames_,
                 ownership(), sorted_, records_, scratch_, counters);
}

void Pass::sweep(const Slice& slice) {
    cuda::sweep(geometry_, stream_, scene, sorted_, leaf_first() + plan.leaves(), ownership(), groups,
                PlaneTest{records_.record, policy}, {survivors_, &counters->survivors, plan.survivors}, slice,
                counters);
}

void Pass::narrow(const Hits& hits) {
    cuda::narrow(geometry_, stream_, scene, sorted_, records_, points_, frames_, policy,
                 {survivors_, &counters->survivors, plan.survivors}, {undecided_, &counters->undecided, plan.undecided},
                 {beyond_, &counters->beyond, plan.beyond}, hits, &counters->doubles);
}

}  // namespace crumple::cuda
