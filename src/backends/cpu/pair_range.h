#pragma once

// A share of the answer by the ids of what its pairs are of: what one block of a stream holds (stream_intersections.h,
// stream_features.h).

#include <cstdint>

#include "backends/cpu/id_ranges.h"
#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/layout.h"
#include "crumple/array.h"
#include "crumple/function_ref.h"
#include "partition/levels.h"
#include "queries/feature_request.h"
#include "scene/scene_features.h"

namespace crumple::cpu {

/// Pairs of triangles whose lower id is in `first` and whose higher id is in `first` or `second`, in joint numbering.
struct PairRange {
    IdRange first, second;
};

/// Pairs of features of these types whose first is in `first` and whose second is in `second`: indices of the scene's
/// points, edges, faces.
struct FeatureRange {
    FeatureTypes types;
    IdRange first, second;

    bool has(const Pair& pair) const { return first.has(pair.a) && second.has(pair.b); }
};

/// Which triangles are looked at for a share of the answer, and who owns its pairs.
struct RangeBuffers {
    Workers& workers;
    const Array<Ball>& balls;
    Array<std::uint8_t>& included;
    Array<std::uint64_t>& masks;
};

/// Leaves out (included[t] = 0) the triangles that are in no pair of the range: those of neither list of ids, and those
/// of the second alone that do not reach the box of the first. Returns a level that owns the pairs of the range among
/// what is left. It has two clusters: triangles of the first list are members of cluster 1 alone, all others of both,
/// so that 0 owns a pair of two others, and 1, the range, all the rest. The masks are its own.
Level exclude_others(const PairRange& range, const RangeBuffers& buffers);

/// The same of triangles that own a first feature, and of those that own a second one. A pair of triangles that is left
/// may own other pairs of features as well.
Level exclude_others(const FeatureRange& range, const SceneFeatures& features, const RangeBuffers& buffers);

}  // namespace crumple::cpu
