#pragma once

// A question as ranks compare it: what all of them have to ask alike, and what the phases need to know of it.

#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/impacts.h"
#include "crumple/options.h"
#include "crumple/proximities.h"
#include "distributed/feature_assembly.h"

namespace crumple::distribute {

/// How much of the intersections is made; contacts are rows.
enum class RankOutput : std::uint8_t { any, count, pairs, body_pairs };

struct Asked {
    std::vector<std::int64_t> told;         ///< numbers that have to be the same on all ranks
    std::optional<FeatureDemand> features;  ///< of questions about features
    bool between_groups = false;            ///< pairs within a group are not wanted, and groups are needed
};

/// Throws Error (invalid_argument) for what makes no sense, or is not for ranks.
Asked asked_by(const IntersectionQuery& query, RankOutput output);
/// `world`: asked of bodies, of which rules may speak.
Asked asked_by(const ImpactQuery& question, bool world);
Asked asked_by(const ProximityQuery& question, bool world);
/// The same for bodies.
Asked asked_by(const IntersectionQuery& question);
RankOutput output_of(const IntersectionQuery& question);

}  // namespace crumple::distribute
