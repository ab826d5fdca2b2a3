#pragma once

// The stages of one leaf, `align` to `narrow`, on one worker's buffers; tiles of a large leaf on several workers.

#include "engine/cpu/order.h"
#include "engine/cpu/ownership.h"

namespace crumple::cpu {

/// What `narrow` needs to know, once the bounds are there.
NarrowContext narrow_context(const Call& call);

/// Reserves each worker's scratch for the largest ordinary leaf and for more than its share of the pairs, so that warm
/// calls allocate nothing. A worker that gets an unusually large leaf makes room for it then.
void make_room_for_workers(const Call& call);

/// False if the leaf holds no pair. Tells `ownership` of its members.
bool align_leaf(const Call& call, const PointRows& points, const Leaf& leaf, Ownership& ownership,
                WorkerBuffers& worker);

void sort_leaf(const Call& call, WorkerBuffers& worker);

/// Stages `sweep` and `narrow`. `in_tiles`: on several workers, if there is enough to do.
void sweep_leaf(const Call& call, const NarrowContext& context, const Ownership& ownership, bool in_tiles,
                WorkerBuffers& worker);

}  // namespace crumple::cpu
