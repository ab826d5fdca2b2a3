#pragma once

// Moves (two features of up to four moving points), about which the tests of this folder make queries, and operators
// that print moves and impacts in failure messages.

#include <array>
#include <ostream>

#include "exact/impact/exact_impact.h"

namespace crumple {

inline std::ostream& operator<<(std::ostream& out, const Vec3d& p) {
    const auto precision = out.precision(17);
    out << '(' << p.x << ", " << p.y << ", " << p.z << ')';
    out.precision(precision);
    return out;
}

inline std::ostream& operator<<(std::ostream& out, const MovingPoint& p) { return out << p.start << " -> " << p.end; }

inline std::ostream& operator<<(std::ostream& out, const Impact& impact) {
    if (!impact.meets) return out << "none";
    const auto precision = out.precision(17);
    out << (impact.start ? "at the start, " : "at ") << impact.toi;
    out.precision(precision);
    return out;
}

enum class Feature { vertex_face, edge_edge, vertex_edge, vertex_vertex };
inline constexpr std::array all_features{Feature::vertex_face, Feature::edge_edge, Feature::vertex_edge,
                                         Feature::vertex_vertex};

inline std::size_t points_of(Feature feature) {
    return feature == Feature::vertex_vertex ? 2 : feature == Feature::vertex_edge ? 3 : 4;
}

/// Two moving features, given by the first points_of(feature) elements of `point`.
struct Move {
    Feature feature;
    std::array<MovingPoint, 4> point;

    Impact impact() const {
        const auto& [p, q, r, s] = point;
        switch (feature) {
            case Feature::vertex_face:
                return vertex_face(p, q, r, s);
            case Feature::edge_edge:
                return edge_edge(p, q, r, s);
            case Feature::vertex_edge:
                return vertex_edge(p, q, r);
            case Feature::vertex_vertex:
                break;
        }
        return vertex_vertex(p, q);
    }

    friend std::ostream& operator<<(std::ostream& out, const Move& move) {
        constexpr const char* names[] = {"vertex_face", "edge_edge", "vertex_edge", "vertex_vertex"};
        out << names[static_cast<int>(move.feature)];
        for (std::size_t i = 0; i < points_of(move.feature); ++i) out << ", " << move.point[i];
        return out;
    }
};

}  // namespace crumple
