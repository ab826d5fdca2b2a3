#pragma once

// Cache of the trees of named shapes, by name, shared by all queries of a detector about worlds.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>

#include "crumple/world.h"
#include "scene/shape_tree.h"

namespace crumple {

class ShapeTrees {
   public:
    explicit ShapeTrees(MemoryMeter& meter) : meter_(meter) {}

    /// Begins a call of the detector. During it, trees that it does not use may be evicted.
    void begin() { ++calls_; }

    /// Returns the tree of a named shape; `s` is the shape's index in its world. Valid at least until the next begin().
    /// Throws Error that names the shape if the tree cached under this name was built for another number of vertices or
    /// triangles or another precision, or if the shape is invalid.
    const ShapeTree& named(const Shape& shape, std::size_t s);

    /// Builds the tree of any shape. If the memory limit is exceeded, evicts named shapes that this call does not use,
    /// the least recently used first.
    void build(ShapeTree& tree, const Shape& shape, std::size_t s);

    /// Evicts everything and frees all memory.
    void release() { named_.clear(); }

   private:
    struct Named {
        explicit Named(MemoryMeter* m) : tree(m) {}
        ShapeTree tree;
        std::int64_t vertices = 0, triangles = 0;
        ScalarType type{};
        std::int64_t used = 0;  ///< calls_ at the last use of the tree
    };

    bool drop_oldest();

    MemoryMeter& meter_;
    std::int64_t calls_ = 0;
    std::unordered_map<std::uint64_t, std::unique_ptr<Named>> named_;
};

}  // namespace crumple
