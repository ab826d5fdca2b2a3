#pragma once

// Local bodies of a rank as a local mesh: whole bodies, one after the other, posed by the same function as on a single
// machine. Every rank has a table of all bodies, which are few.
//
//     triangles over all ranks   body 0 | body 1 | ...    the order of a world's result
//     vertices and edges         in the same order
//
// A triangle of a local mesh has a single group. That is the number of its body or, if the pair filter refers to groups
// of triangles, the triangle's own group (without one, that of its body).

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/parallel_for.h"
#include "crumple/distributed.h"
#include "crumple/error.h"
#include "distributed/feature_owners.h"
#include "distributed/transport/collective_check.h"
#include "scene/world_outline.h"

namespace crumple::distribute {

class Bodies {
   public:
    /// Checks everything but coordinates, and resizes the arrays of the local mesh. `moving`: true if it has end
    /// positions. Throws Error if the input is invalid or not supported on ranks; errors name a body by its id, if ids
    /// are given.
    void outline(const LocalWorld& local, const PairFilter& rules, bool moving);
    /// Checks that each body occurs once, and sets ids and groups of the local mesh. Collective. Throws the same Error
    /// on all ranks.
    void number(Transport& transport, CollectiveCheck& agree);
    /// Writes corners and posed vertices to the local mesh. Throws Error (Element::body, by its id).
    void pose(ParallelFor& workers);
    /// Counts the edges of each body, by the triangles that own them. Collective.
    void count_edges(Transport& transport, CollectiveCheck& agree, const FeatureOwners& features);
    /// As outline() and number(), for bodies that stay whole: makes no local mesh, and local_mesh() is empty. Their
    /// pair filter may refer to bodies and groups.
    void outline_whole(const LocalWorld& local, const PairFilter& rules);
    void number_whole(Transport& transport, CollectiveCheck& agree);
    /// Checks coordinates and indices of the shapes of whole bodies. Throws Error (Element::body, by its id).
    void check_whole() const;

    void forget_edges() { first_edge_.clear(); }
    void forget();

    /// Local mesh and its end positions: views of arrays that number() and pose() fill in.
    const LocalMesh& local_mesh() const { return local_; }
    const VertexView& end() const { return end_view_; }
    /// Returns the pair filter of the world, converted to one of the local mesh's groups.
    const PairFilter& rules() const { return group_filter_; }
    /// Bodies of this rank: their outline, and the number over all ranks of each.
    const WorldOutline& local() const { return outline_; }
    std::int32_t number_of(std::int32_t local_body) const { return static_cast<std::int32_t>(id_of(local_body)); }
    /// Number of bodies of all ranks, and number of triangles of one of them.
    std::int32_t count() const { return static_cast<std::int32_t>(table_.size()); }
    std::int64_t triangles_of(std::int32_t body) const { return table_[static_cast<std::size_t>(body)].triangles; }
    /// Returns the rank that provided a body.
    int rank_of(std::int32_t body) const { return static_cast<int>(table_[static_cast<std::size_t>(body)].rank); }

    /// Body of an element that is given by its number over all ranks, and the element's number within the body.
    struct Within {
        std::int32_t body, number;
    };
    Within triangle(std::int32_t id) const { return within(first_triangle_, id); }
    Within vertex(std::int32_t id) const { return within(first_vertex_, id); }
    Within edge(std::int32_t id) const { return within(first_edge_, id); }
    /// Returns both features of a pair. Ranks have only vertex-face and edge-edge pairs.
    std::pair<Within, Within> features(FeatureKind kind, Pair pair) const {
        if (kind == FeatureKind::edge_edge) return {edge(pair.a), edge(pair.b)};
        return {vertex(pair.a), triangle(pair.b)};
    }

   private:
    using Coordinates = std::variant<std::vector<float>, std::vector<double>>;
    /// Row of the table. The rows of all ranks are added up: only the rank that has the body contributes numbers other
    /// than 0.
    struct Row {
        std::int64_t providers = 0, rank = 0, triangles = 0, vertices = 0, self = 0;
        friend bool operator==(const Row&, const Row&) = default;
    };

    static Within within(std::span<const std::int64_t> first, std::int32_t id);
    std::int64_t id_of(std::int32_t body) const {
        return given_.empty() ? first_body_ + body : given_[static_cast<std::size_t>(body)];
    }
    /// Throws an error about one of this rank's bodies with the body's id.
    [[noreturn]] static void fail_with_id(const Error& error, std::int64_t body, std::int64_t id);
    void outline_local(const LocalWorld& local, const PairFilter& rules);
    template <class Read>
    void name_bodies_by_id(Read read);
    void reserve_mesh(bool moving);
    void check_excluded_bodies() const;
    void check_shape(const Shape& shape, std::int32_t body) const;
    bool resolve_body_ids(Transport& transport, CollectiveCheck& agree);
    void tabulate(Transport& transport, CollectiveCheck& agree);
    void exchange_filters();
    void give_numbers();
    void pose_body(std::int32_t body, std::int64_t first_vertex, std::int64_t first_triangle, ParallelFor& workers);

    WorldOutline outline_{nullptr};
    std::span<const std::int64_t> given_;
    PairFilter rules_, group_filter_;
    bool by_groups_ = false;       ///< the pair filter refers to groups of triangles
    std::int64_t first_body_ = 0;  ///< number of this rank's first body, if no ids are given

    std::vector<Row> table_;                                                ///< by body, over all ranks
    std::vector<std::int64_t> first_triangle_, first_vertex_, first_edge_;  ///< 1 per body, then the end
    std::vector<std::pair<std::int64_t, Row>> kept_;                        ///< this rank's rows, each with its body id

    LocalMesh local_;
    VertexView end_view_;
    Coordinates start_, end_;
    std::vector<std::int32_t> corners_, groups_;
    std::vector<std::int64_t> triangle_ids_, vertex_ids_;
};

}  // namespace crumple::distribute
