#pragma once

// Cache of the trees of named shapes, by name, shared by all queries of a detector about worlds.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

#include "crumple/world.h"
#include "scene/shape_tree.h"

namespace crumple {

class ShapeTrees {
   public:
    explicit ShapeTrees(MemoryMeter& meter) : meter_(meter) {}

    /// Begins a call of the detector. During it, trees that it does not use may be evicted.
    void begin() { ++calls_; }

    /// Returns the tree of a named shape; `s` is the shape's index in its world. Valid at least until the next begin().
    /// Throws Error that names the shape if the tree cached under this name was built for other numbers of vertices and
    /// elements or another precision, or if the shape is invalid.
    const ShapeTree& named(const Shape& shape, std::size_t s, TreeElements elements = TreeElements::triangles);

    /// Returns the edges of a named shape's triangles, each once and sorted, as in results. Its tree of all elements
    /// must be cached. Valid as long as this tree.
    const Array<Edge>& edges(const Shape& shape);

    /// Builds the tree of any shape. If the memory limit is exceeded, evicts named shapes that this call does not use,
    /// the least recently used first.
    void build(ShapeTree& tree, const Shape& shape, std::size_t s, TreeElements elements = TreeElements::triangles);

    /// Evicts everything and frees all memory.
    void release() { named_.clear(); }

   private:
    /// Numbers of what a tree was built from, to recognise a changed shape.
    struct Size {
        std::int64_t vertices = 0, triangles = 0, edges = 0, points = 0;
        ScalarType type{};
    };
    struct Named {
        explicit Named(MemoryMeter* m) : tree(m), edges(m) {}
        ShapeTree tree;
        Array<Edge> edges;  ///< of the triangles; empty until they are needed
        Size size;
        std::int64_t used = 0;  ///< calls_ at the last use of the tree
    };
    /// Name of a shape; true for a tree of all elements of a shape that has edges or points.
    using Key = std::pair<std::uint64_t, bool>;

    void check_unchanged(std::uint64_t name, std::size_t s, const Size& size) const;
    static void find_edges(const Shape& shape, Array<Edge>& edges);
    bool drop_oldest();

    MemoryMeter& meter_;
    std::int64_t calls_ = 0;
    std::map<Key, std::unique_ptr<Named>> named_;
};

}  // namespace crumple
