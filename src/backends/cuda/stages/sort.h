#pragma once

// Stage `sort`: sorts the members of each leaf by the start of their interval ([MZ] sec. 3), by a counting sort into
// bins. The order within a bin does not matter: a row's columns are all rows after it, up to the end of its last bin,
// and box tests decide. The query's record of a member is made from the same corners as the member's box. A leaf is
// sorted within its own places, so that no prefix sums cross leaves; spare rows are unused.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/layout.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

/// Ownership of pairs: a leaf owns a pair iff both triangles belong to it, and share no cluster or leaf whose number on
/// its level is lower than that of this leaf or of its cluster. The clusters of the last level are bits of
/// SortedRow::conflict. The upper level is looked up for pairs without a common bit there.
struct Ownership {
    const std::uint64_t* upper_mask;  ///< by triangle: clusters of the first of two levels; or null
    const std::uint64_t* last_mask;   ///< by member of the first level; by triangle if there is one level
    int last_fan_out;
    int upper_fan_out;  ///< first-level clusters of each world; 1 if there is one level
};

/// Adds the arrays that sort_members() requires cleared to `batch`.
void clear(BatchedClear& batch, const Sorted& sorted, int leaves);

/// Sorts the members, writes their records and lists the units of work. `Primitive`: see primitive.h. `Records`: has a
/// device function put(row, triangle, corners of the primitive, ids of the triangle's corners, member in its frame,
/// frame), which writes the query's record of a member. Defined in sort_kernel.h.
template <class Primitive, class Records>
void sort_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Points& points,
                  int leaves, const Segments& members_of, const Members& members, const Frames& frames,
                  const Ownership& ownership, const Sorted& sorted, const Primitive& primitive, const Records& records,
                  const List<SweepUnit>& units, Counters* counters);

/// First part of sort_members(): finds the bins of each member, and the first row of each bin.
template <class Primitive>
void bin_members(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Primitive& primitive,
                 const Points& points, int leaves, const Segments& members_of, const Members& members,
                 const Frames& frames, const Sorted& sorted);
/// Last part of sort_members(): lists the units of work.
void list_units(const Geometry& geometry, cudaStream_t stream, int leaves, const Segments& members_of,
                std::size_t capacity, const Sorted& sorted, const List<SweepUnit>& units);

}  // namespace crumple::cuda
