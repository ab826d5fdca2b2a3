#pragma once

// Pairs of triangles of a scene, joined from the results of overlap queries about its parts (Detector::combine). Each
// pair is in the result of the part that owns it, so the joined pairs are those of a search of the whole scene.

#include <cstdint>
#include <span>
#include <vector>

#include "crumple/overlaps.h"
#include "crumple/world.h"

namespace crumple {

class PairsOfParts {
   public:
    /// `parts` must outlive this object. `world`: the meshes of the scene as bodies without poses. Throws Error
    /// (invalid_argument) unless there is one result for each part, with triangles that the world has and, if the query
    /// needs them, with pairs within bodies. Cost: O(pairs).
    PairsOfParts(std::span<const Overlaps> parts, const World& world, const OverlapQuery& query, MemoryMeter& meter);

    /// Appends the pairs of two bodies, sorted. Throws Error (invalid_argument) if a pair occurs twice. Cost: O(pairs +
    /// triangles of the first body), and sorts the pairs of each triangle.
    void append(const BodyPair& bodies, Array<Pair>& to) const;

   private:
    std::span<const Overlaps> parts_;
    MemoryMeter& meter_;
    std::vector<std::int64_t> triangles_;  ///< by body
};

}  // namespace crumple
