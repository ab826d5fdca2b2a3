#pragma once

// What a backend is asked about the features of one scene, and what it answers. Motion and nearness are the same search
// for pairs of features, with another decision.

#include <array>
#include <cstdint>
#include <span>

#include "crumple/array.h"
#include "crumple/features.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/part.h"
#include "crumple/proximities.h"
#include "queries/row_stream.h"
#include "scene/prepared_scene.h"
#include "scene/rest_shape.h"
#include "scene/rules.h"
#include "scene/scene_features.h"
#include "scene/vertex_rings.h"

namespace crumple {

/// How much of the answer is wanted.
enum class Extent : std::uint8_t { any, first, all };

struct FeatureRequest {
    bool motion = false;  ///< which features touch on their way; else which are near each other
    Extent extent = Extent::all;
    double distance = 0;  ///< the minimum distance, or the radius
    double share = 0;     ///< ImpactQuery::min_distance_share
    bool strict = false;  ///< ProximityQuery::strict
    bool frugal = false;  ///< with as little memory as can be, and always as much
    const SceneFeatures& features;
    const GroupRule& rule;
    std::span<const double> radii =
        {};  ///< ProximityQuery::radii of the scene's vertices; empty: `distance` is asked for
    const VertexRings* rings = nullptr;  ///< neighbours that have no vertex in common; null: there are none
    const RestShape* rest = nullptr;     ///< null: there is none
    const Part* part = nullptr;          ///< what the scene is made of, whose pairs are asked for; null: all
};

/// What a list's features are.
enum class FeatureType : std::uint8_t { vertex, edge, face };
struct FeatureTypes {
    FeatureType first, second;
};
CRUMPLE_HD constexpr FeatureTypes types_of(FeatureKind kind) {
    constexpr auto vertex = FeatureType::vertex, edge = FeatureType::edge;
    constexpr FeatureTypes types[feature_kinds] = {
        {vertex, FeatureType::face}, {edge, edge}, {vertex, edge}, {vertex, vertex}};
    return types[static_cast<std::size_t>(kind)];
}

/// How many features there are of a type.
inline std::int64_t count_of(const SceneFeatures& features, FeatureType type) {
    switch (type) {
        case FeatureType::vertex:
            return features.points();
        case FeatureType::edge:
            return static_cast<std::int64_t>(features.edges().size());
        default:
            return features.faces();
    }
}

/// A pair of features that is an answer: indices of the scene's points, edges, triangles.
struct FeatureHit {
    Pair pair;
    double value;       ///< toi, or squared distance
    std::uint8_t flag;  ///< start, or touching
};

/// Hits by kind.
using FeatureHits = std::array<Array<FeatureHit>, feature_kinds>;
using FeatureStream = RowStream<FeatureHits>;

/// Pairs of one kind: indices of the scene's points, edges, triangles. Sorted, unique.
struct FeatureRows {
    explicit FeatureRows(MemoryMeter* m) : pairs(m), value(m), flag(m) {}
    Array<Pair> pairs;
    Array<double> value;       ///< toi, or squared distance
    Array<std::uint8_t> flag;  ///< start, or touching
};

struct FeatureAnswer {
    explicit FeatureAnswer(MemoryMeter* m) : rows{FeatureRows(m), FeatureRows(m), FeatureRows(m), FeatureRows(m)} {}
    bool any = false;
    FirstImpact first;                            ///< of a motion, from Extent::first on; without bodies
    std::array<FeatureRows, feature_kinds> rows;  ///< for Extent::all; by kind
    Statistics statistics;
};

/// Forgets what an answer says, keeps its memory.
inline void clear(FeatureAnswer& answer) {
    answer.any = false;
    answer.first = {};
    for (FeatureRows& rows : answer.rows) {
        rows.pairs.clear();
        rows.value.clear();
        rows.flag.clear();
    }
    answer.statistics = {};
}

}  // namespace crumple
