#pragma once

// Converts queries about features to requests to a backend about one scene.

#include <type_traits>

#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "queries/feature_request.h"

namespace crumple {

template <class Query>
constexpr bool is_motion = std::is_same_v<Query, ImpactQuery>;
template <class Query>
constexpr bool is_near = std::is_same_v<Query, ProximityQuery>;
template <class Query>
constexpr bool is_candidates = std::is_same_v<Query, CandidateQuery>;

/// Enum that indexes the lists in the query's result.
template <class Query>
using KindOf = std::conditional_t<is_candidates<Query>, CandidateKind, FeatureKind>;

inline Extent extent(const ImpactQuery& query) {
    if (query.output == Output::pairs) return Extent::all;
    return query.output == Output::first ? Extent::first : Extent::any;
}
inline Extent extent(const ProximityQuery& query) { return query.output == Output::pairs ? Extent::all : Extent::any; }
inline Extent extent(const CandidateQuery&) { return Extent::all; }

/// Returns the kinds of pairs to list. If all features belong to triangles, vertex-edge and vertex-vertex pairs are
/// redundant: a vertex that touches an edge or a vertex also touches a face that has it.
inline RequestedKinds listed_kinds(const SceneFeatures& features) {
    const bool others = !features.plain();
    return {true, true, false, false, others, others};
}
inline RequestedKinds listed_kinds(const CandidateQuery& query) {
    RequestedKinds kinds{};
    for (const CandidateKind kind : query.kinds) kinds[static_cast<std::size_t>(kind)] = true;
    return kinds;
}

inline FeatureRequest request_of(const ImpactQuery& query, bool low_memory, const SceneFeatures& features,
                                 const SceneFilter& rule) {
    return {.criterion = Criterion::impact,
            .extent = extent(query),
            .kinds = listed_kinds(features),
            .distance = query.min_distance,
            .share = query.min_distance_share,
            .approaching_only = query.approaching_only,
            .low_memory = low_memory,
            .features = features,
            .rule = rule};
}
inline FeatureRequest request_of(const ProximityQuery& query, bool low_memory, const SceneFeatures& features,
                                 const SceneFilter& rule) {
    return {.criterion = Criterion::proximity,
            .extent = extent(query),
            .kinds = listed_kinds(features),
            .distance = query.radius,
            .strict = query.strict,
            .low_memory = low_memory,
            .features = features,
            .rule = rule};
}
inline FeatureRequest request_of(const CandidateQuery& query, bool low_memory, const SceneFeatures& features,
                                 const SceneFilter& rule) {
    return {.criterion = Criterion::candidate,
            .kinds = listed_kinds(query),
            .distance = query.inflation,
            .neighbours = query.neighbours,
            .low_memory = low_memory,
            .features = features,
            .rule = rule};
}

}  // namespace crumple
