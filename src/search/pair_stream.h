#pragma once

// Delivers the pairs of triangles of one scene in blocks, on any backend that streams.

#include "backends/backend.h"
#include "base/cancellation.h"

namespace crumple {

/// Calls take(block) until all pairs of a scene have been delivered, with contacts if the query requests them, at most
/// `most` pairs per block, in an order that does not depend on threads. Fills the statistics.
void stream_pairs(BackendBase& backend, const PreparedScene& scene, const IntersectionQuery& query, std::int64_t most,
                  MemoryMeter& meter, Cancellation& cancellation, FunctionRef<void(const Intersections& block)> take,
                  Statistics& statistics);

}  // namespace crumple
