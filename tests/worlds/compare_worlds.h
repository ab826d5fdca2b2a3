#pragma once

#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <tuple>

#include "agreement/compare.h"

namespace crumple::test {

using Row = std::tuple<std::int32_t, std::int32_t, std::int32_t, std::int32_t>;

inline std::set<Row> rows_of(const Intersections& c) {
    std::set<Row> rows;
    for (std::size_t i = 0; i < c.pairs.size(); ++i)
        rows.emplace(c.bodies[i].first, c.pairs[i].a, c.bodies[i].second, c.pairs[i].b);
    return rows;
}

/// Compares complete results of worlds: pairs as sets, so that a failure lists them, everything else byte by byte.
inline testing::AssertionResult same_world_result(const Intersections& found, const Intersections& expected) {
    const std::set<Row> ours = rows_of(found), theirs = rows_of(expected);
    std::ostringstream text;
    const auto list = [&](const char* what, const std::set<Row>& in, const std::set<Row>& not_in) {
        for (const auto& [a, s, b, t] : in)
            if (!not_in.count({a, s, b, t}))
                text << what << " triangle " << s << " of body " << a << " with triangle " << t << " of body " << b
                     << "; ";
    };
    if (found.pairs.size() == found.bodies.size() && expected.pairs.size() == expected.bodies.size()) {
        list("missing:", theirs, ours);
        list("unexpected:", ours, theirs);
    }
    if (!text.str().empty()) return testing::AssertionFailure() << text.str();
    if (found.any != expected.any || found.count != expected.count)
        return testing::AssertionFailure() << "any " << found.any << ", count " << found.count << " instead of "
                                           << expected.any << ", " << expected.count;
    testing::AssertionResult same = same_bytes(found.bodies, expected.bodies, "bodies");
    if (same) same = same_bytes(found.pairs, expected.pairs, "pairs");
    if (same) same = same_bytes(found.world_hit, expected.world_hit, "flags of worlds");
    if (same) same = same_bytes(found.world_counts, expected.world_counts, "counts of worlds");
    if (same) same = same_bytes(found.world_offsets, expected.world_offsets, "offsets of worlds");
    if (same) same = same_bytes(found.body_offsets, expected.body_offsets, "offsets of bodies");
    if (same) same = same_bytes(found.first_triangle, expected.first_triangle, "first triangles");
    if (same) same = same_bytes(found.hit, expected.hit, "hit flags");
    if (same) same = same_bytes(found.contacts.kinds, expected.contacts.kinds, "contact kinds");
    if (same) same = same_bytes(found.contacts.offsets, expected.contacts.offsets, "contact offsets");
    if (same) same = same_bytes(found.contacts.points, expected.contacts.points, "contact points");
    return same;
}

}  // namespace crumple::test
