#include "distributed/members.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace crumple::distribute {
namespace {

constexpr std::size_t vertices_at_once = 8192;

// Factor that lowers a value by more than a product and a difference in float32 can round it up.
constexpr float rounded_down = 1 - 1.0f / (1 << 22);

// Raises step[v] to the distance between the positions of vertex v in `reader` and in `before`, and updates `before`.
// Normalises coordinates before squaring, so that no relevant square underflows. The results are never less than the
// exact distances.
template <class Scalar>
void follow(const VertexReader& reader, const Normaliser& normalise, std::vector<Scalar>& before,
            std::vector<float>& step, std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
        const Vec3d p = reader(static_cast<std::int64_t>(v));
        Scalar* const old = before.data() + 3 * v;
        Vec3d way;
        for (int axis = 0; axis < 3; ++axis) {
            way[axis] = (p[axis] * normalise.pre - static_cast<double>(old[axis]) * normalise.pre) * normalise.post;
            old[axis] = static_cast<Scalar>(p[axis]);
        }
        step[v] = std::max(step[v], static_cast<float>(1.000001 * std::sqrt(dot(way, way))));
    }
}

}  // namespace

void RankMembers::forget() {
    entries_.clear(), part_.clear(), masks_.clear(), slack_.clear();
    parts_.clear(), is_listed_.clear();
    counts_.clear(), changes_.clear(), delta_.clear(), list_.clear(), send_whole_.clear();
    before_ = {}, before_at_end_ = {};
    entries_at_first_ = 0;
}

void RankMembers::update(const RankMesh& local, const PartLayout& layout, ParallelFor& workers) {
    const auto parts = static_cast<std::size_t>(layout.parts());
    const auto triangles = static_cast<std::size_t>(local.scene().triangle_count());
    depth_ = static_cast<std::size_t>(layout.tree().depth);
    entries_.resize(triangles);
    slack_.resize(triangles, -1.0f);
    is_listed_.resize(parts, 0);
    counts_.resize(parts, 0);
    changes_.resize(parts);
    delta_.resize(parts);
    list_.resize(parts);
    send_whole_.resize(parts, 0);
    measure_steps(local, layout, workers);

    const std::size_t slices = std::clamp<std::size_t>(triangles / 4096, 1, 256);
    std::vector<Found> found(slices);
    workers.parallel_for(slices, [&](std::size_t s) {
        found[s] = find_entries(local, layout, static_cast<std::int64_t>(s * triangles / slices),
                                static_cast<std::int64_t>((s + 1) * triangles / slices));
    });
    for (Found& slice : found) {
        std::size_t first = 0;
        for (std::size_t i = 0; i < slice.triangle.size(); ++i) {
            const auto n = static_cast<std::size_t>(slice.count[i]);
            take(slice.triangle[i], std::span(slice.part).subspan(first, n),
                 std::span(slice.masks).subspan(depth_ * first, depth_ * n));
            first += n;
        }
        slice = {};
    }
    std::sort(parts_.begin(), parts_.end());
    if (entries_at_first_ == 0) entries_at_first_ = part_.size();
}

// Measures how far each vertex has moved since the previous call (step_): the larger of the distances that its start
// and its end position have moved. Distances are in normalised coordinates, as those of slack_ are.
void RankMembers::measure_steps(const RankMesh& local, const PartLayout& layout, ParallelFor& workers) {
    const PreparedScene& scene = local.scene();
    step_.assign(static_cast<std::size_t>(scene.vertex_count()), 0);
    measure_steps(scene.reader[0], layout.normaliser(), before_, workers);
    if (scene.moving) measure_steps(scene.end, layout.normaliser(), before_at_end_, workers);
}

// Measures the distances of vertices from their positions in `before`, if it has as many vertices; else they are 0.
// Updates `before`.
void RankMembers::measure_steps(const VertexReader& reader, const Normaliser& normalise, Coordinates& before,
                                ParallelFor& workers) {
    const std::size_t n = step_.size();
    const auto measure = [&](auto& known) {
        const bool comparable = known.size() == 3 * n;
        known.resize(3 * n);
        const std::size_t slices = (n + vertices_at_once - 1) / vertices_at_once;
        workers.parallel_for(slices, [&](std::size_t s) {
            follow(reader, normalise, known, step_, s * vertices_at_once, std::min(n, (s + 1) * vertices_at_once));
        });
        if (!comparable) std::fill(step_.begin(), step_.end(), 0.0f);
    };
    if (reader.float32) {
        if (!std::holds_alternative<std::vector<float>>(before)) before = std::vector<float>();
        return measure(std::get<std::vector<float>>(before));
    }
    if (!std::holds_alternative<std::vector<double>>(before)) before = std::vector<double>();
    return measure(std::get<std::vector<double>>(before));
}

bool RankMembers::may_have_reached_a_part(const PreparedScene& scene, std::int64_t t) {
    const std::int32_t* const corners = scene.corners + 3 * t;
    const auto step = [&](int c) { return step_[static_cast<std::size_t>(corners[c])]; };
    float& slack = slack_[static_cast<std::size_t>(t)];
    slack = rounded_down * (slack - std::max({step(0), step(1), step(2)}));
    return !(slack > 0);
}

RankMembers::Found RankMembers::find_entries(const RankMesh& local, const PartLayout& layout, std::int64_t begin,
                                             std::int64_t end) {
    Found found;
    const PartTree tree = layout.tree();
    for (std::int64_t t = begin; t < end; ++t) {
        if (!may_have_reached_a_part(local.scene(), t)) continue;
        double slack = std::numeric_limits<float>::max();
        std::int32_t count = 0;
        tree.for_each_part(
            layout.ball(local.scene(), t),
            [&](std::int32_t part, const std::uint64_t* masks) {
                ++count;
                found.part.push_back(part);
                found.masks.insert(found.masks.end(), masks, masks + depth_);
            },
            &slack);
        slack_[static_cast<std::size_t>(t)] =
            rounded_down * static_cast<float>(std::min(layout.slack_of_path() * slack, 1e30));
        found.triangle.push_back(static_cast<std::int32_t>(t));
        found.count.push_back(count);
    }
    return found;
}

// Records how the parts of a triangle have changed. Old and new parts are ascending.
void RankMembers::take(std::int32_t triangle, std::span<const std::int32_t> parts,
                       std::span<const std::uint64_t> masks) {
    Entries& known = entries_[static_cast<std::size_t>(triangle)];
    bool same = static_cast<std::size_t>(known.count) == parts.size();
    std::size_t i = 0, j = static_cast<std::size_t>(known.first);
    const std::size_t end = j + static_cast<std::size_t>(known.count);
    const auto change = [&](std::int32_t part) -> Changes& { return changes_[static_cast<std::size_t>(part)]; };
    while (i < parts.size() || j < end) {
        const bool only_new = j == end || (i < parts.size() && parts[i] < part_[j]);
        const bool only_old = i == parts.size() || (j < end && part_[j] < parts[i]);
        if (only_new) {
            change(parts[i]).added.push_back(triangle);
            if (!std::exchange(is_listed_[static_cast<std::size_t>(parts[i])], 1)) parts_.push_back(parts[i]);
            ++counts_[static_cast<std::size_t>(parts[i++])];
            same = false;
        } else if (only_old) {
            change(part_[j]).removed.push_back(triangle);
            --counts_[static_cast<std::size_t>(part_[j++])];
            same = false;
        } else {
            const auto now = masks.subspan(depth_ * i, depth_), old = this->masks(j);
            if (!std::equal(now.begin(), now.end(), old.begin())) {
                change(parts[i]).changed.push_back(triangle);
                same = false;
            }
            ++i, ++j;
        }
    }
    if (same) return;
    if (parts.size() > static_cast<std::size_t>(known.count)) known.first = static_cast<std::int32_t>(part_.size());
    known.count = static_cast<std::int32_t>(parts.size());
    const std::size_t first = static_cast<std::size_t>(known.first);
    if (part_.size() < first + parts.size()) {
        part_.resize(first + parts.size());
        masks_.resize(depth_ * part_.size());
    }
    std::copy(parts.begin(), parts.end(), part_.begin() + static_cast<std::ptrdiff_t>(first));
    std::copy(masks.begin(), masks.end(), masks_.begin() + static_cast<std::ptrdiff_t>(depth_ * first));
}

std::int64_t RankMembers::bytes_of_changes() {
    send_some_whole();
    std::size_t rows = 0;
    for (const std::int32_t part : parts_) {
        const Changes& changes = changes_[static_cast<std::size_t>(part)];
        rows += changes.removed.size() + changes.changed.size() + changes.added.size();
    }
    return static_cast<std::int64_t>(rows * (sizeof(MemberRow) + depth_ * sizeof(std::uint64_t)));
}

void RankMembers::make_rows(std::span<const std::int32_t> parts, const RankMesh& local, const GhostVertices& copies) {
    Places places;
    const auto put_masks = [&](std::int32_t part, std::int32_t triangle, std::vector<std::uint64_t>& to) {
        const Entries& entries = entries_[static_cast<std::size_t>(triangle)];
        auto e = static_cast<std::size_t>(entries.first);
        while (part_[e] != part) ++e;
        const auto of_levels = masks(e);
        to.insert(to.end(), of_levels.begin(), of_levels.end());
    };
    for (const std::int32_t part : parts) {
        const auto k = static_cast<std::size_t>(part);
        Changes& changes = changes_[k];
        PartDelta& delta = delta_[k];
        delta = {};
        for (const std::int32_t t : changes.removed) delta.removed.push_back(local.triangles()(t));
        for (const std::int32_t t : changes.changed) {
            delta.changed.push_back(local.triangles()(t));
            put_masks(part, t, delta.changed_masks);
        }
        delta.added_masks.reserve(depth_ * changes.added.size());
        for (const std::int32_t t : changes.added) put_masks(part, t, delta.added_masks);
        number_corners(k, local, copies, places);
        changes = {};
    }
}

// Lists all members of parts with a new owner as added.
void RankMembers::send_some_whole() {
    if (std::find(send_whole_.begin(), send_whole_.end(), 1) == send_whole_.end()) return;
    for (std::size_t k = 0; k < send_whole_.size(); ++k)
        if (send_whole_[k]) changes_[k] = {}, list_[k] = {};
    for (std::size_t t = 0; t < entries_.size(); ++t)
        for (std::int32_t e = entries_[t].first; e < entries_[t].first + entries_[t].count; ++e) {
            const auto k = static_cast<std::size_t>(part_[static_cast<std::size_t>(e)]);
            if (send_whole_[k]) changes_[k].added.push_back(static_cast<std::int32_t>(t));
        }
    std::fill(send_whole_.begin(), send_whole_.end(), std::uint8_t{0});
}

void RankMembers::number_corners(std::size_t k, const RankMesh& local, const GhostVertices& copies, Places& places) {
    const std::vector<std::int32_t>& triangles = changes_[k].added;
    if (triangles.empty()) return;
    const PreparedScene& scene = local.scene();
    std::vector<std::int32_t>&place = places.place, &stamp = places.stamp;
    place.resize(static_cast<std::size_t>(scene.vertex_count()));
    stamp.resize(place.size(), -1);
    std::vector<std::int32_t>& list = list_[k].vertices;
    PartDelta& delta = delta_[k];
    const auto part = static_cast<std::int32_t>(k);
    const auto set = [&](std::int32_t v, std::size_t listed) {
        places.place[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(listed);
        places.stamp[static_cast<std::size_t>(v)] = part;
    };
    for (std::size_t i = 0; i < list.size(); ++i) set(list[i], i);
    const bool first = list.empty();
    delta.added.reserve(triangles.size());
    for (const std::int32_t t : triangles) {
        MemberRow row{local.triangles()(t), scene.group(t), {}};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t v = scene.corners[3 * std::int64_t{t} + static_cast<std::int64_t>(c)];
            if (stamp[static_cast<std::size_t>(v)] != part) {
                set(v, list.size());
                list.push_back(v);
                delta.vertices.push_back(copies.shared(v) ? local.vertices()(v) : -1 - local.vertices()(v));
            }
            row.corners[c] = place[static_cast<std::size_t>(v)];
        }
        delta.added.push_back(row);
        if (features_) delta.added_features.push_back(features_->of(t));
    }
    if (first) list_[k].at_first = list.size();
}

DeltaCounts RankMembers::counts_of_delta(std::int32_t part) const {
    const PartDelta& delta = delta_[static_cast<std::size_t>(part)];
    const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
    return {size(delta.removed), size(delta.changed), size(delta.added), size(delta.vertices), size(vertices(part))};
}

void RankMembers::sent(std::span<const std::int32_t> parts) {
    for (const std::int32_t part : parts) delta_[static_cast<std::size_t>(part)] = {};
}

bool RankMembers::stale() const {
    std::size_t at_first = 0, now = 0;
    for (const std::int32_t part : parts_) {
        const VertexList& list = list_[static_cast<std::size_t>(part)];
        at_first += list.at_first, now += list.vertices.size();
    }
    return now > at_first + at_first / 2 + 1000 || part_.size() > 2 * entries_at_first_ + 1000;
}

}  // namespace crumple::distribute
