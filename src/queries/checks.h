#pragma once

// Checks of options and queries. Each check throws Error (invalid_argument) if a requirement is violated.

#include "crumple/candidates.h"
#include "crumple/distances.h"
#include "crumple/impacts.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "crumple/world.h"

namespace crumple {

/// Throws the Error with this message unless the condition holds.
void check(bool holds, const char* message);

void check_options(const Options& options);
/// `b`: null for one mesh.
void check_query(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
void check_query_options(const IntersectionQuery& query);
/// Checks the filter of an intersection query with containment for this world.
void check_containment(const IntersectionQuery& query, const World& world);
/// `world`: true for a query about a world, false for a single mesh.
void check_query_options(const ImpactQuery& query, bool world);
void check_query_options(const ProximityQuery& query, bool world);
void check_query_options(const CandidateQuery& query, bool world);
void check_query_options(const DistanceQuery& query);
void check_query_options(const OverlapQuery& query, const World& world);
/// Checks the filter of groups for a single mesh with this number of triangles.
void check_groups(const PairFilter& rules, std::int64_t triangles, bool has_groups);
/// True if poses in device memory are given.
inline bool given(const DevicePoses& poses) { return poses.data || poses.count > 0; }
inline bool lies_on_device(const World& world) { return given(world.device_poses) || given(world.device_end_poses); }
void check_device_poses(const World& world);
/// Rejects queries that Detector::launch() does not support for worlds.
void check_on_device(const IntersectionQuery& query);
void check_blocks(std::int64_t block_rows);
/// Rejects queries whose results cannot be delivered in blocks (Detector::stream).
void check_in_blocks(const ImpactQuery& query);
void check_in_blocks(const ProximityQuery& query);
void check_in_blocks(const IntersectionQuery& query);
void check_in_blocks(const OverlapQuery& query);
inline void check_in_blocks(const CandidateQuery&) {}

}  // namespace crumple
