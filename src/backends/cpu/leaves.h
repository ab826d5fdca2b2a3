#pragma once

// The stages of one leaf (small set of triangles that one sweep searches), `align` to `narrow`, on one worker's
// buffers. Large leaves are swept in tiles (ranges of rows) by several workers.

#include "backends/cpu/order.h"
#include "backends/cpu/stages/ownership.h"

namespace crumple::cpu {

/// Reserves each worker's scratch for as many members as the largest leaf has, but at most for 4 * Options::leaf_size,
/// so that warm calls allocate nothing. A larger leaf grows its worker's scratch later. Does nothing under a memory
/// limit or with one worker.
void reserve_for_workers(const Call& call);

/// Runs `align` of a leaf. Returns false if the leaf has fewer than two members. Prepares `ownership` for its members.
bool align_leaf(const Call& call, const Leaf& leaf, Ownership& ownership, std::size_t worker);

void sort_leaf(const Call& call, std::size_t worker);

/// Runs stages `sweep` and `narrow`. `in_tiles`: true if several workers may sweep tiles of the leaf; they do so if it
/// is large, or in a stream.
void sweep_leaf(const Call& call, const Ownership& ownership, bool in_tiles, std::size_t worker);

}  // namespace crumple::cpu
