#pragma once

// From the rows of one scene to the public results: impacts, proximities and candidates differ in names alone.

#include <concepts>

#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "queries/feature_request.h"

namespace crumple {

/// Empty answers whose arrays the meter counts.
Impacts metered_impacts(MemoryMeter* meter);
Proximities metered_nearby(MemoryMeter* meter);
Candidates metered_candidates(MemoryMeter* meter);

template <class Answer>
Answer metered_answer(MemoryMeter* meter);

/// Swaps the contents of two answers, and clears `mine`.
void hand_over(Impacts& mine, Impacts& theirs);
void hand_over(Proximities& mine, Proximities& theirs);
void hand_over(Candidates& mine, Candidates& theirs);

/// Forgets what an answer says, keeps its memory.
void clear(Impacts& answer);
void clear(Proximities& answer);
void clear(Candidates& answer);
void clear(ImpactList& list);
void clear(ProximityList& list);
void clear(CandidateList& list);

/// True if rows have values and flags.
template <class List>
constexpr bool has_values = !std::same_as<List, CandidateList>;

// The arrays of a list, by what they are in both results.
inline Array<double>& values(ImpactList& list) { return list.toi; }
inline Array<double>& values(ProximityList& list) { return list.squared_distance; }
inline Array<std::uint8_t>& flags(ImpactList& list) { return list.start; }
inline Array<std::uint8_t>& flags(ProximityList& list) { return list.touching; }

/// Swaps the rows of a list, which has no others.
template <class List>
void swap_rows(List& list, FeatureRows& rows) {
    list.pairs.swap_elements(rows.pairs);
    if constexpr (has_values<List>) {
        values(list).swap_elements(rows.value);
        flags(list).swap_elements(rows.flag);
    }
}

/// Offsets by first and by second feature, of which there are so many.
void make_index(ImpactList& list, std::int64_t firsts, std::int64_t seconds);
void make_index(ProximityList& list, std::int64_t firsts, std::int64_t seconds);

}  // namespace crumple
