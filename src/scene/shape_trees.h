#pragma once

// Trees of named shapes, kept from call to call by name, for all questions that a detector is asked about worlds.

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

    /// A call begins. What it does not ask for may be forgotten in it.
    void begin() { ++calls_; }

    /// The tree of a shape that has a name, shape `s` of its world; valid until the next call at least. Throws Error
    /// with the shape if the name is known and something differs, or if the shape's contents are wrong.
    const ShapeTree& named(const Shape& shape, std::size_t s);

    /// Builds the tree of any shape. Under a memory limit, named shapes that this call does not use make room, those
    /// that were not used for longest first.
    void build(ShapeTree& tree, const Shape& shape, std::size_t s);

    /// Forgets all and gives all memory back.
    void release() { named_.clear(); }

   private:
    struct Named {
        explicit Named(MemoryMeter* m) : tree(m) {}
        ShapeTree tree;
        std::int64_t vertices = 0, triangles = 0;
        ScalarType type{};
        std::int64_t used = 0;  ///< the call that used it last
    };

    bool drop_oldest();

    MemoryMeter& meter_;
    std::int64_t calls_ = 0;
    std::unordered_map<std::uint64_t, std::unique_ptr<Named>> named_;
};

}  // namespace crumple
