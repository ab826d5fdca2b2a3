#pragma once

// Stage `subdivide`: fuzzy C-means ([MZ] sec. 4, eqs. 2 to 4) and memberships, one level at a time. A second level runs
// the same kernels once more, with the clusters of the first as parents. Rules and proofs are in docs/subdivide.md.

#include "engine/cuda/clearing.h"
#include "engine/cuda/layout.h"
#include "engine/cuda/runtime.h"

namespace crumple::cuda {

struct Fuzziness {
    float t = 2;
    int iterations = 2;
    float stop = 0;      ///< largest movement of a centre that ends the iteration
    bool first = false;  ///< start the centres anew, on points spread over the items
    int samples = 2048;  ///< points that place a parent's centres
};

/// What fuzzy_c_means() and make_members() find cleared.
void clear(Clearing& clearing, const Level& level);

/// Rows of scratch that `fuzzy_c_means` needs: partial sums of tiles of samples.
std::size_t fuzzy_scratch(const Level& level, const Fuzziness& fuzziness);

/// Moves the centres of all parents. Deterministic: sums are added in one order.
void fuzzy_c_means(const Geometry& geometry, cudaStream_t stream, const Level& level, const Ball* balls,
                   const Fuzziness& fuzziness, Row<float>* scratch);

/// Masks of all items, and the members of those children that have a bit in `listed`. `total` counts memberships, also
/// those beyond the capacity.
void make_members(const Geometry& geometry, cudaStream_t stream, const Level& level, std::size_t items,
                  const Ball* balls, std::uint64_t listed, const Members& members, unsigned long long* total);

}  // namespace crumple::cuda
