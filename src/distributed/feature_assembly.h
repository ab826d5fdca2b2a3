#pragma once

// Converts an assembled part to the form for queries about features (PartFeatures, crumple/part.h): with each vertex
// once, by ascending id, and with the features that the part's triangles own.

#include <cstdint>
#include <vector>

#include "crumple/part.h"
#include "distributed/assembled_part.h"

namespace crumple::distribute {

/// Parameters of a query about features that a part is made for.
struct FeatureDemand {
    bool moving = false;
    double distance = 0, share = 0;
    bool weld = false;
    friend bool operator==(const FeatureDemand&, const FeatureDemand&) = default;
};

class FeatureAssembly {
   public:
    /// Returns the part in this form; valid until the next call. Updates all coordinates, and everything else that has
    /// changed since the previous call.
    const Part& update(const AssembledPart& from, const FeatureDemand& demand);

    /// Returns the rank that provided the triangle that owns a vertex or an edge of the part, given by id.
    int rank_of_vertex(std::int32_t id) const;
    int rank_of_edge(std::int32_t id) const;
    /// Returns the ids of an edge's vertices.
    Edge ends_of_edge(std::int32_t id) const;

   private:
    void merge_triangles(const AssembledPart& from);
    void merge_edges(const AssembledPart& from);
    void merge_coordinates(const AssembledPart& from);
    void name_vertices();
    std::size_t place_of_edge(std::int32_t id) const;

    Part part_;
    std::int64_t revision_ = -1;
    std::vector<std::int32_t> place_;  ///< 1 per vertex: its index in the assembled part
    std::vector<std::int32_t> vertex_rank_, edge_rank_;
};

}  // namespace crumple::distribute
