#pragma once

// Stage `output`: the pairs that the workers found, in any order, become the sorted result.

#include <span>

#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/sort_pairs.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cpu {

using OutputScratch = PairSorting;

/// `found[w]`: the pairs of worker w, in the joint numbering of the scene, lower id first. Fills pairs, offsets, hits.
void write_output(const PreparedScene& scene, Workers& workers, std::span<const Array<Pair>* const> found,
                  OutputScratch& scratch, Intersections& result);

}  // namespace crumple::cpu
