#pragma once

// Which pairs of a world's triangles are wanted, by bodies and groups. Triangles of one body and one group are a class;
// a scene made of a world has classes where others have groups.

#include <algorithm>
#include <cstdint>

#include "crumple/array.h"
#include "crumple/world.h"
#include "model/group_rule.h"

namespace crumple {

struct BodyClass {
    std::int32_t body = 0, group = 0;
    bool self = true;         ///< Body::self
    bool everywhere = false;  ///< in all worlds: such bodies meet only those of the world that is searched
    bool grouped = true;      ///< else of no group, and rules about groups say nothing of it
};

class BodyRules {
   public:
    explicit BodyRules(MemoryMeter* meter) : classes(meter), excluded_bodies_(meter), excluded_groups_(meter) {}

    void prepare(const Rules& rules) {
        bodies_ = rules.bodies;
        groups_ = rules.groups;
        const auto keys = [](const auto& pairs, Array<std::uint64_t>& out) {
            out.resize_discard(pairs.size());
            std::transform(pairs.begin(), pairs.end(), out.begin(),
                           [](const auto& p) { return WantedGroups::key(p.first, p.second); });
            std::sort(out.begin(), out.end());
        };
        keys(rules.excluded_bodies, excluded_bodies_);
        keys(rules.excluded_groups, excluded_groups_);
    }

    /// Whether pairs within a body may be wanted, and pairs of two different bodies.
    bool within(std::int32_t body, bool self) const {
        return self && bodies_ != Wanted::between && !contains(excluded_bodies_, body, body);
    }
    bool between(std::int32_t a, std::int32_t b) const {
        return bodies_ != Wanted::within && !contains(excluded_bodies_, a, b);
    }
    bool groups(std::int32_t g, std::int32_t h) const {
        if (groups_ == Wanted::between && g == h) return false;
        if (groups_ == Wanted::within && g != h) return false;
        return !contains(excluded_groups_, g, h);
    }
    /// Nothing hangs on groups.
    bool any_group() const { return groups_ == Wanted::both && excluded_groups_.empty(); }

    bool operator()(const BodyClass& a, const BodyClass& b) const {
        if (a.everywhere && b.everywhere) return false;
        const bool wanted = a.body == b.body ? within(a.body, a.self) : between(a.body, b.body);
        return wanted && (!a.grouped || !b.grouped || groups(a.group, b.group));
    }
    bool operator()(std::int32_t a, std::int32_t b) const { return (*this)(classes[a], classes[b]); }

    /// No pair within a class is wanted.
    bool classes_apart() const {
        return std::none_of(classes.begin(), classes.end(), [&](const BodyClass& c) { return (*this)(c, c); });
    }

    Array<BodyClass> classes;  ///< of the scene that is searched

   private:
    static bool contains(const Array<std::uint64_t>& keys, std::int32_t a, std::int32_t b) {
        return !keys.empty() && std::binary_search(keys.begin(), keys.end(), WantedGroups::key(a, b));
    }

    Wanted bodies_ = Wanted::both, groups_ = Wanted::both;
    Array<std::uint64_t> excluded_bodies_, excluded_groups_;
};

}  // namespace crumple
