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
    /// Elements numbered from here on are complete: all of their vertices and edges are features of the shape. If a
    /// shape lists points or edges, vertices or edges of its triangles may be no features, so near triangles prove
    /// nothing.
    std::int32_t first_complete = 0;
};

class NearWalk : private TreePairWalk {
   public:
    NearWalk(Cancellation& cancellation, MemoryMeter* meter) : TreePairWalk(cancellation, meter) {}

    /// Returns true if two features are certainly at most `distance` apart at the start. Else marked_a() and marked_b()
    /// list the groups of each body whose features may be that close to the other body.
    bool near(const NearBody& a, const NearBody& b, double distance);
    /// Lists the groups of each body whose features may be at most `distance` apart at some time of the step.
    void near_in_step(const NearBody& a, const NearBody& b, double distance);

    /// Return the groups that the last walk has listed, each once.
    /// @{
    const std::vector<std::int32_t>& marked_a() const { return marked_a_.groups; }
    const std::vector<std::int32_t>& marked_b() const { return marked_b_.groups; }
    /// @}

   private:
    /// Set of groups of a body.
    struct Marked {
        std::vector<std::uint8_t> has;  ///< by group: 1 if it is in the set
        std::vector<std::int32_t> groups;

        void begin(std::int32_t count) {
            has.assign(static_cast<std::size_t>(count), 0);
            groups.clear();
        }
        void add(std::int32_t group) {
            std::uint8_t& flag = has[static_cast<std::size_t>(group)];
            if (!flag) groups.push_back(group);
            flag = 1;
        }
    };

    void begin(const NearBody& a, const NearBody& b, double distance);
    bool walk_from_roots();
    bool walk(const At& a, const At& b);
    bool visit(std::int32_t group_a, std::int32_t group_b);

    // State of the current walk:
    double distance_ = 0;
    std::int32_t first_complete_a_ = 0, first_complete_b_ = 0;
    Marked marked_a_, marked_b_;
    Vec3d direction_;  ///< direction that separated the last pair of elements
};

}  // namespace crumple
