#include "distributed/assembled_part.h"

#include <algorithm>
#include <utility>

namespace crumple::distribute {

AssembledPart::AssembledPart(std::int32_t index, int count, std::vector<PartLevel> levels, bool float32, bool groups)
    : groups_(groups) {
    part_.index = index;
    part_.count = count;
    part_.levels = std::move(levels);
    if (float32)
        part_.mesh.vertices = std::vector<float>();
    else
        part_.mesh.vertices = std::vector<double>();
}

std::int64_t AssembledPart::bytes() const {
    const auto depth = static_cast<std::int64_t>(part_.levels.size());
    const std::int64_t scalar = std::holds_alternative<std::vector<float>>(part_.mesh.vertices) ? 4 : 8;
    return size() * (24 + 8 * depth + (features_ ? 40 : 0)) + vertex_count_ * 3 * scalar * (moving_ ? 2 : 1);
}

void AssembledPart::take(std::span<const RankDelta> news) {
    bool other_triangles = false;
    for (const RankDelta& some : news) {
        add_vertices(some);
        other_triangles = other_triangles || !some.delta.removed.empty() || !some.delta.added.empty();
    }
    if (other_triangles) merge(news);
    change_masks(news);
    const auto has_news = [](const RankDelta& some) {
        return !some.delta.changed.empty() || !some.delta.vertices.empty();
    };
    revision_ += other_triangles || std::any_of(news.begin(), news.end(), has_news);
}

void AssembledPart::add_vertices(const RankDelta& news) {
    const std::vector<std::int32_t>& ids = news.delta.vertices;
    const auto rank = static_cast<std::size_t>(news.rank);
    if (runs_.size() <= rank) runs_.resize(rank + 1);
    if (ids.empty()) return;
    std::vector<Run>& runs = runs_[rank];
    const std::int64_t listed = runs.empty() ? 0 : runs.back().first + runs.back().count;
    const auto n = static_cast<std::int64_t>(ids.size());
    if (!runs.empty() && runs.back().place + runs.back().count == vertex_count_)
        runs.back().count += n;
    else
        runs.push_back({listed, vertex_count_, n});
    for (std::int64_t i = 0; i < n; ++i) {
        const std::int32_t id = ids[static_cast<std::size_t>(i)], place = static_cast<std::int32_t>(vertex_count_ + i);
        if (features_) vertex_id_.push_back(id < 0 ? -1 - id : id);
        if (id < 0) continue;
        const auto [at, is_first] = first_.try_emplace(id, place);
        if (!is_first) copy_.emplace(place, at->second);
    }
    vertex_count_ += n;
    const auto resize = [&](auto& xyz) { xyz.resize(static_cast<std::size_t>(3 * vertex_count_)); };
    std::visit(resize, part_.mesh.vertices);
    if (moving_) std::visit(resize, end_);
}

std::int32_t AssembledPart::vertex(int rank, std::int32_t listed) const {
    const std::vector<Run>& runs = runs_[static_cast<std::size_t>(rank)];
    std::size_t i = 0;
    while (listed >= runs[i].first + runs[i].count) ++i;
    const auto place = static_cast<std::int32_t>(runs[i].place + (listed - runs[i].first));
    if (copy_.empty()) return place;
    const auto copy = copy_.find(place);
    return copy == copy_.end() ? place : copy->second;
}

// Merges the triangles with the added ones, both by ascending id, and drops the removed ones.
void AssembledPart::merge(std::span<const RankDelta> news) {
    struct New {
        std::int32_t id;
        std::int32_t news, row;
    };
    std::vector<New> added;
    std::vector<std::int32_t> removed;
    std::size_t count = 0;
    for (const RankDelta& some : news) count += some.delta.added.size();
    added.reserve(count);
    for (std::size_t s = 0; s < news.size(); ++s) {
        const PartDelta& delta = news[s].delta;
        for (std::size_t i = 0; i < delta.added.size(); ++i)
            added.push_back({delta.added[i].id, static_cast<std::int32_t>(s), static_cast<std::int32_t>(i)});
        removed.insert(removed.end(), delta.removed.begin(), delta.removed.end());
    }
    const auto by_id = [](const New& a, const New& b) { return a.id < b.id; };
    if (!std::is_sorted(added.begin(), added.end(), by_id)) std::sort(added.begin(), added.end(), by_id);
    std::sort(removed.begin(), removed.end());

    PartMesh& mesh = part_.mesh;
    const std::size_t before = mesh.ids.size(), size = before + added.size() - removed.size();
    const std::size_t depth = part_.levels.size();
    PartMesh merged;
    std::vector<std::int32_t> rank;
    std::vector<std::vector<std::uint64_t>> masks(depth);
    std::vector<OwnedFeatures> owned;
    merged.ids.reserve(size);
    merged.corners.reserve(3 * size);
    if (groups_) merged.groups.reserve(size);
    rank.reserve(size);
    for (auto& of_level : masks) of_level.reserve(size);

    std::size_t next = 0, gone = 0;
    const auto add_until = [&](std::int64_t id) {
        for (; next < added.size() && added[next].id < id; ++next) {
            const RankDelta& from = news[static_cast<std::size_t>(added[next].news)];
            const auto row = static_cast<std::size_t>(added[next].row);
            const MemberRow& member = from.delta.added[row];
            merged.ids.push_back(member.id);
            if (groups_) merged.groups.push_back(member.group);
            for (const std::int32_t corner : member.corners) merged.corners.push_back(vertex(from.rank, corner));
            rank.push_back(from.rank);
            for (std::size_t l = 0; l < depth; ++l) masks[l].push_back(from.delta.added_masks[depth * row + l]);
            if (features_) owned.push_back(from.delta.added_features[row]);
        }
    };
    for (std::size_t i = 0; i < before; ++i) {
        add_until(mesh.ids[i]);
        if (gone < removed.size() && removed[gone] == mesh.ids[i]) {
            ++gone;
            continue;
        }
        merged.ids.push_back(mesh.ids[i]);
        if (groups_) merged.groups.push_back(mesh.groups[i]);
        merged.corners.insert(merged.corners.end(), mesh.corners.begin() + static_cast<std::ptrdiff_t>(3 * i),
                              mesh.corners.begin() + static_cast<std::ptrdiff_t>(3 * i + 3));
        rank.push_back(rank_[i]);
        for (std::size_t l = 0; l < depth; ++l) masks[l].push_back(part_.levels[l].masks[i]);
        if (features_) owned.push_back(owned_[i]);
    }
    add_until(std::int64_t{1} << 32);
    mesh.ids = std::move(merged.ids);
    mesh.corners = std::move(merged.corners);
    mesh.groups = std::move(merged.groups);
    rank_ = std::move(rank);
    owned_ = std::move(owned);
    for (std::size_t l = 0; l < depth; ++l) part_.levels[l].masks = std::move(masks[l]);
}

void AssembledPart::change_masks(std::span<const RankDelta> news) {
    const std::vector<std::int32_t>& ids = part_.mesh.ids;
    const std::size_t depth = part_.levels.size();
    for (const RankDelta& some : news)
        for (std::size_t i = 0; i < some.delta.changed.size(); ++i) {
            const auto at =
                static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), some.delta.changed[i]) - ids.begin());
            for (std::size_t l = 0; l < depth; ++l) part_.levels[l].masks[at] = some.delta.changed_masks[depth * i + l];
        }
}

}  // namespace crumple::distribute
