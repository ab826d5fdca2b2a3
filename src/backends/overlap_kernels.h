#pragma once

// Interface of optional kernels of a backend for the overlap of two closed bodies, a and b. Blocks of pairs of faces
// are passed to the kernels, which return the signs by which these cross (exact/overlap/face_crossing.h), and blocks of
// faces and segments, of which they return sums. The terms of the sums are defined in exact/overlap/pair_terms.h, and
// computed in double words (geometry/double_word.h).

#include <array>
#include <cstdint>

#include "geometry/vec.h"

namespace crumple {

/// Sum of terms, as a high and a low part for each lane. The caller has to add all parts without rounding.
struct WordSum {
    static constexpr int most_lanes = 8;
    double high[most_lanes], low[most_lanes];
    double error = 0;  ///< bound on |exact sum of all parts − exact sum of the terms|
};

/// Sums over a block, as defined by VolumeTerms and CurveTerms (pair_terms.h). Parts of lanes from `lanes` on are
/// undefined.
struct BlockSums {
    int lanes = 0;
    WordSum volume, moment[3], area[3], torque[3];
};

/// Faces, in one array per coordinate. Arrays are padded from `count` to a multiple of WordSum::most_lanes by copies of
/// a face with `times` 0.
struct FaceBlock {
    static constexpr int size = 64;
    int count = 0;
    alignas(64) double corner[3][3][size];  ///< by corner, axis and face
    double times[size];                     ///< integer by which the terms of a face are multiplied
};

/// Segments (exact/overlap/segment.h) in which a face of a crosses a face of b, in one array per coordinate. Arrays are
/// padded from `count` to a multiple of WordSum::most_lanes by copies of a segment with `in_volume` and `times` 0. A
/// segment's start and end are points at which an edge of one of its faces crosses the other face.
struct SegmentBlock {
    static constexpr int size = 64;
    int count = 0;
    // First index: 0 for the segment's start, 1 for its end.
    alignas(64) double from[2][3][size], to[2][3][size];  ///< both ends of the crossing edge
    double face[2][3][3][size];                           ///< corners of the crossed face, by corner and axis
    double share[2][size];  ///< 0 or 1 if the point is exactly at `from` or `to`; else −1: it has to be computed
    double of_b[2][size];   ///< 1: the edge belongs to b; 0: to a
    double jump[2][size];   ///< SegmentEnd::jump if the edge runs from corner 1 to corner 2 of its face, else 0
    // First index: 0 for the face of a, 1 for that of b.
    double first[2][3][size];  ///< first corners of both faces
    // By segment:
    double in_volume[size];  ///< 1 if the segment counts in the volume, else 0
    double times[size];      ///< number of times that the segment counts in curve sums: 0, 1 or 2
};

/// Pairs of a face of a and a face of b, in one array per coordinate. Arrays are padded from `count` to a multiple of
/// WordSum::most_lanes by copies of a pair.
struct PairBlock {
    static constexpr int size = 64;
    int count = 0;
    alignas(64) double a[3][3][size], b[3][3][size];  ///< by corner, axis and pair
};

/// Signs by which the pairs of a block cross, as far as float64 decides them: bit i for pair i. The second surface is
/// shifted (exact/overlap/face_crossing.h), in both directions.
struct CrossingSigns {
    /// Pairs that cross under no shift and are not coplanar.
    std::uint64_t apart = 0;
    /// Pairs all of whose signs that matter are known. The signs of other pairs are undefined.
    std::uint64_t decided = 0;
    std::uint64_t tied = 0;    ///< pairs with a sign that comes from the shift; others cross alike under both shifts
    std::uint64_t zero[2][3];  ///< by surface and corner: the corner is in the plane of the other face, without a shift
    std::uint64_t sides[2][2][3];  ///< by shift, surface and corner: the corner is on the positive side of that plane
    /// By shift and by edges of a and b, those at the corner that is alone on its side: [0] the edge that ends there,
    /// [1] the edge that begins there. True if edges() of cross_faces() is positive.
    std::uint64_t edges[2][2][2];
};

struct OverlapKernels {
    /// Decides signs of pairs. Coordinates must be in the range of double words.
    void (*find_signs)(const PairBlock& block, CrossingSigns& signs);
    /// Computes sums over faces: the volume and, if `numbers`, the first moment. Points are taken relative to `origin`.
    void (*add_faces)(const FaceBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
    /// Computes sums over segments: the volume and, if `numbers`, all others. Leaves out segments with an end that is
    /// computed too inaccurately, and returns a mask of these: bit i for segment i.
    std::uint64_t (*add_segments)(const SegmentBlock& block, const Vec3d& origin, bool numbers, BlockSums& sums);
};

}  // namespace crumple
