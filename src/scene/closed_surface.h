#pragma once

// Triangle surface prepared for winding numbers. Detects if it is closed, and orders its vertices so that in this order
// the winding numbers of another surface are piecewise constant, with few steps.
//
// The edges have a spanning forest. The *place* of a vertex is its position in a depth-first walk of the forest. The
// vertices below an edge of the forest form an interval of places. So if another surface crosses that edge, its winding
// numbers at the vertices of this interval change, and crossings of edges outside of the forest can be ignored. Faces
// are sorted by the place of their first corner.
//
//   places        0 ........................... places() - 1      vertices that no triangle names have none
//   components    [0, end0) [end0, end1) ...                      one tree each
//   faces         those of place 0, of place 1, ...

#include <array>
#include <cstdint>
#include <span>

#include "base/parallel_for.h"
#include "crumple/array.h"
#include "scene/open_surface.h"
#include "scene/scene_features.h"

namespace crumple {

class ClosedSurface {
   public:
    explicit ClosedSurface(MemoryMeter* meter);

    /// Reads a scene of one mesh. Cost: O(triangles), or only a comparison if the corners are those of the previous
    /// call.
    void prepare(const PreparedScene& scene, ParallelFor& workers);

    /// Returns the open edges, sorted by their vertices; a closed surface has none. Cost: O(triangles).
    Array<OpenEdge> open_edges() const;
    bool closed() const { return closed_; }

    std::int32_t face_count() const { return static_cast<std::int32_t>(features_.faces()); }
    std::int32_t places() const { return static_cast<std::int32_t>(vertex_at_place_.size()); }
    std::int32_t place(std::int32_t vertex) const { return place_[vertex]; }
    std::int32_t vertex_at_place(std::int32_t place) const { return vertex_at_place_[place]; }
    /// Returns the end of the interval [place, end) of a place and all places below it in the forest.
    std::int32_t end_of(std::int32_t place) const { return end_of_[place]; }
    /// First place of each component, and the end of the last one.
    const Array<std::int32_t>& components() const { return components_; }

    /// Returns the faces whose first corner is at a place in [begin, end).
    std::span<const std::int32_t> faces(std::int32_t begin, std::int32_t end) const {
        return {faces_.data() + first_face_[begin], faces_.data() + first_face_[end]};
    }
    const std::int32_t* corners(std::int32_t face) const { return features_.corners() + 3 * std::int64_t{face}; }

    /// Returns 1 if an edge of a face (01, 12 or 20) leads down the forest, −1 if it leads up, and 0 if the edge is not
    /// in the forest. Each edge of the forest counts in the lowest face that has it; the other faces get 0.
    int forest_edge(std::int32_t face, std::size_t edge) const {
        return (down_[face] >> edge & 1) - (down_[face] >> (edge + 3) & 1);
    }

    /// Frees all memory.
    void release();

   private:
    std::int32_t direction(std::int32_t triangle, std::size_t edge) const;
    void check_closed();
    void walk();
    void mark_edges();
    void sort_faces();

    SceneFeatures features_;
    std::uint64_t revision_ = 0;  ///< revision of the features from which the other members were made
    bool closed_ = false;
    Array<std::int32_t> place_, vertex_at_place_, end_of_, components_;
    Array<std::int32_t> faces_, first_face_;
    Array<std::uint8_t> down_;  ///< per face: bit k is set if edge k leads down the forest, bit 3 + k if it leads up
    // Scratch:
    Array<std::int32_t> sum_, first_, neighbour_, parent_, next_;
};

}  // namespace crumple
