#pragma once

// Interface of a backend's device for overlaps of bodies (search/overlap/): decides how pairs of faces cross, and sums
// over segments and faces. The terms of the sums are defined in exact/overlap/pair_terms.h. All surfaces must have
// coordinates in the range of double words (exact/overlap/enclosed.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/intersections.h"
#include "exact/overlap/enclosed_terms.h"
#include "exact/overlap/packed_crossings.h"

namespace crumple {

/// Surface of a body: posed vertices, and the three vertices of each face.
struct DeviceSurface {
    std::span<const Vec3d> points;
    std::span<const std::int32_t> corners;
};

/// Row of a batch: two surfaces, by their indices in the batch, and their pairs of faces.
struct CrossedRow {
    std::array<std::int32_t, 2> surface{};
    std::size_t begin = 0, end = 0;  ///< range of pairs. Rows are in the order of their pairs
    Vec3d origin;                    ///< points in the sums are relative to it
    bool curves = true;              ///< false: sums over curves are not needed
};

/// Crossings of the pairs of a batch, and sums over the segments of each row.
struct BatchCrossings {
    std::vector<PackedCrossings> pairs;  ///< by pair
    std::vector<SegmentTerms> sums;      ///< some for each row
    std::vector<std::size_t> offsets;    ///< sums of row i: [offsets[i], offsets[i + 1])
};

class OverlapDevice {
   public:
    virtual ~OverlapDevice() = default;

    /// Returns the number of pairs from which on cross() is worthwhile, for surfaces of this size.
    virtual std::size_t least_pairs(std::size_t points, std::size_t faces) const = 0;
    /// Returns the number of faces from which on add_faces() is worthwhile.
    virtual std::size_t least_faces() const = 0;

    /// Decides the pairs of a batch, and sums over their segments. `numbers`: false if only volumes are needed. Returns
    /// false if memory does not suffice; then the host has to do it.
    virtual bool cross(std::span<const DeviceSurface> surfaces, std::span<const CrossedRow> rows,
                       std::span<const Pair> pairs, bool numbers, BatchCrossings& crossings) = 0;

    /// Sums over faces of a surface of the last batch; all numbers of `sums` together are the sum. Returns false if
    /// memory does not suffice. Thread-safe.
    virtual bool add_faces(std::int32_t surface, std::span<const CountedFace> faces, const Vec3d& origin,
                           std::vector<VolumeTerms<Enclosed>>& sums) = 0;

    /// Ends a batch: frees its memory if the detector has a memory limit.
    virtual void end_batch() = 0;
};

}  // namespace crumple
