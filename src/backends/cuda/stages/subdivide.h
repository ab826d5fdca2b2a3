#pragma once

// Stage `subdivide`: fuzzy C-means ([MZ] sec. 4, eqs. 2 to 4) and memberships, one level at a time. A second level runs
// the same kernels once more, with the clusters of the first as parents. Rules and proofs are in docs/subdivide.md.
//
// A warm-started pass uses the centres and places of members that the previous pass has left. So one kernel lists the
// members, and fuzzy C-means for the next pass runs in parallel to the later stages. If a child has too few places, its
// members are only counted; the pass has then failed, and the host runs another, which finds places and centres first.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/batched_clear.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

struct Fuzziness {
    float t = 2;  ///< exponent of memberships
    int iterations = 2;
    float stop = 0;      ///< the iteration ends once no centre moves further than this
    bool first = false;  ///< starts the centres anew, on points spread over the items
    int samples = 2048;  ///< most samples of a parent's items
};

/// Adds Level::moved to `batch`, to be set to infinity before fuzzy_c_means().
void clear(BatchedClear& batch, const Level& level);

/// Returns the number of rows of scratch that fuzzy_c_means() needs, for partial sums over tiles of samples.
std::size_t fuzzy_scratch(const Level& level, const Fuzziness& fuzziness);

/// Adds to `batch` what must be zero before make_members(): the number of members of each child, and both counters.
void clear_members(BatchedClear& batch, const Level& level, unsigned long long* total, unsigned long long* unplaced);

/// Moves the next centres of all parents. Deterministic: sums are added in a fixed order.
void fuzzy_c_means(const Geometry& geometry, cudaStream_t stream, const Level& level, const Ball* balls,
                   const Fuzziness& fuzziness, Row<float>* scratch);

/// Input for the extents of leaves, which make_members() computes while it lists members if `frames.reach` is not null.
struct ExtentInput {
    Frames frames;
    PreparedScene scene;
    Primitives primitives;
    PointRows points;
};

/// Computes the masks of all items, and lists the members of children that have a bit in `listed`. Adds the number of
/// memberships to `total`, and the number of those without a place in their child to `unplaced`.
void make_members(const Geometry& geometry, cudaStream_t stream, const Level& level, std::size_t items,
                  const Ball* balls, std::uint64_t listed, const Members& members, const ExtentInput& reaching,
                  unsigned long long* total, unsigned long long* unplaced);

/// Reserves places for the next pass: for each child as many as it has members in this one, and some spare. The last
/// argument receives the total, which may exceed `capacity`; places end there.
void make_places(cudaStream_t stream, const Level& level, unsigned long long capacity, unsigned long long* wanted);

}  // namespace crumple::cuda
