#pragma once

// The stages of one leaf, `align` to `narrow`, on one worker's buffers; tiles of a large leaf on several workers.

#include "backends/cpu/order.h"
#include "backends/cpu/stages/ownership.h"

namespace crumple::cpu {

/// Reserves each worker's scratch for the largest ordinary leaf, so that warm calls allocate nothing; an unusually
/// large leaf grows its worker's scratch later. Does nothing under a memory limit or with one worker.
void reserve_for_workers(const Call& call);

/// Runs `align` of a leaf. Returns false if the leaf has fewer than two members. Prepares `ownership` for its members.
bool align_leaf(const Call& call, const Leaf& leaf, Ownership& ownership, std::size_t worker);

void sort_leaf(const Call& call, std::size_t worker);

/// Runs stages `sweep` and `narrow`. `in_tiles`: on several workers, if the leaf is large enough.
void sweep_leaf(const Call& call, const Ownership& ownership, bool in_tiles, std::size_t worker);

}  // namespace crumple::cpu
