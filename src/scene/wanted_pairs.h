#pragma once

// Which pairs of triangles a query wants, by their groups; in a scene that is made of a world, by bodies and groups.
// Triangles of one body and one group are a class then, and have classes where others have groups. Compiled for host
// and device.

#include <cstdint>

#include "scene/group_rule.h"

namespace crumple {

struct alignas(16) BodyClass {
    std::int32_t body = 0, group = 0;
    std::uint32_t self : 1 = 1;        ///< Body::self
    std::uint32_t everywhere : 1 = 0;  ///< in all worlds: such bodies meet only those of the world that is searched
    std::uint32_t grouped : 1 = 1;     ///< else of no group, and rules about groups say nothing of it
    friend bool operator==(const BodyClass&, const BodyClass&) = default;
};

struct WantedPairs {
    WantedGroups groups;
    WantedGroups bodies;                 ///< the same about pairs of bodies
    const BodyClass* classes = nullptr;  ///< of a world; else null, and nothing is said of bodies
    friend bool operator==(const WantedPairs&, const WantedPairs&) = default;

    /// Every pair is: callers may skip the test.
    CRUMPLE_HD bool all() const { return !classes && groups.all(); }

    CRUMPLE_HD bool operator()(const BodyClass& a, const BodyClass& b) const {
        if ((a.everywhere && b.everywhere) || (a.body == b.body && !a.self) || !bodies(a.body, b.body)) return false;
        return !a.grouped || !b.grouped || groups(a.group, b.group);
    }
    /// Of two groups, or of two classes.
    CRUMPLE_HD bool operator()(std::int32_t g, std::int32_t h) const {
        if (!classes) return groups(g, h);
        const BodyClass a = classes[g], b = classes[h];  // copied by four words at a time
        return (*this)(a, b);
    }
};

}  // namespace crumple
