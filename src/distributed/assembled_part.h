#pragma once

// A part on its owner: what the ranks have told of it (members.h), as the engines take it.
//
//     vertices    run | run | run ...      a run is what one rank added to its list in one call
//     triangles   by ascending id, from all ranks; each knows the rank that brought it
//
// Copies of a vertex lie in several runs; triangles name the one that was there first, so they are neighbours.

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

/// What one rank has told, ready to be taken over.
struct PartNews {
    int rank = 0;
    PartDelta delta;
};

class AssembledPart {
   public:
    /// `levels`: where the part lies; no masks yet.
    AssembledPart(std::int32_t index, int count, std::vector<PartLevel> levels, bool float32, bool groups);
    /// For questions about features: vertices keep their ids, and have ends where they move.
    void know_features(bool moving) {
        features_ = true;
        moving_ = moving;
        if (moving) end_ = part_.mesh.vertices;
    }

    std::int32_t index() const { return part_.index; }
    const Part& part() const { return part_; }
    /// What engines remember of it.
    std::unique_ptr<SceneMemory>& memory() { return memory_; }
    std::int64_t size() const { return part_.mesh.size(); }
    /// What its lists take, about.
    std::int64_t bytes() const;
    /// The rank that has brought a triangle, by its place in the part.
    int rank_of(std::int32_t triangle) const { return rank_[static_cast<std::size_t>(triangle)]; }

    /// Takes over what is new. Their coordinates are still to come.
    void take(std::span<const PartNews> news);

    /// Where coordinates [first, first + n) of a rank's list lie: visit(place of the first, first of the n, how many).
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
    /// Of questions about features: the id of each vertex, and what each triangle owns.
    std::span<const std::int32_t> vertex_ids() const { return vertex_id_; }
    const OwnedFeatures& owned(std::size_t triangle) const { return owned_[triangle]; }
    /// Another number whenever anything but coordinates has changed.
    std::int64_t revision() const { return revision_; }

   private:
    struct Run {
        std::int64_t first, place, count;  ///< in the rank's list, in the part's vertices
    };
    void add_vertices(const PartNews& news);
    std::int32_t vertex(int rank, std::int32_t listed) const;
    void merge(std::span<const PartNews> news);
    void change_masks(std::span<const PartNews> news);

    Part part_;
    std::unique_ptr<SceneMemory> memory_;
    bool groups_, features_ = false, moving_ = false;
    std::variant<std::vector<float>, std::vector<double>> end_;
    std::vector<std::int32_t> vertex_id_;
    std::vector<OwnedFeatures> owned_;  ///< by each triangle
    std::int64_t revision_ = 0;
    std::vector<std::int32_t> rank_;      ///< of each triangle
    std::vector<std::vector<Run>> runs_;  ///< by rank
    std::int64_t vertex_count_ = 0;
    std::unordered_map<std::int32_t, std::int32_t> first_;  ///< by id of a vertex with copies: where it was first
    std::unordered_map<std::int32_t, std::int32_t> copy_;   ///< other places of such: where it was first
};

}  // namespace crumple::distribute
