#pragma once

// Interface of the kernels for sums over an overlap, which a backend may have: blocks that search/overlap_sums.h passes
// to them, and the sums they return. Terms are those of exact/overlap/pair_terms.h, in double words
// (geometry/double_word.h).

#include <array>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Sum of terms, in a high and a low part for each lane. The parts must be added without rounding.
struct WordSum {
    static constexpr int most_lanes = 8;
    double high[most_lanes], low[most_lanes];
    double error = 0;  ///< bound on |exact sum of the parts − sum of the terms|
};

/// Sums over a block; entries from `lanes` on are undefined.
struct BlockSums {
    int lanes = 0;
    WordSum volume, moment[3], area[3], torque[3];
};

/// Faces, in one array per coordinate. Arrays are padded from `count` to a multiple of WordSum::most_lanes by copies of
/// a face that count 0 times.
struct FaceBlock {
    static constexpr int size = 64;
    int count = 0;
    alignas(64) double corner[3][3][size];  ///< by corner, axis
    double times[size];                     ///< how often a face counts
};

/// Segments in which a face of a crosses a face of b, in one array per coordinate, padded likewise.
struct SegmentBlock {
    static constexpr int size = 64;
    int count = 0;
    // By end of the segment, start first:
    alignas(64) double from[2][3][size], to[2][3][size];  ///< ends of the edge that crosses a face
    double face[2][3][3][size];                           ///< corners of that face
    double share[2][size];                                ///< parameter along that edge: 0 or 1, else −1 (unknown)
    double of_b[2][size];                                 ///< 1: the edge belongs to b; 0: to a
    double jump[2][size];                                 ///< jump of the winding number on an edge 12, else 0
    // By face:
    double first[2][3][size];  ///< first corners of the faces of a and b
    double in_volume[size];    ///< 1 if the segment counts in the volume, else 0
    double times[size];        ///< how often the segment counts in curve sums: 0, 1 or 2
};

struct OverlapKernels {
    /// Sums over faces: the volume and, if `numbers`, the first moment.
    void (*add_faces)(const FaceBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
    /// Sums over segments: the volume and, if `numbers`, all others. Leaves out segments whose ends are too uncertain,
    /// and returns these, a bit each.
    std::uint64_t (*add_segments)(const SegmentBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
};

}  // namespace crumple
