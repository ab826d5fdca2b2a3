#pragma once

// Stage `subdivide`: fuzzy C-means (sec. 4 of [MZ], the paper cited in ARCHITECTURE.md) splits the scene into clusters,
// and large clusters again. The final clusters are the leaves: each is searched by one sweep, and is meant to fit a
// core's cache.
//
// A triangle joins every cluster whose centre may be the nearest to one of its points (bisector rule; proof in
// docs/subdivide.md), so two triangles with a common point share a cluster, at every level. A cluster handles a pair
// only if it is the lowest one that both belong to, so each pair is handled once: leaf (k1, k2), child k2 of cluster
// k1, owns a pair iff no cluster below k1 contains both in the first level, and no child of k1 below k2 does in the
// second. Integer operations on masks decide this.
//
// Layout: the members of all first-level clusters lie in flat arrays, those of cluster k at [first[k], first[k + 1]). A
// leaf is a list of positions in these arrays or, if its cluster was not split, a range of them.

#include <array>
#include <atomic>
#include <cstdint>

#include "backends/cpu/parallel.h"
#include "backends/cpu/stages/kernels.h"
#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/membership.h"
#include "crumple/options.h"

namespace crumple::cpu {

/// Centres cached from call to call, for warm starts: each call iterates from those of the previous one.
struct WarmCentres {
    Centres level1;
    int wanted = 0;  ///< number of first-level centres that was chosen when level1 was last started anew
    std::array<Centres, max_clusters> level2;  ///< by first-level cluster: centres of its children
};

struct Leaf {
    std::int32_t cluster = 0;  ///< k1: first-level cluster
    std::int32_t child = -1;   ///< k2: child of this cluster, or -1 if the cluster was not split
    std::int64_t begin = 0;    ///< into members2[cluster], or into the flat arrays if child < 0
    std::int64_t size = 0;
};

struct Subdivision {
    explicit Subdivision(MemoryMeter* m)
        : mask1(m), mask2(m), id(m), histogram(m), place(m), leaves(m), sample(m), included(m) {
        for (auto& list : members2) list = Array<std::int32_t>(m);
    }
    Array<std::uint64_t> mask1;  ///< by triangle: the clusters that it belongs to
    Array<std::uint64_t> mask2;  ///< by member of a cluster that is split: the children that it belongs to
    Array<std::int32_t> id;      ///< by member: its triangle
    std::array<std::int64_t, max_clusters + 1> first{};  ///< first member of each cluster; then the number of members
    /// By first-level cluster: positions of its children's members in `id`, child after child.
    std::array<Array<std::int32_t>, max_clusters> members2;
    Array<std::int64_t> histogram;  ///< by chunk of 4,096 triangles and cluster: number of members
    Array<std::int64_t> place;      ///< scratch: where a chunk writes its next member
    Array<Leaf> leaves;             ///< largest first
    Array<Vec3f> sample;            ///< scratch
    Array<std::int32_t> included;   ///< triangles that are searched, if some are left out (Buffers::included)
    int clusters = 0;
    SceneMembership membership;         ///< rule by which place_clusters() has assigned triangles
    std::atomic<bool> may_lose{false};  ///< true if `membership` may lose pairs in the clusters and leaves made so far
};

/// Computes the centres and masks of the first level for triangles [0, n), or only for those t with included[t] if
/// `included` is not null.
void place_clusters(const Array<Ball>& balls, std::int64_t n, const std::uint8_t* included, const Options& options,
                    const StageKernels& kernels, Workers& workers, WarmCentres& warm, Subdivision& subdivision);

/// Gathers the members of clusters [begin, end), splits large clusters again, and lists the leaves of all of them.
void gather_leaves(const Array<Ball>& balls, std::int64_t n, int begin, int end, const Options& options,
                   const StageKernels& kernels, Workers& workers, WarmCentres& warm, Subdivision& subdivision);

}  // namespace crumple::cpu
