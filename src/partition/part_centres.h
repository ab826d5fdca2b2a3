#pragma once

// Location of the public parts of a scene (crumple/part.h): a tree of fuzzy C-means centres (sec. 4 of [MZ], the paper
// cited in ARCHITECTURE.md), computed from a sample of the scene's triangles.
//
// Up to 64 parts have one level, up to 64^2 two, and so on; all levels are about equally wide. A cluster gets a number
// of parts in proportion to its sampled triangles. The centres depend only on the sample and the number of parts, not
// on threads or the machine.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/parallel_for.h"
#include "partition/part_tree.h"
#include "scene/prepared_scene.h"

namespace crumple {

inline constexpr int max_parts = max_clusters * max_clusters * max_clusters;

/// Sample of triangles from which the centres of `parts` parts are computed, evenly spread over the triangles' order:
/// all of them, but at most 4,096 or 32 per part, whichever is more.
class PartSample {
   public:
    PartSample(std::int64_t triangles, int parts)
        : triangles_(static_cast<std::uint64_t>(triangles)),
          centroids_(
              std::min<std::size_t>(triangles_, std::max<std::size_t>(4096, 32 * static_cast<std::size_t>(parts)))) {}
    std::size_t size() const { return centroids_.size(); }
    std::int64_t triangle(std::size_t i) const { return static_cast<std::int64_t>(i * triangles_ / size()); }
    static Vec3f centroid(const Triangle& triangle, const Normaliser& normalise);
    void set(std::size_t i, Vec3f centroid) { centroids_[i] = centroid; }
    std::span<const Vec3f> centroids() const { return centroids_; }

   private:
    std::uint64_t triangles_;
    std::vector<Vec3f> centroids_;
};

class PartCentres {
   public:
    /// Computes the centres of 1 to max_parts parts from the sample's centroids in normalised coordinates, `points`.
    PartCentres(int parts, std::span<const Vec3f> points, const Normaliser& normalise, ParallelFor& parallel);

    /// Reads centres from what bytes() has written, possibly on another machine.
    PartCentres(std::span<const std::byte> bytes, const Normaliser& normalise);

    /// Returns a view of the centres, valid while this object lives and is not moved.
    PartTree tree() const;
    /// Serialises the centres; the reader has to have the same normaliser.
    std::vector<std::byte> bytes() const;

    /// Returns the cluster of a part on each level, from the top; without masks.
    std::vector<PartLevel> path(std::int32_t part) const;

   private:
    struct ClusterLevel {
        std::vector<std::int32_t> first{0};
        std::vector<PartSiblings> centres;
        std::vector<double> apart;
    };
    Normaliser normalise_;
    std::vector<ClusterLevel> levels_;
};

/// Computes the centres of `parts` parts of a scene.
PartCentres place_parts(const PreparedScene& scene, int parts, ParallelFor& parallel);

/// Distributes `parts` parts over clusters in proportion to the numbers of their sample points, `points`: at least one
/// and at most `most` to each cluster.
std::vector<int> distribute_parts(int parts, int most, std::span<const std::int64_t> points);

}  // namespace crumple
