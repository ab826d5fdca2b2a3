#pragma once

// The stages of one leaf, `align` to `narrow`, on one worker's buffers; tiles of a large leaf on several workers.

#include "backends/cpu/order.h"
#include "backends/cpu/stages/ownership.h"

namespace crumple::cpu {

/// Reserves each worker's scratch for the largest ordinary leaf, so that warm calls allocate nothing. A worker that
/// gets an unusually large leaf makes room for it then.
void make_room_for_workers(const Call& call);

/// False if the leaf holds no pair. Tells `ownership` of its members.
bool align_leaf(const Call& call, const Leaf& leaf, Ownership& ownership, std::size_t worker);

void sort_leaf(const Call& call, std::size_t worker);

/// Stages `sweep` and `narrow`. `in_tiles`: on several workers, if there is enough to do.
void sweep_leaf(const Call& call, const Ownership& ownership, bool in_tiles, std::size_t worker);

}  // namespace crumple::cpu
