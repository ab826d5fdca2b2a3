#pragma once

// Stage `output`: sorts the pairs that the workers found, in any order, into the result.

#include <span>

#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/sort_pairs.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

using OutputScratch = PairSorting;

/// Fills pairs, offsets and hit flags of the result. `found[w]`: the pairs of worker w, lower id first, numbered as in
/// the scene, where the triangles of a second mesh follow those of the first.
void write_output(const PreparedScene& scene, Workers& workers, std::span<const Array<Pair>* const> found,
                  OutputScratch& scratch, Intersections& result);

}  // namespace crumple::cpu
