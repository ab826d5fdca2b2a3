#pragma once

// Finds the distances of bodies, on any backend that runs on the host: builds the trees of all shapes (or takes cached
// ones of named shapes), lists the pairs of bodies that the filter selects and that may be near enough, and walks the
// trees of each pair (search/walks/nearest_walk.h), on all threads. If only the nearest pair of each world is
// requested, it omits walks of pairs that are certainly farther apart than another pair. At first each pair of bodies
// has a row; rows that turn out not to belong to the result are dropped at the end.

#include <memory>
#include <vector>

#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "base/pool.h"
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

    /// `low_memory`: true to search one pair after the other, so that the memory needed does not depend on the number
    /// of threads.
    void find(ParallelFor& workers, const World& world, const DistanceQuery& query, bool low_memory, Distances& answer);

    /// Frees all memory, except for named shapes.
    void release();

   private:
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
    std::vector<const ShapeTree*> trees_;              ///< tree of each shape that a body has
    std::vector<std::unique_ptr<ShapeTree>> of_call_;  ///< trees of the current call, for shapes without a name
    Array<Bounds> box_;                                ///< by body: a box that contains all of its posed vertices
    Array<std::size_t> first_row_;  ///< by world: index of its first row before rows are dropped; then the end
    Pool<NearestWalk> walks_;
    Array<std::uint8_t> kept_;  ///< by row: 1 if it belongs to the result
};

}  // namespace crumple
