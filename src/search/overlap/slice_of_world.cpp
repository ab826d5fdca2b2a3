#include "search/overlap/slice_of_world.h"

#include <algorithm>

namespace crumple {

SliceOfWorld::SliceOfWorld(const World& world, const PairFilter& filter, std::span<const BodyPair> near,
                           std::span<const BodyPair> pairs)
    : shapes_(world.shapes), filter_(filter) {
    for (const auto& [a, b] : pairs) ids_.insert(ids_.end(), {a, b});
    std::sort(ids_.begin(), ids_.end());
    ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
    for (const std::int32_t id : ids_) {
        bodies_.push_back(world.bodies[static_cast<std::size_t>(id)]);
        bodies_.back().self = std::binary_search(pairs.begin(), pairs.end(), BodyPair{id, id});
        if (!world.poses.empty()) poses_.push_back(world.poses[static_cast<std::size_t>(id)]);
    }
    // The user's excluded pairs are not near pairs; those of bodies of the slice are excluded again.
    filter_.excluded_bodies.clear();
    for (const BodyPair& pair : filter.excluded_bodies)
        if (const BodyPair mine{place_of(pair.first), place_of(pair.second)}; mine.first >= 0 && mine.second >= 0)
            filter_.excluded_bodies.push_back(mine);
    exclude_other_pairs(near, pairs);
}

// Returns the index of a body within the slice, or −1.
std::int32_t SliceOfWorld::place_of(std::int32_t body) const {
    const auto at = std::lower_bound(ids_.begin(), ids_.end(), body);
    return at == ids_.end() || *at != body ? -1 : static_cast<std::int32_t>(at - ids_.begin());
}

void SliceOfWorld::exclude_other_pairs(std::span<const BodyPair> near, std::span<const BodyPair> pairs) {
    for (std::size_t i = 0; i < ids_.size(); ++i)
        for (auto at = std::lower_bound(near.begin(), near.end(), BodyPair{ids_[i], -1});
             at != near.end() && at->first == ids_[i]; ++at) {
            const std::int32_t second = place_of(at->second);
            if (second < 0 || at->first == at->second || std::binary_search(pairs.begin(), pairs.end(), *at)) continue;
            filter_.excluded_bodies.push_back({static_cast<std::int32_t>(i), second});
        }
}

}  // namespace crumple
