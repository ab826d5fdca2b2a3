#pragma once

// Searches the features (vertices, edges and faces) of worlds, on any backend: the bodies of each world become one
// scene, with vertices posed at the start and at the end of the step, and the backend searches it. A single body with
// the identity pose is searched in the caller's memory ("in place").

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <variant>

#include "backends/backend.h"
#include "base/cancellation.h"
#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "partition/feature_part.h"
#include "queries/feature_requests.h"
#include "queries/proximity_input.h"
#include "results/feature_output.h"
#include "scene/body_filter.h"
#include "scene/joined_lists.h"
#include "scene/scene_features.h"
#include "scene/scene_filter.h"
#include "scene/world_outline.h"
#include "scene/world_scene.h"
#include "search/clear_worlds.h"
#include "search/triangle_impacts.h"

namespace crumple {

/// Size and consumer of the blocks of a result (Detector::stream).
template <class Result>
struct FeatureBlocks {
    std::int64_t most;  ///< maximum number of rows of a block, over all of its lists
    FunctionRef<void(const Result& block)> take;
};

class FeatureSearch {
   public:
    FeatureSearch(MemoryMeter& meter, Cancellation& cancellation, ShapeTrees& trees);

    /// `bodies`: true if the rows of the result name bodies; false for a mesh, which is a world of a single body.
    /// `low_memory`: see FeatureRequest.
    template <class Query>
    void find(BackendBase& backend, const World& world, const Query& query, bool bodies, bool low_memory,
              typename Query::Result& result) {
        bodies_ = bodies;
        low_memory_ = low_memory;
        search(backend, world, query, result);
    }

    /// Delivers the result in blocks. Each has some of the rows, and the edges and points of all bodies. Blocks are
    /// made in `result`, which at the end has the total number of rows and the statistics.
    template <class Query>
    void stream(BackendBase& backend, const World& world, const Query& query, bool bodies, bool low_memory,
                const FeatureBlocks<typename Query::Result>& blocks, typename Query::Result& result);

    /// Cuts the mesh that is the only body of a world into parts for this query.
    template <class Query>
    std::vector<Part> partition(BackendBase& backend, const World& world, const Query& query, int count);

    /// Finds the rows that a part owns, with the ids of the mesh that it was cut from.
    template <class Query>
    void find(BackendBase& backend, const Part& part, const Query& query, bool low_memory,
              typename Query::Result& result);

    // Queries about a mesh in device memory (device_feature_search.cpp):

    /// True if the device can run the whole query. Else Detector::find downloads the mesh and runs it on the host, and
    /// launch() throws Error.
    static bool supports_on_device(const Shape& shape, const ImpactQuery& query);
    static bool supports_on_device(const Shape& shape, const ProximityQuery& query);
    static bool supports_on_device(const Shape& shape, const CandidateQuery& query);
    template <class Query>
    void find_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query, bool low_memory,
                        typename Query::Result& result);
    template <class Query>
    LaunchNumber launch(BackendBase& backend, const DeviceShape& mesh, const Query& query);
    AnyDeviceResult wait(BackendBase& backend, LaunchNumber launch);

    /// Frees all memory.
    void release();

   private:
    template <class Query>
    void read_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query);
    void download_features(BackendBase& backend, const DeviceShape& mesh);
    template <class Query, class Ask>
    auto run_on_device(BackendBase& backend, const DeviceShape& mesh, const Query& query, Ask ask);
    template <class Query>
    void find_rows_on_device(BackendBase& backend, const Query& query);

    PreparedScene prepare_part(BackendBase& backend, const Part& part, const PairFilter& rules);

    template <class Query>
    void search(BackendBase& backend, const World& world, const Query& query, typename Query::Result& result);
    void search_with_least(BackendBase& backend, const World& world, const ProximityQuery& query, Proximities& result);
    template <class Query>
    void search_in_place(BackendBase& backend, const Query& query, typename Query::Result& result);
    template <class Query>
    void search_pass(BackendBase& backend, std::int32_t pass, const Query& query, typename Query::Result& result);
    /// True if the marked groups of world `pass` have a pair of features that the query finds.
    template <class Query>
    bool any_among(BackendBase& backend, std::int32_t pass, Query query, std::span<const ClearWorlds::Mark> marked,
                   typename Query::Result& result);
    template <class Query>
    void search_world(BackendBase& backend, std::int32_t pass, const Query& query,
                      std::span<const ClearWorlds::Mark> marked, typename Query::Result& result);

    /// Makes clear_ read the bodies, so that it can find the worlds that need no search. If the query, the backend or a
    /// memory limit requires a search of every world, makes clear_ forget those of the previous call instead.
    template <class Query>
    void read_clear_worlds(const BackendBase& backend, const Query& query);

    template <class Query>
    bool parts_suffice(const Query& query) const;

    template <class Query>
    void index_lists(const Query& query, typename Query::Result& result) const;

    template <class Result>
    void list_features(BackendBase& backend, bool step, bool weld, Result& result);
    template <class Query, class Blocks>
    void stream_scene(BackendBase& backend, const PreparedScene& scene, const Query& query, bool in_place,
                      Blocks& blocks, Statistics& statistics);

    /// Reads and validates the world.
    void read(const World& world, const PairFilter& rules);
    /// True if there is a single body that can be searched in the caller's memory.
    bool in_place(const PairFilter& rules) const;
    /// Makes a scene of the only body in the caller's memory, and prepares features_ and scene_filter_. `step`: true
    /// for a query about a step: the scene then has end positions, if the shape has any.
    PreparedScene prepare_in_place(BackendBase& backend, bool step, bool weld);
    /// Makes a scene of posed copies of the bodies of world `pass` and the bodies that are in all worlds (only of the
    /// latter if `pass` is the number of worlds), and prepares features_ and scene_filter_. Returns nothing if
    /// own_bodies(pass) is 0. `marked`: unless empty, uses only these groups of triangles.
    std::optional<PreparedScene> prepare_pass(BackendBase& backend, std::int32_t pass, bool step, bool weld,
                                              std::span<const ClearWorlds::Mark> marked = {});
    void add_marked(std::int32_t pass, std::span<const ClearWorlds::Mark> marked);
    /// Returns the index of a world in results: `pass`, or -1 for pairs among bodies that are in all worlds.
    std::int32_t world_of(std::int32_t pass) const { return pass < outline_.worlds() ? pass : -1; }
    /// Returns the number of bodies of world `pass`, without those in all worlds; if `pass` is the number of worlds,
    /// the number of bodies that are in all worlds.
    std::int32_t own_bodies(std::int32_t pass) const;
    /// Swaps the rows in found_ with those of the result, so that searches reuse the result's memory.
    template <class Query>
    void swap_found(typename Query::Result& result) {
        for (std::size_t k = 0; k < result.lists.size(); ++k)
            swap_rows(result.lists[k], found_.rows[static_cast<KindOf<Query>>(k)]);
    }
    /// Finds the rows of a prepared scene, in found_.
    template <class Query>
    void find_rows(BackendBase& backend, const PreparedScene& scene, const Query& query);
    void find_triangle_pairs(BackendBase& backend, const PreparedScene& scene, const ImpactQuery& query);
    /// Appends the edges and points of the bodies of world `pass`, as own_bodies() counts them.
    template <class Result>
    void append_features(std::int32_t pass, Result& result);
    /// Appends the same for a world that is not searched, because it is clear.
    template <class Result>
    void append_features_of_clear_world(std::int32_t pass, Result& result);
    /// Appends the codimensional points of a body.
    template <class Result>
    void append_codimensional_points(std::int32_t body, Result& result);
    /// Appends rows to a list of the result. `in_place`: true if the indices of the scene are those of the only body;
    /// else converts them to bodies and indices within bodies.
    template <class List>
    void append_rows(FeatureTypes types, const FeatureRows& rows, bool in_place, List& list) const;
    void add_first(std::int32_t pass, Impacts& result) const;

    /// Body of an element of the scene, and the element's index within that body.
    struct Place {
        std::int32_t body, index;
    };
    void place_features();
    Place point(std::int32_t p) const;
    Place edge(std::int32_t e) const;
    Place triangle(std::int32_t t) const;
    Place place(FeatureType type, std::int32_t i) const;
    void place(FeatureTypes types, const Pair& found, Pair& pair, BodyPair& bodies) const;

    MemoryMeter& meter_;
    Cancellation& cancellation_;
    bool bodies_ = false, low_memory_ = false;  // parameters of the current call
    const DeviceShape* device_mesh_ = nullptr;  // mesh of the current call if it is in device memory
    WorldOutline outline_;
    BodyFilter body_filter_;
    SceneFilter scene_filter_;
    ClearWorlds clear_;
    WorldScene scene_;
    JoinedLists lists_;
    SceneBuffers buffers_;
    Array<std::int32_t> class_of_;  ///< class (BodyClass) of each triangle of the current part
    SceneFeatures features_;
    ProximityInput proximity_input_;
    FeatureResult found_;
    TriangleImpacts triangle_impacts_;
    // First edge and first point of each body that was added to the scene, in their order, then the end:
    Array<std::int64_t> first_edge_, first_point_;

    /// Inputs of the last launches, by number modulo most_in_flight. wait() runs a launch again if its features were
    /// out of date.
    struct Launched {
        DeviceShape mesh;
        std::variant<ImpactQuery, ProximityQuery, CandidateQuery> query;
    };
    std::array<Launched, most_in_flight> launched_;
};

// The world's own bodies were added to the scene first, before bodies that are in all worlds.
template <class Result>
void FeatureSearch::append_features(std::int32_t pass, Result& result) {
    const auto bodies = static_cast<std::size_t>(own_bodies(pass));
    result.edges.grow_by(static_cast<std::size_t>(first_edge_[bodies]));
    for (std::size_t i = 0; i < bodies; ++i) {
        const auto first = static_cast<std::int32_t>(scene_.first_vertex(i));
        for (std::int64_t e = first_edge_[i]; e < first_edge_[i + 1]; ++e) {
            const Edge& edge = features_.edges()[e];
            result.edges.push_back({edge.a - first, edge.b - first});
        }
        result.first_edge.push_back(static_cast<std::int64_t>(result.edges.size()));
        append_codimensional_points(scene_.added_body(i), result);
    }
}

template <class Result>
void FeatureSearch::append_features_of_clear_world(std::int32_t pass, Result& result) {
    const std::int32_t begin = outline_.first_body(pass), end = begin + own_bodies(pass);
    for (std::int32_t b = begin; b < end; ++b) {
        const std::span<const Edge> edges = clear_.edges(b);
        const std::size_t before = result.edges.size();
        result.edges.grow_by(edges.size());
        result.edges.resize(before + edges.size());
        std::copy(edges.begin(), edges.end(), result.edges.begin() + before);
        result.first_edge.push_back(static_cast<std::int64_t>(result.edges.size()));
        append_codimensional_points(b, result);
    }
}

template <class Result>
void FeatureSearch::append_codimensional_points(std::int32_t body, Result& result) {
    if (device_mesh_)
        for (const std::int32_t v : features_.codimensional_points()) result.points.push_back(v);
    else if (const auto& points = outline_.shape(body).points)
        for (const std::int32_t v : *points) result.points.push_back(v);
    result.first_point.push_back(static_cast<std::int64_t>(result.points.size()));
}

}  // namespace crumple
