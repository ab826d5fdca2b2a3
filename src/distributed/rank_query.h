#pragma once

// Query in the form that ranks compare: the values that must be equal on all ranks, and what the phases of a call need
// to know about the query.

#include <cstdint>
#include <optional>
#include <vector>

#include "crumple/impacts.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "distributed/feature_assembly.h"

namespace crumple::distribute {

/// Output of a query about intersections; contacts are part of the pairs' rows.
enum class RankOutput : std::uint8_t { any, count, pairs, body_pairs };

struct ComparedQuery {
    std::vector<std::int64_t> values;       ///< values that must be equal on all ranks
    std::optional<FeatureDemand> features;  ///< set for queries about features
    bool between_groups = false;            ///< only pairs between groups are requested, so groups are required
};

/// Converts a query about meshes. Throws Error (invalid_argument) if it is invalid, or not supported on ranks.
ComparedQuery request_of_ranks(const IntersectionQuery& query, RankOutput output);
/// `world`: true for a query about bodies, whose pair filter may name them.
ComparedQuery request_of_ranks(const ImpactQuery& query, bool world);
ComparedQuery request_of_ranks(const ProximityQuery& query, bool world);
/// Converts a query about bodies.
ComparedQuery request_of_ranks(const IntersectionQuery& query);
/// `world`: the local bodies of the rank.
ComparedQuery request_of_ranks(const OverlapQuery& query, const World& world);
/// Converts a query about the overlap of a mesh with itself. `mesh`: the local mesh of the rank.
ComparedQuery request_of_ranks(const OverlapQuery& query, const MeshView& mesh);
RankOutput output_of(const IntersectionQuery& query);

}  // namespace crumple::distribute
