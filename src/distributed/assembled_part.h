#pragma once

// A part of the scene (crumple/part.h) on the rank that owns it, that is, searches it. It is assembled from the deltas
// (changes since the previous call) that all ranks send (members.h), in the form that searches read:
//
//     vertices    run | run | run ...      a run: consecutive vertices of one rank's list for this part
//     triangles   by ascending id, from all ranks, each with the rank that provided it
//
// A ghost vertex, which several ranks have, is in several runs. Triangles refer to its first copy, so that triangles of
// different ranks are adjacent.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "backends/backend.h"
#include "crumple/part.h"
#include "distributed/members.h"

namespace crumple::distribute {

/// Delta that one rank sends for a part.
struct RankDelta {
    int rank = 0;
    PartDelta delta;
};

class AssembledPart {
   public:
    /// `levels`: for each level of clusters, the cluster that contains the part; without masks of triangles, which
    /// take() fills in.
    AssembledPart(std::int32_t index, int count, std::vector<PartLevel> levels, bool float32, bool groups);
    /// Prepares the part for queries about features: take() then also stores the ids of vertices and the features that
    /// triangles own; if `moving`, vertices also have end positions.
    void set_feature_demand(bool moving) {
        features_ = true;
        moving_ = moving;
        if (moving) end_ = part_.mesh.vertices;
    }

    std::int32_t index() const { return part_.index; }
    const Part& part() const { return part_; }
    /// Per-scene cache of the backend for this part.
    std::unique_ptr<SceneMemory>& memory() { return memory_; }
    std::int64_t size() const { return part_.mesh.size(); }
    /// Returns approximately how many bytes the arrays by triangle and the coordinates of vertices take; runs, maps
    /// and memory() are not counted.
    std::int64_t bytes() const;
    /// Returns the rank that provided a triangle, given by index in the part.
    int rank_of(std::int32_t triangle) const { return rank_[static_cast<std::size_t>(triangle)]; }

    /// Merges the deltas of all ranks. The coordinates of new vertices are received later, through coordinates().
    void take(std::span<const RankDelta> news);

    /// Maps rows [first, first + n) of a rank's list of vertices to vertices of the part. Calls visit(vertex, row,
    /// count) for each contiguous piece: `vertex` is its first vertex in the part, `row` its first row, counted from
    /// `first`.
    template <class Visit>
    void visit_coordinates(int rank, std::int64_t first, std::size_t n, Visit visit) const {
        const auto end = first + static_cast<std::int64_t>(n);
        for (const Run& run : runs_[static_cast<std::size_t>(rank)]) {
            const std::int64_t from = std::max(first, run.first), to = std::min(end, run.first + run.count);
            if (from < to)
                visit(run.place + (from - run.first), static_cast<std::size_t>(from - first),
                      static_cast<std::size_t>(to - from));
        }
    }
    template <class Scalar>
    std::array<Scalar, 3>* coordinates(bool at_end) {
        auto& xyz = at_end ? end_ : part_.mesh.vertices;
        return reinterpret_cast<std::array<Scalar, 3>*>(std::get<std::vector<Scalar>>(xyz).data());
    }
    const std::variant<std::vector<float>, std::vector<double>>& end() const { return end_; }
    /// For queries about features: the id of each vertex over all ranks, and the features that a triangle owns.
    std::span<const std::int32_t> vertex_ids() const { return vertex_id_; }
    const OwnedFeatures& owned(std::size_t triangle) const { return owned_[triangle]; }
    /// Returns a number that changes whenever anything but coordinates changes.
    std::int64_t revision() const { return revision_; }

   private:
    struct Run {
        std::int64_t first, place, count;  ///< start in the rank's list, start in the part's vertices, size
    };
    void add_vertices(const RankDelta& news);
    std::int32_t vertex(int rank, std::int32_t listed) const;
    void merge(std::span<const RankDelta> news);
    void change_masks(std::span<const RankDelta> news);

    Part part_;
    std::unique_ptr<SceneMemory> memory_;
    bool groups_, features_ = false, moving_ = false;
    std::variant<std::vector<float>, std::vector<double>> end_;
    std::vector<std::int32_t> vertex_id_;
    std::vector<OwnedFeatures> owned_;  ///< 1 per triangle
    std::int64_t revision_ = 0;
    std::vector<std::int32_t> rank_;      ///< 1 per triangle: the rank that provided it
    std::vector<std::vector<Run>> runs_;  ///< by rank
    std::int64_t vertex_count_ = 0;
    std::unordered_map<std::int32_t, std::int32_t> first_;  ///< by id of a ghost vertex: index of its first copy
    std::unordered_map<std::int32_t, std::int32_t> copy_;   ///< by index of any further copy: index of the first
};

}  // namespace crumple::distribute
