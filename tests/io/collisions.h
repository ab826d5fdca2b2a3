#pragma once

// Handmade result of three pairs and, on request, their contacts: one of each kind.

#include <cstdint>
#include <vector>

#include "crumple/intersections.h"

namespace crumple::io::test {

inline Intersections example(bool contacts) {
    Intersections c;
    c.pairs.push_back({0, 2});
    c.pairs.push_back({0, INT32_MAX});
    c.pairs.push_back({1, 2});
    for (const std::int64_t offset : {0, 2, 3, 3}) c.offsets.push_back(offset);
    for (const std::uint8_t hit : std::vector<std::uint8_t>{1, 1, 1}) c.hit.push_back(hit);
    c.statistics.pairs = 3;
    c.statistics.backend = "cpu";
    c.statistics[Stage::sweep] = 1.5;
    if (!contacts) return c;
    for (const ContactKind kind : {ContactKind::point, ContactKind::segment, ContactKind::area}) {
        c.contacts.kinds.push_back(kind);
    }
    for (const std::int64_t offset : {0, 1, 3, 6}) c.contacts.offsets.push_back(offset);
    for (const double x : {0.1, -2.0, 1e300, 5e-324, 1.0 / 3, 0.0}) c.contacts.points.push_back({x, x, 1});
    return c;
}

}  // namespace crumple::io::test
