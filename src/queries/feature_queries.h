#pragma once

// From what is asked of a detector about features to what a backend is asked about one scene.

#include <type_traits>

#include "crumple/candidates.h"
#include "crumple/motion.h"
#include "crumple/near.h"
#include "queries/candidate_query.h"
#include "queries/feature_query.h"

namespace crumple {

template <class Question>
constexpr bool is_motion = std::is_same_v<Question, Motion>;

inline Extent extent(const Motion& question) {
    if (question.wants == MotionWants::impacts) return Extent::all;
    return question.wants == MotionWants::earliest ? Extent::first : Extent::any;
}
inline Extent extent(const Near& question) { return question.wants == NearWants::pairs ? Extent::all : Extent::any; }

inline FeatureQuery query_of(const Motion& question, bool frugal, const SceneFeatures& features,
                             const GroupRule& rule) {
    return {true, extent(question), question.separation, question.separation_share, false, frugal, features, rule};
}
inline FeatureQuery query_of(const Near& question, bool frugal, const SceneFeatures& features, const GroupRule& rule) {
    return {false, extent(question), question.radius, 0, question.strict, frugal, features, rule};
}
inline CandidateQuery query_of(const CandidateQuestion& question, bool frugal, const SceneFeatures& features,
                               const GroupRule& rule) {
    CandidateQuery query{{}, question.inflation, frugal, features, rule};
    for (const CandidateKind kind : question.kinds) query.wanted[static_cast<std::size_t>(kind)] = true;
    return query;
}

}  // namespace crumple
