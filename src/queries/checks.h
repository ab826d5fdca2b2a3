#pragma once

// What a detector's options and questions must be; each function throws Error (invalid_argument) if they are not.

#include "crumple/candidates.h"
#include "crumple/mesh.h"
#include "crumple/motion.h"
#include "crumple/near.h"
#include "crumple/nearest.h"
#include "crumple/options.h"
#include "crumple/world.h"

namespace crumple {

/// Throws with this message unless the condition holds.
void check(bool holds, const char* message);

void check_options(const Options& options);
/// `b`: null for one mesh.
void check_query(const MeshView& a, const MeshView* b, const Query& query);
/// `world`: asked of a world, else of a single mesh.
void check_question(const Motion& question, bool world);
void check_question(const Near& question, bool world);
void check_question(const CandidateQuestion& question, bool world);
void check_question(const Nearest& question);
/// Of a single mesh, with so many triangles.
void check_groups(const Rules& rules, std::int64_t triangles, bool has_groups);
/// Whether a world's poses do.
inline bool given(const DevicePoses& poses) { return poses.data || poses.count > 0; }
inline bool lies_on_device(const World& world) { return given(world.device_poses) || given(world.device_end_poses); }
void check_device_poses(const World& world);
/// What cannot be answered there.
void check_on_device(const Intersect& question);
void check_blocks(const Streaming& how);
/// What cannot be answered in blocks.
void check_in_blocks(const Motion& question);
void check_in_blocks(const Near& question);
inline void check_in_blocks(const CandidateQuestion&) {}

}  // namespace crumple
