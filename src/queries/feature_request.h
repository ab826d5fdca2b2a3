#pragma once

// Request to a backend about the features of one scene, and its result. Impacts, proximities and candidates are the
// same search for pairs of features with different criteria.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/array.h"
#include "crumple/candidates.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/part.h"
#include "crumple/proximities.h"
#include "queries/row_stream.h"
#include "scene/prepared_scene.h"
#include "scene/rest_shape.h"
#include "scene/scene_features.h"
#include "scene/scene_filter.h"
#include "scene/vertex_rings.h"

namespace crumple {

/// Condition for listing a pair of features: they touch during the step, are within a distance, or have inflated boxes
/// that overlap.
enum class Criterion : std::uint8_t { impact, proximity, candidate };

/// Output of a request: only a flag that says if there is any pair, the first impact, or all pairs.
enum class Extent : std::uint8_t { any, first, all };

/// Flags by CandidateKind, true for each kind of pairs that is listed. CandidateKind includes the kinds of FeatureKind,
/// in the same order.
using RequestedKinds = std::array<bool, candidate_kinds>;

CRUMPLE_HD constexpr CandidateKind candidate_kind(FeatureKind kind) {
    constexpr CandidateKind kinds[feature_kinds] = {CandidateKind::vertex_face, CandidateKind::edge_edge,
                                                    CandidateKind::vertex_edge, CandidateKind::vertex_vertex};
    return kinds[static_cast<std::size_t>(kind)];
}

struct FeatureRequest {
    Criterion criterion = Criterion::proximity;
    Extent extent = Extent::all;  ///< always `all` for candidates
    RequestedKinds kinds{};
    double distance = 0;            ///< ImpactQuery::min_distance, ProximityQuery::radius or CandidateQuery::inflation
    double share = 0;               ///< ImpactQuery::min_distance_share
    bool approaching_only = false;  ///< ImpactQuery::approaching_only
    bool strict = false;            ///< ProximityQuery::strict
    bool neighbours = false;        ///< CandidateQuery::neighbours
    bool low_memory = false;        ///< uses as little memory as possible, the same for any number of threads
    const SceneFeatures& features;
    const SceneFilter& rule;
    // Unused for candidates:
    std::span<const double> radii = {};  ///< ProximityQuery::radii of the scene's vertices; empty: `distance` applies
    const VertexRings* rings = nullptr;  ///< drops pairs within these rings (ProximityQuery::rings); null: drops none
    const RestShape* rest = nullptr;     ///< drops pairs that are near in the rest shape; null: drops none
    const Part* part = nullptr;          ///< the scene is this part, and only pairs that it owns count; null: all count

    bool lists(CandidateKind kind) const { return kinds[static_cast<std::size_t>(kind)]; }
};

/// Type of a feature.
enum class FeatureType : std::uint8_t { vertex, edge, face };
struct FeatureTypes {
    FeatureType first, second;
};
CRUMPLE_HD constexpr FeatureTypes types_of(CandidateKind kind) {
    constexpr auto vertex = FeatureType::vertex, edge = FeatureType::edge, face = FeatureType::face;
    constexpr FeatureTypes types[candidate_kinds] = {{vertex, face}, {edge, edge},   {edge, face},
                                                     {face, face},   {vertex, edge}, {vertex, vertex}};
    return types[static_cast<std::size_t>(kind)];
}
CRUMPLE_HD constexpr FeatureTypes types_of(FeatureKind kind) { return types_of(candidate_kind(kind)); }

/// Returns the number of features of a type.
inline std::int64_t count_of(const SceneFeatures& features, FeatureType type) {
    switch (type) {
        case FeatureType::vertex:
            return features.points();
        case FeatureType::edge:
            return static_cast<std::int64_t>(features.edges().size());
        case FeatureType::face:
            break;
    }
    return features.faces();
}

/// Pair of features: indices of the scene's points, edges, triangles.
struct FeatureHit {
    Pair pair;
    double value;       ///< ImpactList::toi or ProximityList::squared_distance
    std::uint8_t flag;  ///< ImpactList::start or ProximityList::touching
};

/// Pairs of one kind: indices of the scene's points, edges, triangles.
struct FeatureRows {
    explicit FeatureRows(MemoryMeter* m) : pairs(m), value(m), flag(m) {}
    Array<Pair> pairs;
    // Empty for candidates:
    Array<double> value;       ///< ImpactList::toi or ProximityList::squared_distance
    Array<std::uint8_t> flag;  ///< ImpactList::start or ProximityList::touching

    std::size_t size() const { return pairs.size(); }
    FeatureHit operator[](std::size_t row) const { return {pairs[row], value[row], flag[row]}; }
    void set(std::size_t row, const FeatureHit& hit) {
        pairs[row] = hit.pair;
        value[row] = hit.value;
        flag[row] = hit.flag;
    }
    void push_back(const FeatureHit& hit) {
        pairs.push_back(hit.pair);
        value.push_back(hit.value);
        flag.push_back(hit.flag);
    }
    void resize(std::size_t size) {
        pairs.resize(size);
        value.resize(size);
        flag.resize(size);
    }
    void resize_discard(std::size_t size) {
        pairs.resize_discard(size);
        value.resize_discard(size);
        flag.resize_discard(size);
    }
    void clear() { resize(0); }
};

/// Lists of rows, one for each kind of feature pairs.
struct RowLists {
    explicit RowLists(MemoryMeter* m)
        : lists{FeatureRows(m), FeatureRows(m), FeatureRows(m), FeatureRows(m), FeatureRows(m), FeatureRows(m)} {}
    std::array<FeatureRows, candidate_kinds> lists;  ///< rows of each CandidateKind

    FeatureRows& operator[](CandidateKind kind) { return lists[static_cast<std::size_t>(kind)]; }
    const FeatureRows& operator[](CandidateKind kind) const { return lists[static_cast<std::size_t>(kind)]; }
    FeatureRows& operator[](FeatureKind kind) { return (*this)[candidate_kind(kind)]; }
    const FeatureRows& operator[](FeatureKind kind) const { return (*this)[candidate_kind(kind)]; }

    std::size_t size() const {
        std::size_t rows = 0;
        for (const FeatureRows& list : lists) rows += list.size();
        return rows;
    }
    void clear() {
        for (FeatureRows& list : lists) list.clear();
    }
};
using FeatureStream = RowStream<RowLists>;

struct FeatureResult {
    explicit FeatureResult(MemoryMeter* m) : rows(m) {}
    bool any = false;
    FirstImpact first;  ///< for impacts, unless only a flag is requested (Extent::any); its `bodies` are not set
    RowLists rows;      ///< for Extent::all: rows of each kind, sorted, each pair once
    Statistics statistics;

    /// Empties the result, but keeps its memory.
    void clear() {
        any = false;
        first = {};
        rows.clear();
        statistics = {};
    }
};

}  // namespace crumple
