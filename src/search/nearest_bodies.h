#pragma once

// Finds the distances of bodies, on any backend that runs on the host: builds trees of all shapes (cached for named
// ones), lists the pairs of bodies that the filter selects and that may be near enough, and runs one walk per pair
// (search/nearest_walk.h), on all threads.

#include <memory>
#include <mutex>
#include <vector>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "crumple/distances.h"
#include "scene/body_filter.h"
#include "scene/shape_trees.h"
#include "scene/world_outline.h"

namespace crumple {

class NearestWalk;

class NearestSearch {
   public:
    NearestSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& named);
    ~NearestSearch();

    /// `low_memory`: searches one pair after the other, so that the memory does not depend on threads.
    void find(ParallelFor& workers, const World& world, const DistanceQuery& query, bool low_memory, Distances& answer);

    /// Frees all memory, except for named shapes.
    void release();

   private:
    std::unique_ptr<NearestWalk> acquire_walk();
    void give_back(std::unique_ptr<NearestWalk> walk);
    void read_shapes();
    void read_bodies();
    const ShapeTree& tree(std::int32_t body) const;
    void check_vertices(std::int32_t b) const;
    void list_pairs(const DistanceQuery& query, Distances& answer);
    void add_pairs(std::int32_t a, std::int32_t begin, std::int32_t end, Distances& answer);
    bool walk_row(NearestWalk& walk, std::size_t row, double radius, Distances& answer);
    void keep_nearest(NearestWalk& walk, std::size_t begin, std::size_t end, Distances& answer);
    void number_rows(Distances& answer) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    ShapeTrees& named_;

    // State of the current call:
    double radius_ = 0;
    WorldOutline outline_;
    BodyFilter rules_;
    std::vector<const ShapeTree*> trees_;              ///< by shape
    std::vector<std::unique_ptr<ShapeTree>> of_call_;  ///< trees of shapes without a name
    Array<Bounds> box_;                                ///< per body; contains all posed vertices
    Array<std::size_t> first_row_;  ///< world w has the rows [first_row_[w], first_row_[w + 1]) before any is dropped
    std::mutex mutex_;
    std::vector<std::unique_ptr<NearestWalk>> idle_;  ///< guarded by the mutex
    Array<std::uint8_t> kept_;                        ///< per row: 1 if its bodies are near enough
};

}  // namespace crumple
