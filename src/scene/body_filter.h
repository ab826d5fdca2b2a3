#pragma once

// Pair filter of a world's triangles by bodies and groups, prepared for look-up. In a scene made from a world, the
// triangles of one body and one group form a class (BodyClass, pair_selection.h); the scene's groups are indices of
// classes.

#include <algorithm>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/query.h"
#include "crumple/world.h"
#include "scene/pair_selection.h"

namespace crumple {

class BodyFilter {
   public:
    explicit BodyFilter(MemoryMeter* meter) : classes(meter), excluded_bodies_(meter), excluded_groups_(meter) {}

    void prepare(const PairFilter& rules) {
        bodies_ = rules.bodies;
        groups_ = rules.groups;
        const auto keys = [](const auto& pairs, Array<std::uint64_t>& out) {
            out.resize_discard(pairs.size());
            std::transform(pairs.begin(), pairs.end(), out.begin(),
                           [](const auto& p) { return GroupSelection::key(p.first, p.second); });
            std::sort(out.begin(), out.end());
        };
        keys(rules.excluded_bodies, excluded_bodies_);
        keys(rules.excluded_groups, excluded_groups_);
    }

    /// True if the filter allows pairs of triangles within a body (within(); `self` is its Body::self), of two
    /// different bodies (between()), or of two groups (groups()).
    bool within(std::int32_t body, bool self) const { return self && wanted().bodies(body, body); }
    bool between(std::int32_t a, std::int32_t b) const { return wanted().bodies(a, b); }
    bool groups(std::int32_t g, std::int32_t h) const { return wanted().groups(g, h); }
    /// True if the filter allows all pairs of groups.
    bool allows_all_groups() const { return groups_ == PairScope::both && excluded_groups_.empty(); }

    /// Returns a view of the filter; valid while this object is unchanged.
    PairSelection wanted() const {
        return {rule(groups_, excluded_groups_), rule(bodies_, excluded_bodies_), classes.data()};
    }
    bool operator()(const BodyClass& a, const BodyClass& b) const { return wanted()(a, b); }
    bool operator()(std::int32_t a, std::int32_t b) const { return (*this)(classes[a], classes[b]); }

    /// True if the filter selects no pair of triangles of the same class.
    bool classes_apart() const {
        return std::none_of(classes.begin(), classes.end(), [&](const BodyClass& c) { return (*this)(c, c); });
    }

    Array<BodyClass> classes;  ///< body and group of each class of the current scene

   private:
    static GroupSelection rule(PairScope wanted, const Array<std::uint64_t>& excluded) {
        return {wanted == PairScope::between, wanted == PairScope::within, excluded.data(),
                static_cast<std::int64_t>(excluded.size())};
    }

    PairScope bodies_ = PairScope::both, groups_ = PairScope::both;
    Array<std::uint64_t> excluded_bodies_, excluded_groups_;
};

}  // namespace crumple
