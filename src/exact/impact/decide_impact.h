#pragma once

// When two moving features first touch: float64 where that proves it, exact predicates at the start,
// else rational arithmetic. Host only.

#include <cstdint>

#include "exact/impact/impact.h"

namespace crumple {

/// How many queries went how far.
struct ImpactCounts {
    std::int64_t roots = 0;  ///< were not surely apart
    std::int64_t exact = 0;  ///< of those: took rational arithmetic
};

/// Whether filters that are as good as surely_apart() have been asked.
enum class Filtered : bool { no, yes };

/// Vertex p against the face a b c.
Impact vertex_face_impact(const MovingPoint& p, const MovingPoint& a, const MovingPoint& b, const MovingPoint& c,
                          ImpactCounts& counts, Filtered filtered = Filtered::no);

/// Edge a b against edge c d.
Impact edge_edge_impact(const MovingPoint& a, const MovingPoint& b, const MovingPoint& c, const MovingPoint& d,
                        ImpactCounts& counts, Filtered filtered = Filtered::no);

}  // namespace crumple
