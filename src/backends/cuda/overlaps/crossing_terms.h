#pragma once

// Kernels for overlaps of bodies (backends/overlap_device.h): decide how pairs of faces cross, one thread for each
// pair; sum over the segments of up to 64 pairs of one row, and over up to 256 faces, one warp for each sum. Sums have
// error bounds, so it does not matter in which order a warp adds.

#include "backends/cuda/device/runtime.h"
#include "backends/overlap_device.h"

namespace crumple::cuda {

inline constexpr std::size_t pairs_per_sum = 64, faces_per_sum = 256;

/// Posed vertices of a surface, and three of them for each face.
struct SurfaceArrays {
    const Vec3d* points;
    const std::int32_t* corners;

    CRUMPLE_HD FaceCorners face(std::int32_t i) const {
        const std::int32_t* c = corners + 3 * std::int64_t{i};
        return {points[c[0]], points[c[1]], points[c[2]]};
    }
};

struct RowArrays {
    SurfaceArrays surface[2];
    Vec3d origin;
    int curves;  ///< 0 if sums over curves are not needed
};

/// Pairs [begin, end) of a row, over whose segments one warp sums.
struct PairChunk {
    unsigned long long begin, end;
    unsigned row;
};

struct CrossingArrays {
    const RowArrays* rows;
    const unsigned long long* first_pairs;  ///< by row: index of its first pair
    std::size_t row_count;
    const Pair* pairs;
    std::size_t pair_count;
    PackedCrossings* crossings;  ///< by pair
    const PairChunk* chunks;
    std::size_t chunk_count;
    SegmentTerms* sums;  ///< by chunk
};

/// Decides all pairs.
void decide_crossings(const Geometry& geometry, cudaStream_t stream, const CrossingArrays& arrays);
/// Sums over the segments of each chunk, and marks the crossings whose terms are too uncertain. `numbers`: false if
/// only volumes are needed.
void sum_segments(const Geometry& geometry, cudaStream_t stream, const CrossingArrays& arrays, bool numbers);
/// Makes one sum for each faces_per_sum faces.
void sum_faces(const Geometry& geometry, cudaStream_t stream, const SurfaceArrays& surface, const CountedFace* faces,
               std::size_t count, const Vec3d& origin, VolumeTerms<Enclosed>* sums);
/// Launches the kernel that decides on no pairs, so that the driver reserves its stacks.
void reserve_crossing_stack(const Geometry& geometry, cudaStream_t stream);

}  // namespace crumple::cuda
