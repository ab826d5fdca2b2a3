#pragma once

// What inner loops read of a scene's features (scene_features.h), wherever the arrays lie. Compiled for host and
// device.

#include <array>
#include <cstdint>

#include "crumple/features.h"
#include "geometry/vec.h"

namespace crumple {

/// The edges of a triangle, by side; -1 where a side's ends are equal.
using TriangleEdges = std::array<std::int32_t, 3>;

/// The points of a triangle's corners, where points are listed.
using PointsOfTriangle = std::array<std::int32_t, 3>;

/// Of a carrier: it owns a vertex of no edge and no triangle at corner 0, or an edge of no triangle on side 0.
inline constexpr std::uint8_t lone_point = 1 << 6, lone_edge = 1 << 7;

/// The other ends of a vertex's edges, by name: up to two that differ, -1 for none.
struct NamedNeighbours {
    std::int32_t first = -1, second = -1;
    bool more = false;
};

struct FeatureTable {
    const TriangleEdges* edges_of = nullptr;
    const std::uint8_t* owned = nullptr;
    const std::int32_t* corners = nullptr;
    const std::int32_t* names = nullptr;          ///< null: the vertices' indices
    const PointsOfTriangle* points_of = nullptr;  ///< null: as vertices
    const NamedNeighbours* neighbours = nullptr;  ///< of each vertex, if there are lone edges
    std::int64_t faces = 0;

    friend bool operator==(const FeatureTable&, const FeatureTable&) = default;

    /// What a vertex is called where it is asked whether two are the same.
    CRUMPLE_HD std::int32_t name(std::int32_t vertex) const { return names ? names[vertex] : vertex; }
    /// Of the vertex that a triangle or a carrier owns at a corner.
    CRUMPLE_HD std::int32_t point_of(std::int64_t triangle, int corner) const {
        return points_of ? points_of[triangle][static_cast<std::size_t>(corner)] : corners[3 * triangle + corner];
    }
    CRUMPLE_HD bool incident(std::int32_t vertex, const Edge& e) const {
        const std::int32_t v = name(vertex);
        return v == name(e.a) || v == name(e.b);
    }
    /// Whether an edge of the vertex is a pair with a lone edge that it is not on: then that pair covers the vertex.
    CRUMPLE_HD bool has_edge_apart(std::int32_t vertex, const Edge& lone) const {
        if (!neighbours) return false;  // there is no lone edge
        const NamedNeighbours& of = neighbours[vertex];
        const auto apart = [&](std::int32_t other) {
            return other >= 0 && other != name(lone.a) && other != name(lone.b);
        };
        return of.more || apart(of.first) || apart(of.second);
    }
};

}  // namespace crumple
