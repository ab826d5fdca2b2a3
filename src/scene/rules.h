#pragma once

// Which pairs of triangles a query wants, by sides, groups and parts; everything but geometry.

#include <algorithm>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/query.h"
#include "scene/body_rules.h"
#include "scene/prepared_scene.h"
#include "scene/wanted_pairs.h"

namespace crumple {

/// Group rules of a query, prepared for look-up.
class GroupRule {
   public:
    explicit GroupRule(MemoryMeter* meter = nullptr) : excluded_(meter) {}

    /// Gives its memory back.
    void release() { excluded_.release(); }

    /// `bodies`: of a scene whose groups are classes of bodies, and which decides instead of the query; else null.
    void prepare(const PairFilter& filter, const BodyRules* bodies = nullptr) {
        bodies_ = bodies;
        classes_apart_ = bodies && bodies->classes_apart();
        wanted_ = filter.groups;
        excluded_.resize_discard(filter.excluded_groups.size());
        std::transform(filter.excluded_groups.begin(), filter.excluded_groups.end(), excluded_.begin(),
                       [](GroupPair p) { return WantedGroups::key(p.first, p.second); });
        std::sort(excluded_.begin(), excluded_.end());
    }
    /// Every pair is wanted: callers may skip the test.
    bool trivial() const { return !bodies_ && of_groups().all(); }

    /// No pair within a group is wanted.
    bool groups_apart() const { return bodies_ ? classes_apart_ : wanted_ == PairScope::between; }

    /// The rule by itself; valid while this is as it is.
    WantedPairs wanted() const { return bodies_ ? bodies_->wanted() : WantedPairs{of_groups(), {}, nullptr}; }
    bool operator()(std::int32_t g, std::int32_t h) const { return bodies_ ? (*bodies_)(g, h) : of_groups()(g, h); }

    /// What the query says of groups; likewise.
    WantedGroups of_groups() const {
        return {wanted_ == PairScope::between, wanted_ == PairScope::within, excluded_.data(),
                static_cast<std::int64_t>(excluded_.size())};
    }

   private:
    const BodyRules* bodies_ = nullptr;
    bool classes_apart_ = false;
    PairScope wanted_ = PairScope::both;
    Array<std::uint64_t> excluded_;
};

}  // namespace crumple
