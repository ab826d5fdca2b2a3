#pragma once

// Where the parts of a scene lie: a tree of fuzzy C-means centres ([MZ] sec. 4), placed by a sample of its triangles.
//
// Up to 64 parts are one level, up to 64^2 two, and so on, each level about as wide as the others. A cluster of a level
// gets as many of the parts as suit its share of the sample. The centres depend on the sample and the count alone, on
// no order of threads and no machine.

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

/// The triangles that place the centres of `parts` parts: at most 4,096, or 32 a part, evenly spread over the order.
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
    /// Of 1 to max_parts parts, around normalised points.
    PartCentres(int parts, std::span<const Vec3f> points, const Normaliser& normalise, ParallelFor& parallel);

    /// Those that bytes() has told of, elsewhere.
    PartCentres(std::span<const std::byte> bytes, const Normaliser& normalise);

    /// Valid while this lives and does not move.
    PartTree tree() const;
    /// All there is to know but the normaliser.
    std::vector<std::byte> bytes() const;

    /// Where a part lies: its cluster on each level, from the top; no masks yet.
    std::vector<PartLevel> path(std::int32_t part) const;

   private:
    struct Level {
        std::vector<std::int32_t> first{0};
        std::vector<PartSiblings> centres;
        std::vector<double> apart;
    };
    Normaliser normalise_;
    std::vector<Level> levels_;
};

/// The centres of so many parts of a scene.
PartCentres place_parts(const PreparedScene& scene, int parts, ParallelFor& parallel);

/// Shares out `parts` to clusters with so many points each: at least one and at most `most` to each, otherwise in
/// proportion.
std::vector<int> share_out(int parts, int most, std::span<const std::int64_t> points);

}  // namespace crumple
