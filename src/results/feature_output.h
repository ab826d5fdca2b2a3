#pragma once

// Converts the rows of one scene to public results. Impacts, proximities and candidates differ only in the names of
// arrays.

#include <concepts>

#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "queries/feature_request.h"

namespace crumple {

/// Returns an empty result whose arrays are counted by the meter.
Impacts metered_impacts(MemoryMeter* meter);
Proximities metered_nearby(MemoryMeter* meter);
Candidates metered_candidates(MemoryMeter* meter);

template <class Answer>
Answer metered_result(MemoryMeter* meter);

/// Moves the result `mine` to `theirs`. `mine` keeps the memory of `theirs`, emptied.
void swap_out(Impacts& mine, Impacts& theirs);
void swap_out(Proximities& mine, Proximities& theirs);
void swap_out(Candidates& mine, Candidates& theirs);

/// Empties a result or a list, but keeps its memory.
void clear(Impacts& answer);
void clear(Proximities& answer);
void clear(Candidates& answer);
void clear(ImpactList& list);
void clear(ProximityList& list);
void clear(CandidateList& list);

/// True if rows of this list have values and flags: all but candidates do.
template <class List>
constexpr bool has_values = !std::same_as<List, CandidateList>;

// Arrays of a list, by their common meaning in impacts and proximities.
inline Array<double>& values(ImpactList& list) { return list.toi; }
inline Array<double>& values(ProximityList& list) { return list.squared_distance; }
inline Array<std::uint8_t>& flags(ImpactList& list) { return list.start; }
inline Array<std::uint8_t>& flags(ProximityList& list) { return list.touching; }

/// Swaps all rows of a list with `rows`.
template <class List>
void swap_rows(List& list, FeatureRows& rows) {
    list.pairs.swap_elements(rows.pairs);
    if constexpr (has_values<List>) {
        values(list).swap_elements(rows.value);
        flags(list).swap_elements(rows.flag);
    }
}

/// Makes the offsets of a list's pairs by their first and by their second feature. `firsts`, `seconds`: numbers of
/// features that can be first or second.
void make_index(ImpactList& list, std::int64_t firsts, std::int64_t seconds, Cancellation& cancellation);
void make_index(ProximityList& list, std::int64_t firsts, std::int64_t seconds, Cancellation& cancellation);

}  // namespace crumple
