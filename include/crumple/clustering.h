#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace crumple {

/// Clusters and leaves into which a search divides a scene, and the frames in which leaves are swept
/// (Detector::cluster). The scene is divided into clusters, and large clusters into leaves; a cluster that is not
/// divided is a leaf. Triangles are numbered as in the mesh; those of a second mesh follow. Positions are in the
/// coordinates of the scene. Clusters and leaves overlap. A plain value.
struct Clustering {
    using Vector = std::array<double, 3>;

    std::vector<Vector> centres;  ///< by cluster
    /// Clusters of triangle t, ascending: clusters[offsets[t]] to clusters[offsets[t + 1] - 1]. None for triangles that
    /// the search leaves out: those of two meshes that are far from the other mesh, and copies of degenerate triangles.
    std::vector<std::int64_t> offsets;
    std::vector<std::int32_t> clusters;
    std::vector<std::int32_t> nearest_cluster;  ///< by triangle: that of its clusters with the nearest centre, or -1

    std::vector<std::int32_t> leaf_cluster;  ///< by leaf: the cluster that it is or lies in; ascending
    std::vector<Vector> leaf_centres;        ///< by leaf
    /// By leaf: axes of its frame, of length 1 up to rounding; the first is the sweep direction. All 0 for a leaf of
    /// fewer than two triangles, which is not swept.
    std::vector<std::array<Vector, 3>> axes;
    /// Triangles of leaf l, ascending: members[leaf_offsets[l]] to members[leaf_offsets[l + 1] - 1].
    std::vector<std::int64_t> leaf_offsets;
    std::vector<std::int32_t> members;
    std::vector<std::int32_t> nearest_leaf;  ///< by triangle: that leaf of its nearest cluster whose centre is nearest
    bool complete = true;                    ///< as Statistics::complete
};

}  // namespace crumple
