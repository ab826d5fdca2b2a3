#pragma once

// Pair filter of a search: by the groups of the query or, for a scene made from a world, by the BodyFilter of that
// world.

#include <algorithm>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/query.h"
#include "scene/body_filter.h"
#include "scene/pair_selection.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Pair filter by the groups of a scene's triangles, prepared for look-up.
class SceneFilter {
   public:
    explicit SceneFilter(MemoryMeter* meter = nullptr) : excluded_(meter) {}

    /// Frees its memory.
    void release() { excluded_.release(); }

    /// `bodies`: for a scene whose groups are classes (body_filter.h), the filter that decides instead of `filter`;
    /// else null.
    void prepare(const PairFilter& filter, const BodyFilter* bodies = nullptr) {
        bodies_ = bodies;
        classes_apart_ = bodies && bodies->classes_apart();
        wanted_ = filter.groups;
        excluded_.resize_discard(filter.excluded_groups.size());
        std::transform(filter.excluded_groups.begin(), filter.excluded_groups.end(), excluded_.begin(),
                       [](GroupPair p) { return GroupSelection::key(p.first, p.second); });
        std::sort(excluded_.begin(), excluded_.end());
    }
    /// True if every pair is selected: callers may skip the test.
    bool trivial() const { return !bodies_ && of_groups().all(); }

    /// True if no pair of triangles of the same group (or class) is selected.
    bool groups_apart() const { return bodies_ ? classes_apart_ : wanted_ == PairScope::between; }

    /// Returns a view of the filter; valid while this object is unchanged.
    PairSelection wanted() const { return bodies_ ? bodies_->wanted() : PairSelection{of_groups(), {}, nullptr}; }
    bool operator()(std::int32_t g, std::int32_t h) const { return bodies_ ? (*bodies_)(g, h) : of_groups()(g, h); }

    /// Returns a view of the query's filter of groups; valid while this object is unchanged.
    GroupSelection of_groups() const {
        return {wanted_ == PairScope::between, wanted_ == PairScope::within, excluded_.data(),
                static_cast<std::int64_t>(excluded_.size())};
    }

   private:
    const BodyFilter* bodies_ = nullptr;
    bool classes_apart_ = false;
    PairScope wanted_ = PairScope::both;
    Array<std::uint64_t> excluded_;
};

}  // namespace crumple
