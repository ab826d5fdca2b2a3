#pragma once

// Moves with a minimum distance: queries about when two features come within that distance.

#include <ostream>

#include "exact/impact/exact_min_distance.h"
#include "impacts/random_moves.h"

namespace crumple {

inline std::ostream& operator<<(std::ostream& out, const MinDistance& separation) {
    const auto precision = out.precision(17);
    out << "distance " << separation.distance << ", share " << separation.share;
    if (separation.approaching_only) out << ", approaching only";
    out.precision(precision);
    return out;
}

struct MinDistanceMove {
    Move move;
    MinDistance separation;

    Impact impact() const {
        const auto& [p, q, r, s] = move.point;
        switch (move.feature) {
            case Feature::vertex_face:
                return vertex_face(p, q, r, s, separation);
            case Feature::edge_edge:
                return edge_edge(p, q, r, s, separation);
            case Feature::vertex_edge:
                return vertex_edge(p, q, r, separation);
            case Feature::vertex_vertex:
                break;
        }
        return vertex_vertex(p, q, separation);
    }

    friend std::ostream& operator<<(std::ostream& out, const MinDistanceMove& query) {
        return out << query.move << ", " << query.separation;
    }
};

/// Returns a random move and a minimum distance: a distance of the size of the coordinates, a share of the initial
/// distance, or both.
inline MinDistanceMove separated(RandomMoves& random, Lattice lattice, Feature feature) {
    const Move move = random(feature);
    const double unit = lattice == Lattice::wide ? 8 : 1;
    constexpr double distances[] = {0.25, 0.5, 1, 1, 1.5, 2, 3, 0.1};
    constexpr double shares[] = {0.5, 0.25, 0.75, 0.9};
    MinDistance separation;
    const int kind = random.below(4);
    if (kind < 3) separation.distance = unit * distances[random.below(8)];
    if (kind > 1) separation.share = shares[random.below(4)];
    return {move, separation};
}

}  // namespace crumple
