#pragma once

// Decides when two moving features first touch: by float64 filters; if these cannot prove a result, by exact predicates
// for contact at the start, and finally by rational arithmetic. Host only.

#include <cstdint>

#include "exact/impact/impact.h"

namespace crumple {

/// Number of decisions that reached each stage.
struct ImpactCounts {
    std::int64_t roots = 0;  ///< decisions left by surely_apart() or by filters at least as strong
    std::int64_t exact = 0;  ///< of these, decisions that took rational arithmetic
};

/// Flag: `yes` if filters at least as strong as surely_apart() have been applied already.
enum class Filtered : bool { no, yes };

/// Decides the impact of vertex p and face a b c.
Impact vertex_face_impact(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                          ImpactCounts& counts, Filtered filtered = Filtered::no);

/// Decides the impact of edges a b and c d.
Impact edge_edge_impact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                        ImpactCounts& counts, Filtered filtered = Filtered::no);

}  // namespace crumple
