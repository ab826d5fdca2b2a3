#pragma once

// Kernels for the sums over an overlap, which a backend may have: what search/overlap_sums.h hands them, block by
// block, and what they hand back. Terms are those of exact/overlap/pair_terms.h, in double words
// (geometry/double_word.h).

#include <array>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Sum of terms, in parts that are to be added up without rounding.
struct WordSum {
    static constexpr int most_lanes = 8;
    double high[most_lanes], low[most_lanes];
    double error = 0;  ///< the sum is at most so far from what was to be added
};

/// Sums over a block; entries from `lanes` on are undefined.
struct BlockSums {
    int lanes = 0;
    WordSum volume, moment[3], area[3], torque[3];
};

/// Faces, by coordinate. Those from `count` to the next multiple of WordSum::most_lanes have a factor of 0 and a corner
/// of some face.
struct FaceBlock {
    static constexpr int size = 64;
    int count = 0;
    alignas(64) double corner[3][3][size];  ///< by corner, axis
    double times[size];                     ///< how often a face counts
};

/// Segments in which faces a and b cross, by coordinate, padded likewise.
struct SegmentBlock {
    static constexpr int size = 64;
    int count = 0;
    // By end, start first:
    alignas(64) double from[2][3][size], to[2][3][size];  ///< edge that crosses a face
    double face[2][3][3][size];                           ///< corners of that face
    double share[2][size];                                ///< of the edge's way: 0 or 1 where that is known, else −1
    double of_b[2][size];                                 ///< 1: an edge of b; 0: of a
    double jump[2][size];                                 ///< of the winding number, if the edge is 12; else 0
    // By face:
    double first[2][3][size];  ///< first corners of a and b
    double in_volume[size];    ///< 1 or 0
    double times[size];        ///< how often the segment counts in curves: 0, 1 or 2
};

struct OverlapKernels {
    /// Sums of faces: volume, and with `numbers` moment.
    void (*add_faces)(const FaceBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
    /// Sums of segments: volume, and with `numbers` the others. Returns the segments, by bit, whose ends are too
    /// uncertain, which are left out.
    std::uint64_t (*add_segments)(const SegmentBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
};

}  // namespace crumple
