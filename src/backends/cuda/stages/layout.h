#pragma once

// Arrays that the stages of the cuda backend pass on, all in device memory: structs of plain pointers, passed to
// kernels by value. Finder (engine/finder.h) owns the memory.
//
// The scene is divided into clusters, and these into leaves; they overlap. A member is a triangle in a cluster or leaf.
//
//   bounds      scene            -> Points (one row of four per vertex), balls (one per triangle)
//   subdivide   balls            -> Level: one mask per item; Members: cluster after cluster, then leaf after leaf,
//                                   in no order within each
//   align       members, balls   -> one Frame per leaf
//   sort        members, frames  -> Sorted: members of each leaf by start along its first axis, and their boxes; the
//                                   query's own records of the members; units of work
//   sweep       Sorted, units    -> survivors: pairs that a leaf owns, whose boxes overlap, and that the filters keep
//   narrow      survivors        -> hits
//   output      hits             -> rows of the result; for intersections: pairs, offsets, hit flags
//
// Data that affects cost but not results (centres, frames, places of members) comes from the previous pass, if
// Plan::warm_started. Such a pass also computes it for the next one, in parallel to the stages (WarmStart).
//
// Only the device learns the numbers of members, survivors and hits. The host gives each list a capacity. A kernel that
// meets a full list keeps counting without writing; when the host reads the counters (wait), it grows the list and
// repeats the pass. So nothing is dropped, and in a steady frame the host reads one struct of counters, at the end.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "crumple/features.h"
#include "crumple/intersections.h"
#include "geometry/ball.h"
#include "geometry/leaf_frame.h"
#include "geometry/point_rows.h"

namespace crumple::cuda {

inline constexpr int max_fan_out = 64;  ///< most children of a cluster: bits of a mask
/// Most children between two meshes: SortedRow::conflict then has 62 bits for lower children and two for the side.
inline constexpr int max_fan_out_between = 63;
inline constexpr int bins = 1024;  ///< bins along a leaf's sweep axis
/// Maximum number of leaves: Sorted::leaf has 16 bits. Parents, of which there are at most as many, are rows of a grid,
/// and CUDA allows 65,535 rows.
inline constexpr int max_leaves = 65'535;

using crumple::Row;

/// Rows of normalised vertices, in float32 or float64: one pointer is null.
struct Points {
    Row<float>* f = nullptr;
    Row<double>* d = nullptr;

    PointRows rows() const { return {reinterpret_cast<const float*>(f), reinterpret_cast<const double*>(d)}; }
};

/// Counters that the device fills for the host. Lengths of lists include the elements that did not fit.
struct Counters {
    unsigned long long bad_vertex[2], bad_triangle[2];  ///< lowest invalid index in each mesh; all bits set: none
    unsigned long long bad_end, bad_radius, bad_rest;   ///< likewise: ends, radii, rest positions of one mesh
    unsigned long long changed;      ///< an index that differs from the cached mesh (cached_mesh.h); all bits set: none
    unsigned long long places[2];    ///< places to reserve for the members of each level
    unsigned long long units;        ///< units of the sweep
    unsigned long long members[2];   ///< memberships of each level
    unsigned long long unplaced[2];  ///< memberships without a place in their child
    /// Pairs of a row and a column (SortedRow); those of them without a common bit of SortedRow::conflict whose boxes
    /// overlap.
    unsigned long long interval_tests, box_overlaps;
    unsigned long long survivors;             ///< pairs that the filter of the sweep keeps
    unsigned long long doubles;               ///< intersections: survivors unresolved by the float32 filter
    unsigned long long undecided;             ///< intersections: survivors unresolved by the float64 filter
    unsigned long long beyond;                ///< pairs, or tests of features, that the host has to decide
    unsigned long long listed;                ///< tests of features that pairs of triangles expand to
    unsigned long long tests[feature_kinds];  ///< tests that the filters keep, by FeatureKind
    unsigned long long open[feature_kinds];   ///< tests left to the second step of the decision, by FeatureKind
    unsigned long long hits;
    unsigned long long parts;  ///< parts of long rows of the result (RowPart)
};

/// Concatenated lists, each with spare places: list s has the places [first[s], first[s + 1]), and fills them from the
/// front. Lists of members begin at multiples of 32, so that the lanes of a warp read one list.
struct Segments {
    unsigned long long* first;  ///< first place of each list; and the end
    unsigned long long* count;  ///< elements of each list, with those that did not fit

    CRUMPLE_HD unsigned long long end(std::size_t s) const {
        const unsigned long long all = first[s] + count[s];
        return all < first[s + 1] ? all : first[s + 1];
    }
};

/// One level of subdivision. On the first level, items are triangles and parents are worlds (worlds_side_by_side.h); on
/// the second, items are members of the first level and parents are its clusters. Parent p has the children [p fan_out,
/// (p + 1) fan_out).
struct Level {
    int parents, fan_out;
    Segments items_of;               ///< items of each parent; null: a single parent
    unsigned long long items;        ///< number of items, for a single parent
    const std::int32_t* triangle;    ///< by item: its triangle; null: item i is triangle i
    const Row<float>* centre;        ///< centres of all children: parents * fan_out
    Row<float>* next_centre;         ///< centres for the next pass
    float* moved;                    ///< by parent: largest movement of a next centre in the last iteration
    std::uint64_t* mask;             ///< by item: children that it belongs to
    Segments members_of;             ///< members of each child
    unsigned long long* next_first;  ///< first place of each child's members in the next pass
    CRUMPLE_HD int children() const { return parents * fan_out; }
};

/// Memberships of one level, child after child.
struct Members {
    std::int32_t* triangle;
    std::uint32_t* item;  ///< index of the item in the Level
    unsigned long long capacity;
};

/// A leaf's frame, and its bins along the first axis.
struct BinnedFrame : LeafFrame {
    float base, scale;  ///< bin of x: (x - base) * scale, rounded down and clamped
};

/// BinnedFrame, with bounds that depend on where the leaf's members are.
struct Frame : BinnedFrame {
    float reach;   ///< extent: bound on |coordinates| of corners of members that are not big (LeafFrame)
    float margin;  ///< error bound of a coordinate in the frame (docs/align.md)
};

/// Frames of all leaves. `binned` may come from the previous pass; only `reach` depends on where members are now.
struct Frames {
    const BinnedFrame* binned;
    unsigned* reach;  ///< by leaf: extent, as bits of a float >= 0, which have the order of the numbers

    CRUMPLE_HD float extent_of(std::size_t leaf) const { return std::bit_cast<float>(reach[leaf]); }
    CRUMPLE_HD Frame operator[](std::size_t leaf) const {
        const float far = extent_of(leaf);
        return {binned[leaf], far, box_margin(far)};
    }
};

/// Data by which a pass warm-starts the next one. It affects cost, never the result.
struct WarmStart {
    Row<float>* centre[2];         ///< centres of each level
    unsigned long long* first[2];  ///< first places of each level's members
    BinnedFrame* frame;            ///< by leaf
};

/// Box of a member across the sweep direction.
struct alignas(16) CrossBox {
    float low_y, high_y, low_z, high_z;
};

/// Member in sorted order. Its columns are the rows after it, up to `end`.
struct alignas(16) SortedRow {
    CrossBox box;
    /// Bits of the lower-numbered children of the last level that the triangle also belongs to and, between two meshes,
    /// a bit for its mesh. The leaf does not own pairs with a common bit; see Ownership.
    std::uint64_t conflict;
    std::uint32_t end;
    std::int32_t triangle;
};

/// Members sorted by leaf, then by the bin of their start. A leaf's rows have the places of its members.
struct Sorted {
    std::uint32_t* bin;        ///< by member: first bin | last bin << 16
    std::uint32_t* rank;       ///< by member: index among the members of its first bin
    std::uint32_t* bin_first;  ///< bins + 1 per leaf: first row of each bin; and the end of the leaf's rows
    unsigned* binned;          ///< by leaf: number of members binned so far
    SortedRow* row;
    std::uint16_t* leaf;  ///< by row
};

/// Unit of work of the sweep: 32 rows against `unit_columns` columns, fewer at the ends.
struct alignas(16) SweepUnit {
    std::uint32_t row, row_end;  ///< first row; end of the rows of its leaf
    std::uint32_t column, column_end;
};
inline constexpr unsigned unit_columns = 32;

/// Pair of rows of Sorted; `column` comes after `row`.
struct alignas(8) Candidate {
    std::uint32_t row, column;
};

/// Pair of the result. The pairs with the same first element are stored next to each other, in a bucket.
struct alignas(8) BucketedPair {
    std::int32_t first, second;
};

/// Colliding pair, lower id first; `rank` is its index among the pairs of the same first triangle. In this joint
/// numbering the triangles of a second mesh follow those of the first.
struct Hit {
    std::int32_t a, b;
    std::uint32_t rank;
};

/// Number of hits of each world, if flags by world are requested; else null. All worlds have equally many leaves.
struct WorldHits {
    unsigned long long* count = nullptr;
    std::uint32_t leaves = 1;

    CRUMPLE_HD unsigned long long* of(std::uint32_t leaf) const { return count + leaf / leaves; }
};

/// A list that the device fills.
template <class T>
struct List {
    T* data;
    unsigned long long* count;
    unsigned long long capacity;

    CRUMPLE_HD unsigned long long filled() const { return *count < capacity ? *count : capacity; }
};

}  // namespace crumple::cuda
