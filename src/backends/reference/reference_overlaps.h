#pragma once

// Overlaps of bodies by brute force, in rational arithmetic: the reference for search/overlap/overlap_search.h.

#include "base/cancellation.h"
#include "crumple/overlaps.h"
#include "crumple/world.h"

namespace crumple {

/// Finds winding numbers by a ray from each vertex, crossings by all pairs of triangles, and integrals over the faces
/// of both bodies. Does so twice, with the second body shifted infinitesimally in opposite directions, which decides
/// ties (docs/overlap.md). Cost of a pair of bodies: some 100 us for each pair of triangles whose boxes overlap, and
/// some 10 us for each pair of a vertex and a triangle that the vertex's ray may meet.
void find_overlaps_by_brute_force(const World& world, const OverlapQuery& query, MemoryMeter& meter,
                                  Cancellation& cancellation, Overlaps& result);

}  // namespace crumple
