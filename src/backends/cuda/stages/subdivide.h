#pragma once

// Stage `subdivide`: fuzzy C-means ([MZ] sec. 4, eqs. 2 to 4) and memberships, one level at a time. A second level runs
// the same kernels once more, with the clusters of the first as parents. Rules and proofs are in docs/subdivide.md.
//
// Centres, and how many places a child's members have, are those that the pass before has left. So members are listed
// by one kernel, and fuzzy C-means runs beside the stages that follow. A child that was given too few places counts on:
// the pass has failed, and the host runs another that finds places and centres first.

#include "backends/cuda/device/runtime.h"
#include "backends/cuda/stages/clearing.h"
#include "backends/cuda/stages/layout.h"
#include "backends/cuda/stages/primitive.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

struct Fuzziness {
    float t = 2;
    int iterations = 2;
    float stop = 0;      ///< largest movement of a centre that ends the iteration
    bool first = false;  ///< start the centres anew, on points spread over the items
    int samples = 2048;  ///< points that place a parent's centres
};

/// What fuzzy_c_means() finds cleared.
void clear(Clearing& clearing, const Level& level);

/// Rows of scratch that `fuzzy_c_means` needs: partial sums of tiles of samples.
std::size_t fuzzy_scratch(const Level& level, const Fuzziness& fuzziness);

/// What make_members() finds cleared.
void clear_members(Clearing& clearing, const Level& level, unsigned long long* total, unsigned long long* unplaced);

/// Moves the next centres of all parents. Deterministic: sums are added in one order.
void fuzzy_c_means(const Geometry& geometry, cudaStream_t stream, const Level& level, const Ball* balls,
                   const Fuzziness& fuzziness, Row<float>* scratch);

/// How far members reach in their leaves, which is found while they are listed, if `frames.reach` is there.
struct Reaching {
    Frames frames;
    PreparedScene scene;
    Primitives primitives;
    PointRows points;
};

/// Masks of all items, and the members of those children that have a bit in `listed`. `total` counts memberships,
/// `unplaced` those for which their child had no place.
void make_members(const Geometry& geometry, cudaStream_t stream, const Level& level, std::size_t items,
                  const Ball* balls, std::uint64_t listed, const Members& members, const Reaching& reaching,
                  unsigned long long* total, unsigned long long* unplaced);

/// The children's places in the next pass: as many as they had members in this one, and some to spare. `wanted` are
/// all, though they are cut where `capacity` ends.
void make_places(cudaStream_t stream, const Level& level, unsigned long long capacity, unsigned long long* wanted);

}  // namespace crumple::cuda
