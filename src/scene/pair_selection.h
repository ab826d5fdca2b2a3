#pragma once

// Filter of pairs of triangles. It filters by groups, and in a scene made from a world also by bodies. In such a scene
// the triangles of one body and one group form a class, and the scene's groups are indices of classes. Compiled for
// host and device.

#include <cstdint>

#include "scene/group_selection.h"

namespace crumple {

struct alignas(16) BodyClass {
    std::int32_t body = 0, group = 0;
    std::uint32_t self : 1 = 1;        ///< Body::self: pairs within the body count
    std::uint32_t everywhere : 1 = 0;  ///< true: a body in all worlds, to be paired only with bodies of one world
    std::uint32_t grouped : 1 = 1;     ///< false: in no group, so filters of groups do not apply
    friend bool operator==(const BodyClass&, const BodyClass&) = default;
};

struct PairSelection {
    GroupSelection groups;
    GroupSelection bodies;               ///< filter of pairs of bodies
    const BodyClass* classes = nullptr;  ///< classes of a scene made from a world; null for other scenes
    friend bool operator==(const PairSelection&, const PairSelection&) = default;

    /// True if every pair is selected: callers may skip the test.
    CRUMPLE_HD bool all() const { return !classes && groups.all(); }

    CRUMPLE_HD bool operator()(const BodyClass& a, const BodyClass& b) const {
        if ((a.everywhere && b.everywhere) || (a.body == b.body && !a.self) || !bodies(a.body, b.body)) return false;
        return !a.grouped || !b.grouped || groups(a.group, b.group);
    }
    /// `g` and `h` are indices of classes in a scene made from a world, else groups.
    CRUMPLE_HD bool operator()(std::int32_t g, std::int32_t h) const {
        if (!classes) return groups(g, h);
        const BodyClass a = classes[g], b = classes[h];  // copies: one aligned load of 16 bytes can fetch each
        return (*this)(a, b);
    }
};

}  // namespace crumple
