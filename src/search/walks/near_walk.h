#pragma once

// Finds out, as far as float64 shows it, whether features of two bodies come within a distance of each other: walks the
// trees of their shapes, and ends at the first pair of elements that is certainly near. Lists the groups of elements
// that may be near otherwise, for an exact search.

#include <cstdint>
#include <vector>

#include "crumple/array.h"
#include "search/walks/tree_pair_walk.h"

namespace crumple {

/// Body of a named shape: the shape's tree, with all elements, and the body's placements.
struct NearBody {
    const ShapeTree* tree;
    BoxDistance::Step step;
    /// Elements numbered from here on are complete: all of their vertices and edges are features of the shape. A shape
    /// that lists its points or edges has other features than its triangles' vertices or edges.
    std::int32_t first_complete = 0;
};

class NearWalk : private TreePairWalk {
   public:
    NearWalk(Cancellation& cancellation, MemoryMeter* meter) : TreePairWalk(cancellation, meter) {}

    /// Pair of groups of two bodies.
    struct Groups {
        std::int32_t a, b;
    };

    /// Returns true if two features are certainly at most `distance` apart at the start. Else lists in `groups` all
    /// pairs of groups whose features may be that close.
    bool near(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups);
    /// Lists in `groups` all pairs of groups whose features may be at most `distance` apart at some time of the step.
    void near_in_step(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups);

   private:
    void begin(const NearBody& a, const NearBody& b, double distance, std::vector<Groups>& groups);
    bool walk(const At& a, const At& b);
    bool visit(const Groups& pair);

    // State of the current walk:
    double distance_ = 0;
    std::int32_t first_complete_a_ = 0, first_complete_b_ = 0;
    std::vector<Groups>* groups_ = nullptr;
    Vec3d direction_;  ///< direction that separated the last pair of elements
};

}  // namespace crumple
