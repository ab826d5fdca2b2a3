#pragma once

// Parts of stages `sort` and `sweep` that are specific to intersections: records by row, and the plane filter, which
// runs before a pair is listed. Both run within the stages' kernels, so that they cost no launch.

#include "backends/cuda/device/warp_gather.h"
#include "backends/cuda/stages/layout.h"
#include "filters/intersection/plane_filter.h"

namespace crumple::cuda {

/// Records by row. The plane in each record is scaled by its error bound (filters/intersection/triangle_record.h).
struct RecordRows {
    Record* record;

    __device__ void put(std::uint32_t row, std::int32_t, const Vec3d p[3], const std::int32_t id[3],
                        const InFrame<3>& member, const Frame& frame) const {
        Record made = record_of(p, id, member);
        scale_plane(made, plane_scale(frame.reach));
        record[row] = made;
    }
};

/// Filter that drops pairs which a plane separates: about four in five of those whose boxes overlap.
struct PlaneTest {
    const Record* record;
    NarrowPolicy policy;

    using Buffer = GatherBuffer<Record>;
    __device__ bool keeps(bool has, const Candidate& c, Buffer& buffer) const {
        const auto [a, b] = gathered_pair(record, c.row, c.column, buffer);
        return has && classify(pair_signs(a, b), policy) != NextStep::apart;
    }
};

}  // namespace crumple::cuda
