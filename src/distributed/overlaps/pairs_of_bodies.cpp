#include "distributed/overlaps/pairs_of_bodies.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "scene/body_filter.h"
#include "scene/near_bodies.h"

namespace crumple::distribute {

void PairsOfBodies::tabulate(Transport& transport, CollectiveCheck& agree, const Bodies& bodies,
                             std::span<const Row> mine) {
    constexpr std::size_t width = 8;
    std::vector<std::int64_t> numbers;
    agree(Phase::place, [&] {
        table_.assign(static_cast<std::size_t>(bodies.count()), {});
        numbers.assign(width * table_.size(), 0);
        for (std::size_t b = 0; b < mine.size(); ++b) {
            const Row& row = mine[b];
            std::int64_t* const to =
                numbers.data() + width * static_cast<std::size_t>(bodies.number_of(static_cast<std::int32_t>(b)));
            for (int axis = 0; axis < 3; ++axis) {
                to[axis] = std::bit_cast<std::int64_t>(row.box.low[axis]);
                to[3 + axis] = std::bit_cast<std::int64_t>(row.box.high[axis]);
            }
            to[6] = row.group;
            to[7] = row.closed;
        }
    });
    transport.reduce(numbers, Reduction::sum);  // only one rank has a body: the others contribute 0
    for (std::size_t b = 0; b < table_.size(); ++b) {
        const std::int64_t* const from = numbers.data() + width * b;
        Row& row = table_[b];
        for (int axis = 0; axis < 3; ++axis) {
            row.box.low[axis] = std::bit_cast<double>(from[axis]);
            row.box.high[axis] = std::bit_cast<double>(from[3 + axis]);
        }
        row.group = static_cast<std::int32_t>(from[6]);
        row.closed = from[7] != 0;
    }
}

void PairsOfBodies::list(const OverlapQuery& query) {
    const Shape none;
    const std::vector<Body> bodies(table_.size());
    WorldOutline outline(nullptr);
    outline.read({{&none, 1}, bodies, {}}, query.filter);
    BodyFilter rules(nullptr);
    rules.prepare(query.filter);
    NearBodies near(nullptr);
    near.prepare(outline, [&](std::int32_t body) { return row(body).box; });
    near_.clear();
    const auto add = [&](std::int32_t a, std::int32_t b) {
        if (rules.between(a, b) && rules.groups(row(a).group, row(b).group)) near_.push_back({a, b});
        return true;
    };
    for (std::int32_t world = 0; world < outline.worlds(); ++world) near.for_each_pair(world, add);
    for (std::int32_t b = 0; query.self_overlaps && b < outline.bodies(); ++b)
        if (rules.within(b, true) && rules.groups(row(b).group, row(b).group)) near_.push_back({b, b});
    std::sort(near_.begin(), near_.end());
    pairs_.clear();
    open_.clear();
    for (const auto& [a, b] : near_) {
        for (const std::int32_t body : {a, b})
            if (!row(body).closed) open_.push_back(body);
        const bool has_curves = query.open == OpenSurfaces::curves && a != b;
        if ((row(a).closed && row(b).closed) || has_curves) pairs_.push_back({a, b});
    }
}

void PairsOfBodies::assign(const Bodies& bodies, int ranks) {
    constexpr std::int64_t work_of_a_pair = 64;  // in triangles
    constexpr std::size_t most_ranks = 4;
    std::vector<std::int64_t> work;
    for (const auto& [a, b] : pairs_) work.push_back(bodies.triangles_of(a) + bodies.triangles_of(b) + work_of_a_pair);
    // Ranks near a pair: those that have provided its bodies, first that of the larger one, then those that search
    // another pair with one of the bodies. Of these, only the last few ranks that began with a body are tried, so that
    // a body in many pairs, such as a floor, does not cost the number of ranks in each of them; earlier ranks are
    // mostly full.
    std::map<std::int32_t, std::vector<int>> searching;  // ranks by body, the last one last
    std::vector<int> ranks_near;
    std::ptrdiff_t last = -1;
    const auto add_rank = [](int rank, std::vector<int>& ranks) {
        if (std::find(ranks.begin(), ranks.end(), rank) != ranks.end()) return;
        if (ranks.size() == most_ranks) ranks.erase(ranks.begin());
        ranks.push_back(rank);
    };
    const auto near_pair = [&](std::size_t k) {
        if (last >= 0)
            for (const std::int32_t body :
                 {pairs_[static_cast<std::size_t>(last)].first, pairs_[static_cast<std::size_t>(last)].second})
                add_rank(owners_.of(static_cast<std::int32_t>(last)), searching[body]);
        last = static_cast<std::ptrdiff_t>(k);
        auto [larger, smaller] = pairs_[k];
        if (bodies.triangles_of(smaller) > bodies.triangles_of(larger)) std::swap(larger, smaller);
        ranks_near = {bodies.rank_of(larger), bodies.rank_of(smaller)};
        for (const std::int32_t body : {larger, smaller})
            if (const auto at = searching.find(body); at != searching.end())
                ranks_near.insert(ranks_near.end(), at->second.rbegin(), at->second.rend());
        return std::span<const int>(ranks_near);
    };
    owners_.give_out(work, ranks, near_pair);
}

std::vector<BodyPair> PairsOfBodies::pairs_of(int rank) const {
    std::vector<BodyPair> pairs;
    for (const std::int32_t k : owners_.parts_of(rank)) pairs.push_back(pairs_[static_cast<std::size_t>(k)]);
    return pairs;
}

std::vector<std::pair<int, std::int32_t>> PairsOfBodies::destinations(const Bodies& bodies, int rank) const {
    std::vector<std::pair<int, std::int32_t>> to;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        const int owner = owners_.of(static_cast<std::int32_t>(k));
        for (const std::int32_t body : {pairs_[k].first, pairs_[k].second})
            if (owner != rank && bodies.rank_of(body) == rank) to.emplace_back(owner, body);
    }
    std::sort(to.begin(), to.end());
    to.erase(std::unique(to.begin(), to.end()), to.end());
    return to;
}

}  // namespace crumple::distribute
