#pragma once

// From what is asked of a detector about features to what a backend is asked about one scene.

#include <type_traits>

#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "queries/candidate_request.h"
#include "queries/feature_request.h"

namespace crumple {

template <class Question>
constexpr bool is_motion = std::is_same_v<Question, ImpactQuery>;

inline Extent extent(const ImpactQuery& question) {
    if (question.output == Output::pairs) return Extent::all;
    return question.output == Output::first ? Extent::first : Extent::any;
}
inline Extent extent(const ProximityQuery& question) {
    return question.output == Output::pairs ? Extent::all : Extent::any;
}

inline FeatureRequest query_of(const ImpactQuery& question, bool frugal, const SceneFeatures& features,
                               const GroupRule& rule) {
    return {true, extent(question), question.min_distance, question.min_distance_share, false, frugal, features, rule};
}
inline FeatureRequest query_of(const ProximityQuery& question, bool frugal, const SceneFeatures& features,
                               const GroupRule& rule) {
    return {false, extent(question), question.radius, 0, question.strict, frugal, features, rule};
}
inline CandidateRequest query_of(const CandidateQuery& question, bool frugal, const SceneFeatures& features,
                                 const GroupRule& rule) {
    CandidateRequest query{{}, question.inflation, frugal, features, rule};
    for (const CandidateKind kind : question.kinds) query.wanted[static_cast<std::size_t>(kind)] = true;
    return query;
}

}  // namespace crumple
