#pragma once

// Comparison of complete results about impacts and proximities, byte by byte; statistics are ignored.

#include "agreement/compare.h"

namespace crumple::test {

inline const Array<double>& values_of(const ImpactList& list) { return list.toi; }
inline const Array<double>& values_of(const ProximityList& list) { return list.squared_distance; }
inline const Array<std::uint8_t>& flags_of(const ImpactList& list) { return list.start; }
inline const Array<std::uint8_t>& flags_of(const ProximityList& list) { return list.touching; }

template <class List>
testing::AssertionResult same_list(const List& found, const List& expected) {
    testing::AssertionResult same = same_pairs(found.pairs.span(), expected.pairs.span());
    if (same || !found.bodies.empty()) same = same_bytes(found.pairs, expected.pairs, "pairs");
    if (same) same = same_bytes(found.bodies, expected.bodies, "bodies");
    if (same) same = same_bytes(values_of(found), values_of(expected), "values");
    if (same) same = same_bytes(flags_of(found), flags_of(expected), "flags");
    if (same) same = same_bytes(found.offsets, expected.offsets, "offsets");
    if (same) same = same_bytes(found.second_offsets, expected.second_offsets, "offsets by second feature");
    if (same) same = same_bytes(found.by_second, expected.by_second, "positions by second feature");
    return same;
}

inline testing::AssertionResult same_first(const FirstImpact& found, const FirstImpact& expected) {
    if (found == expected) return testing::AssertionSuccess();
    const auto text = [](const FirstImpact& f) {
        return testing::PrintToString(f.found) + ' ' + std::string(feature_kind_name(f.kind)) + ' ' +
               testing::PrintToString(f.pair) + " at " + testing::PrintToString(f.toi);
    };
    return testing::AssertionFailure() << "first is " << text(found) << " instead of " << text(expected);
}

template <class Result>
testing::AssertionResult same_features(const Result& found, const Result& expected) {
    testing::AssertionResult same = testing::AssertionSuccess();
    for (std::size_t kind = 0; same && kind < feature_kinds; ++kind) {
        same = same_list(found.lists[kind], expected.lists[kind]);
        if (!same) same << " (" << feature_kind_name(static_cast<FeatureKind>(kind)) << ')';
    }
    if (same) same = same_bytes(found.edges, expected.edges, "edges");
    if (same) same = same_bytes(found.first_edge, expected.first_edge, "first edges");
    if (same) same = same_bytes(found.points, expected.points, "points");
    if (same) same = same_bytes(found.first_point, expected.first_point, "first points");
    if (same) same = same_bytes(found.world_hit, expected.world_hit, "flags of worlds");
    if (same && (found.any != expected.any || found.count != expected.count))
        same = testing::AssertionFailure() << "any " << found.any << ", count " << found.count << " instead of "
                                           << expected.any << ", " << expected.count;
    if constexpr (requires { found.first; }) {
        if (same) same = same_list(found.triangle_pairs, expected.triangle_pairs);
        if (same) same = same_first(found.first, expected.first);
        if (same && found.world_first.size() != expected.world_first.size())
            same = testing::AssertionFailure() << "another number of worlds";
        for (std::size_t w = 0; same && w < found.world_first.size(); ++w)
            same = same_first(found.world_first[w], expected.world_first[w]);
    }
    return same;
}

/// Returns the first impact of a result that lists all impacts, found by looking at each.
inline FirstImpact first_listed(const Impacts& impacts) {
    FirstImpact first;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const ImpactList& list = impacts.lists[k];
        for (std::size_t i = 0; i < list.pairs.size(); ++i)
            if (!first.found || list.toi[i] < first.toi)
                first = {true, static_cast<FeatureKind>(k), list.pairs[i], {}, list.toi[i], list.start[i] != 0};
    }
    return first;
}

}  // namespace crumple::test
