#pragma once

// Inflation of the swept boxes of triangles for candidates. Compiled for host and device.

#include "geometry/inflation.h"

namespace crumple {

/// Returns the inflation of boxes by `inflation` (CandidateQuery::inflation), in normalised coordinates, rounded up.
CRUMPLE_HD inline Inflation inflation_of_candidates(const Normaliser& normaliser, double inflation) {
    Inflation widening;
    widening.of_box = true;
    if (inflation > 0) widening.half = normalised_length(inflation, normaliser) * 1.000001f + 1e-30f;
    return widening;
}

}  // namespace crumple
