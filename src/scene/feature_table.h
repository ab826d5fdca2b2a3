#pragma once

// Pointers to a scene's features (scene_features.h) for inner loops, in host or device memory. Compiled for host and
// device. One triangle *owns* a feature: the lowest that has it. A *proxy triangle* is a degenerate triangle that owns
// an edge or a point which no triangle of the scene can own.

#include <array>
#include <cstdint>

#include "crumple/features.h"
#include "geometry/vec.h"

namespace crumple {

/// Indices of a triangle's edges, by side; -1 if the side's ends are equal. If the caller lists edges, also -1 for each
/// edge that the triangle does not own.
using TriangleEdges = std::array<std::int32_t, 3>;

/// Positions of a triangle's points in the list of points, by corner, if the caller lists points; -1 for a corner whose
/// point the triangle does not own.
using PointsOfTriangle = std::array<std::int32_t, 3>;

/// Further ownership bits of a proxy triangle. lone_point: the point at its corner 0 belongs to no edge and no
/// triangle. lone_edge: the edge on its side 0 belongs to no triangle.
inline constexpr std::uint8_t lone_point = 1 << 6, lone_edge = 1 << 7;

/// Other ends of the edges of one vertex, as representatives (FeatureTable::name): up to two different ones, -1 for
/// none. `more`: true if there are others.
struct AdjacentVertices {
    std::int32_t first = -1, second = -1;
    bool more = false;
};

struct FeatureTable {
    const TriangleEdges* edges_of = nullptr;
    const std::uint8_t* owned = nullptr;
    const std::int32_t* corners = nullptr;
    const std::int32_t* names = nullptr;  ///< representative of each vertex; null: the vertex itself
    const PointsOfTriangle* points_of =
        nullptr;  ///< by triangle and proxy triangle; null: a point's index is its vertex
    const AdjacentVertices* neighbours = nullptr;  ///< other ends of each vertex's edges; null: there are no lone edges
    std::int64_t faces = 0;                        ///< number of triangles without proxy triangles

    friend bool operator==(const FeatureTable&, const FeatureTable&) = default;

    /// Returns the representative of a vertex. Vertices with the same representative count as one.
    CRUMPLE_HD std::int32_t name(std::int32_t vertex) const { return names ? names[vertex] : vertex; }
    /// Returns the index of the point that a triangle or a proxy triangle owns at a corner.
    CRUMPLE_HD std::int32_t point_of(std::int64_t triangle, int corner) const {
        return points_of ? points_of[triangle][static_cast<std::size_t>(corner)] : corners[3 * triangle + corner];
    }
    CRUMPLE_HD bool incident(std::int32_t vertex, const Edge& e) const {
        const std::int32_t v = name(vertex);
        return v == name(e.a) || v == name(e.b);
    }
    /// True if some edge of `vertex` has no common vertex with `lone`. Then the pair of these two edges makes a test of
    /// `vertex` against `lone` unnecessary. `vertex` must not be an end of `lone`.
    CRUMPLE_HD bool has_edge_apart(std::int32_t vertex, const Edge& lone) const {
        if (!neighbours) return false;  // there is no lone edge
        const AdjacentVertices& of = neighbours[vertex];
        const auto apart = [&](std::int32_t other) {
            return other >= 0 && other != name(lone.a) && other != name(lone.b);
        };
        return of.more || apart(of.first) || apart(of.second);
    }
};

}  // namespace crumple
