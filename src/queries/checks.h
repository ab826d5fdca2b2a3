#pragma once

// What a detector's options and questions must be; each function throws Error (invalid_argument) if they are not.

#include "crumple/candidates.h"
#include "crumple/distances.h"
#include "crumple/impacts.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "crumple/world.h"

namespace crumple {

/// Throws with this message unless the condition holds.
void check(bool holds, const char* message);

void check_options(const Options& options);
/// `b`: null for one mesh.
void check_query(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
/// `world`: asked of a world, else of a single mesh.
void check_question(const IntersectionQuery& question);
/// Checks a query with containment about a world.
void check_containment(const IntersectionQuery& query, const World& world);
void check_question(const ImpactQuery& question, bool world);
void check_question(const ProximityQuery& question, bool world);
void check_question(const CandidateQuery& question, bool world);
void check_question(const DistanceQuery& question);
void check_question(const OverlapQuery& query, const World& world);
/// Of a single mesh, with so many triangles.
void check_groups(const PairFilter& rules, std::int64_t triangles, bool has_groups);
/// Whether a world's poses do.
inline bool given(const DevicePoses& poses) { return poses.data || poses.count > 0; }
inline bool lies_on_device(const World& world) { return given(world.device_poses) || given(world.device_end_poses); }
void check_device_poses(const World& world);
/// What cannot be answered there.
void check_on_device(const IntersectionQuery& question);
void check_blocks(std::int64_t block_rows);
/// What cannot be answered in blocks.
void check_in_blocks(const ImpactQuery& question);
void check_in_blocks(const ProximityQuery& question);
void check_in_blocks(const IntersectionQuery& query);
inline void check_in_blocks(const CandidateQuery&) {}

}  // namespace crumple
