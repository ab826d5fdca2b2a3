#pragma once

// Stage `sort`: members of each leaf by the start of their interval ([MZ] sec. 3), by a counting sort into bins. Within
// a bin the order does not matter: each row takes all rows behind it up to its last bin's end, and box tests decide.
// What a question keeps of a member is written beside the member's box, from the same corners. A leaf is sorted within
// its own places, so that no prefix sums go across leaves; rows that are left over are nobody's.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/clearing.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Who handles a pair: a leaf owns it iff no lower cluster of any level holds both triangles. The last level's clusters
/// are bits of SortedRow::conflict; the upper level is looked up for the pairs that are left.
struct Ownership {
    const std::uint64_t* upper_mask;  ///< by triangle, of the first of two levels, or null
    const std::uint64_t* last_mask;   ///< by member of the first level, or by triangle if there is one level
    int last_fan_out;
    int upper_fan_out;  ///< of each world; 1 if there is one level
};

/// What sort_members() finds cleared.
void clear(Clearing& clearing, const Sorted& sorted, int leaves);

/// `Primitive`: what is searched of each triangle. `Records`: what the question keeps of each member, with a function
/// of the device put(row, triangle, its corners as `Primitive` has them, ids, member in its frame, frame). Defined in
/// sort_kernel.h.
template <class Primitive, class Records>
void sort_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Points& points,
                  int leaves, const Segments& members_of, const Members& members, const Frames& frames,
                  const Ownership& ownership, const Sorted& sorted, const Primitive& primitive, const Records& records,
                  const List<Unit>& units, Counters* counters);

/// Its first part: the bins of each member, and where each bin's rows begin.
template <class Primitive>
void bin_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Primitive& primitive,
                 const Points& points, int leaves, const Segments& members_of, const Members& members,
                 const Frames& frames, const Sorted& sorted);
/// Its last part: units of work.
void list_units(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                std::size_t capacity, const Sorted& sorted, const List<Unit>& units);

}  // namespace crumple::cuda
