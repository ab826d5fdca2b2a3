#include "distribute/members.h"

#include <algorithm>
#include <utility>

namespace crumple::distribute {

void Members::list(const Share& share, const Placement& placement, ParallelFor& workers) {
    const Scene& scene = share.scene();
    const auto ball = [&](std::int64_t t) { return placement.ball(scene.triangle(t)); };
    const std::vector<PartMembers> slices =
        list_members(placement.tree(), placement.parts(), ball, scene.triangle_count(), workers);
    const auto parts = static_cast<std::size_t>(placement.parts());
    const auto depth = static_cast<std::size_t>(placement.tree().depth);
    now_.resize(parts);
    sent_.resize(parts);
    counts_.assign(parts, 0);
    workers.parallel_for(parts, [&](std::size_t k) {
        Sent& now = now_[k];
        now.triangles.clear();
        now.masks.clear();
        for (const PartMembers& slice : slices) {
            const auto begin = static_cast<std::ptrdiff_t>(slice.first[k]),
                       end = static_cast<std::ptrdiff_t>(slice.first[k + 1]);
            const auto levels = static_cast<std::ptrdiff_t>(depth);
            now.triangles.insert(now.triangles.end(), slice.triangle.begin() + begin, slice.triangle.begin() + end);
            now.masks.insert(now.masks.end(), slice.masks.begin() + levels * begin, slice.masks.begin() + levels * end);
        }
        counts_[k] = static_cast<std::int64_t>(now.triangles.size());
    });
}

void Members::compare(const Share& share, const SharedVertices& copies, int depth) {
    const auto n = static_cast<std::size_t>(share.scene().vertex_count());
    place_.resize(n);
    stamp_.assign(n, -1);
    delta_.resize(now_.size());
    for (std::size_t k = 0; k < now_.size(); ++k) compare_part(k, share, copies, static_cast<std::size_t>(depth));
}

// Both lists ascend.
void Members::compare_part(std::size_t k, const Share& share, const SharedVertices& copies, std::size_t depth) {
    const Sent &before = sent_[k], &now = now_[k];
    PartDelta& delta = delta_[k];
    delta = {};
    std::vector<std::int32_t> added;
    const auto same_masks = [&](std::size_t i, std::size_t j) {
        return std::equal(now.masks.begin() + static_cast<std::ptrdiff_t>(depth * i),
                          now.masks.begin() + static_cast<std::ptrdiff_t>(depth * (i + 1)),
                          before.masks.begin() + static_cast<std::ptrdiff_t>(depth * j));
    };
    const auto put_masks = [&](std::vector<std::uint64_t>& to, std::size_t i) {
        for (std::size_t l = 0; l < depth; ++l) to.push_back(now.masks[depth * i + l]);
    };
    std::size_t j = 0;
    const auto remove_until = [&](std::int32_t triangle) {
        for (; j < before.triangles.size() && before.triangles[j] < triangle; ++j)
            delta.removed.push_back(share.triangles()(before.triangles[j]));
    };
    for (std::size_t i = 0; i < now.triangles.size(); ++i) {
        const std::int32_t t = now.triangles[i];
        remove_until(t);
        if (j == before.triangles.size() || before.triangles[j] != t) {
            added.push_back(t);
            put_masks(delta.added_masks, i);
            continue;
        }
        if (!same_masks(i, j)) {
            delta.changed.push_back(share.triangles()(t));
            put_masks(delta.changed_masks, i);
        }
        ++j;
    }
    remove_until(static_cast<std::int32_t>(share.scene().triangle_count()));
    add_corners(k, added, share, copies);
}

void Members::add_corners(std::size_t k, std::span<const std::int32_t> triangles, const Share& share,
                          const SharedVertices& copies) {
    if (triangles.empty()) return;
    const Scene& scene = share.scene();
    std::vector<std::int32_t>& list = sent_[k].vertices;
    PartDelta& delta = delta_[k];
    const auto part = static_cast<std::int32_t>(k);
    const auto set = [&](std::int32_t v, std::size_t place) {
        place_[static_cast<std::size_t>(v)] = static_cast<std::int32_t>(place);
        stamp_[static_cast<std::size_t>(v)] = part;
    };
    for (std::size_t i = 0; i < list.size(); ++i) set(list[i], i);
    delta.added.reserve(triangles.size());
    for (const std::int32_t t : triangles) {
        MemberRow row{share.triangles()(t), scene.group(t), {}};
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t v = scene.corners[3 * std::int64_t{t} + static_cast<std::int64_t>(c)];
            if (stamp_[static_cast<std::size_t>(v)] != part) {
                set(v, list.size());
                list.push_back(v);
                delta.vertices.push_back(copies.shared(v) ? share.vertices()(v) : -1);
            }
            row.corners[c] = place_[static_cast<std::size_t>(v)];
        }
        delta.added.push_back(row);
    }
}

DeltaCounts Members::counts_of_delta(std::int32_t part) const {
    const PartDelta& delta = delta_[static_cast<std::size_t>(part)];
    const auto size = [](const auto& list) { return static_cast<std::int64_t>(list.size()); };
    return {size(delta.removed), size(delta.changed), size(delta.added), size(delta.vertices), size(vertices(part))};
}

void Members::sent() {
    for (std::size_t k = 0; k < now_.size(); ++k) {
        Sent& of = sent_[k];
        if (of.triangles.empty()) of.vertices_at_first = of.vertices.size();
        std::swap(of.triangles, now_[k].triangles);
        std::swap(of.masks, now_[k].masks);
        delta_[k] = {};
    }
}

bool Members::stale() const {
    std::size_t at_first = 0, now = 0;
    for (const Sent& of : sent_) at_first += of.vertices_at_first, now += of.vertices.size();
    return now > at_first + at_first / 2 + 1000;
}

}  // namespace crumple::distribute
