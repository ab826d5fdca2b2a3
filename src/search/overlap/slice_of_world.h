#pragma once

// Slice of a world: the bodies of some pairs of bodies, in a world of their own in which no other pairs meet. A search
// of slices one after another finds the same pairs of triangles as a search of the whole world, in less memory.

#include <span>
#include <vector>

#include "crumple/query.h"
#include "crumple/world.h"

namespace crumple {

class SliceOfWorld {
   public:
    /// `pairs`: the pairs of the slice, a range of `near`, which has all pairs of bodies that the filter selects and
    /// that may meet; both are sorted. A pair of a body with itself stands for Body::self. The slice refers to the
    /// shapes of the world.
    SliceOfWorld(const World& world, const PairFilter& filter, std::span<const BodyPair> near,
                 std::span<const BodyPair> pairs);
    SliceOfWorld(const SliceOfWorld&) = delete;
    SliceOfWorld& operator=(const SliceOfWorld&) = delete;

    World world() const { return {shapes_, bodies_, poses_}; }
    /// Returns the filter that selects the pairs of the slice among its bodies that may meet.
    const PairFilter& filter() const { return filter_; }
    /// Returns the index in the whole world of a body of the slice. Indices ascend.
    std::int32_t body(std::int32_t of_slice) const { return ids_[static_cast<std::size_t>(of_slice)]; }

   private:
    void exclude_other_pairs(std::span<const BodyPair> near, std::span<const BodyPair> pairs);
    std::int32_t place_of(std::int32_t body) const;

    std::span<const Shape> shapes_;
    std::vector<std::int32_t> ids_;
    std::vector<Body> bodies_;
    std::vector<Pose> poses_;
    PairFilter filter_;
};

}  // namespace crumple
