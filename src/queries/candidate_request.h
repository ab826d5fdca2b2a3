#pragma once

// What a backend is asked about candidates among the features of one scene, and what it answers.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/array.h"
#include "crumple/candidates.h"
#include "crumple/intersections.h"
#include "queries/feature_request.h"
#include "scene/rules.h"
#include "scene/scene_features.h"

namespace crumple {

struct CandidateRequest {
    std::array<bool, candidate_kinds> wanted{};  ///< by CandidateKind
    double inflation = 0;
    bool frugal = false;  ///< as FeatureRequest::frugal
    const SceneFeatures& features;
    const GroupRule& rule;

    bool wants(CandidateKind kind) const { return wanted[static_cast<std::size_t>(kind)]; }
};

/// Indices of the scene's points, edges, triangles. Sorted, unique.
struct CandidateAnswer {
    explicit CandidateAnswer(MemoryMeter* m)
        : pairs{Array<Pair>(m), Array<Pair>(m), Array<Pair>(m), Array<Pair>(m), Array<Pair>(m), Array<Pair>(m)} {}
    std::array<Array<Pair>, candidate_kinds> pairs;  ///< by CandidateKind
    Statistics statistics;
};

/// Forgets what an answer says, keeps its memory.
inline void clear(CandidateAnswer& answer) {
    for (auto& list : answer.pairs) list.clear();
    answer.statistics = {};
}

/// Candidates by kind: CandidateAnswer::pairs, unsorted.
using CandidateHits = std::array<Array<Pair>, candidate_kinds>;
using CandidateStream = RowStream<CandidateHits>;

CRUMPLE_HD constexpr FeatureTypes types_of(CandidateKind kind) {
    constexpr auto vertex = FeatureType::vertex, edge = FeatureType::edge, face = FeatureType::face;
    constexpr FeatureTypes types[candidate_kinds] = {{vertex, face}, {edge, edge},   {edge, face},
                                                     {face, face},   {vertex, edge}, {vertex, vertex}};
    return types[static_cast<std::size_t>(kind)];
}

}  // namespace crumple
