#pragma once

// The arrays that the stages of the cuda backend hand on, all in device memory. Structs of plain pointers, passed to
// kernels by value; src/backends/cuda/engine/finder.h owns the memory.
//
//   bounds      scene            -> Points (a row of four a vertex), balls (one a triangle)
//   subdivide   balls            -> Levels: a mask an item; Members: leaf after leaf, in no order within
//   align       members, balls   -> a Frame each leaf
//   sort        members, frames  -> Sorted: members of each leaf by start along its first axis, and their boxes; beside
//                                   them what the kind of query keeps of each; units of work
//   sweep       Sorted, units    -> survivors: pairs whose boxes overlap and that the question's filter keeps
//   narrow      survivors        -> hits
//   output      hits             -> pairs, offsets, hit flags
//
// What decides cost alone (centres, frames, where members lie) is the frame's before: a pass makes it for the next one,
// beside the stages that wait for each other (Guide).
//
// How many members, survivors and hits there will be is known to the device alone. The host gives each list a capacity;
// a kernel that meets a full list counts on without writing, and the host, when it looks (wait), grows the list and
// runs all again. So nothing is dropped, and in a steady frame the host reads one struct of counters, at the end.

#include <bit>
#include <cstddef>
#include <cstdint>

#include "crumple/features.h"
#include "crumple/intersections.h"
#include "geometry/ball.h"
#include "geometry/leaf_frame.h"
#include "geometry/point_rows.h"

namespace crumple::cuda {

inline constexpr int max_fan_out = 64;  ///< children of a cluster: bits of a mask
/// The same between two meshes: a row's conflicts are lower children, of 63 at most 62, and in two bits its side.
inline constexpr int max_fan_out_between = 63;
inline constexpr int bins = 1024;  ///< of a leaf's sweep axis
/// A row tells its leaf in 16 bits, and parents are rows of a grid, of which CUDA has no more.
inline constexpr int max_leaves = 65'535;

using crumple::Row;

/// The rows, whichever there are: one pointer is null.
struct Points {
    Row<float>* f = nullptr;
    Row<double>* d = nullptr;

    PointRows rows() const { return {reinterpret_cast<const float*>(f), reinterpret_cast<const double*>(d)}; }
};

/// What the device counts for the host. Numbers of elements are those wanted, whether or not they fitted.
struct Counters {
    unsigned long long bad_vertex[2], bad_triangle[2];  ///< lowest of each mesh, or all bits set
    unsigned long long bad_end, bad_radius, bad_rest;   ///< the same of one mesh's vertices
    unsigned long long changed;                         ///< lowest corner that is not the known one (known_mesh.h)
    unsigned long long places[2];                       ///< that the members of each level ask for
    unsigned long long units;                           ///< of the sweep
    unsigned long long members[2];                      ///< of each level of subdivision
    unsigned long long unplaced[2];                     ///< of these: there was no room in their child
    unsigned long long interval_tests, box_overlaps;
    unsigned long long survivors;             ///< that no plane separates
    unsigned long long doubles;               ///< of these, undecided in float32
    unsigned long long undecided;             ///< of these, undecided by filters in float64
    unsigned long long beyond;                ///< what expansions cannot hold: for the host
    unsigned long long listed;                ///< tests of features that survivors stand for
    unsigned long long tests[feature_kinds];  ///< of these, by FeatureKind: those that filters leave
    unsigned long long open[feature_kinds];   ///< of these: what the quick decision leaves
    unsigned long long hits;
    unsigned long long parts;  ///< of rows of the answer that are long
};

/// Lists side by side, each with room to spare: list s has the places [first[s], first[s + 1]), and its elements lie in
/// front. Firsts are multiples of 32, so that what a warp's lanes see side by side is of one list.
struct Segments {
    unsigned long long* first;  ///< one more than there are lists
    unsigned long long* count;  ///< wanted, whether or not they fitted

    CRUMPLE_HD unsigned long long end(std::size_t s) const {
        const unsigned long long all = first[s] + count[s];
        return all < first[s + 1] ? all : first[s + 1];
    }
};

/// One level of subdivision. Items are triangles on the first level, whose parents are worlds (worlds_side_by_side.h);
/// on the second they are members of the first. Parent p has the children [p fan_out, (p + 1) fan_out).
struct Level {
    int parents, fan_out;
    Segments items_of;               ///< of each parent; null: one parent has all items
    unsigned long long items;        ///< where that is null
    const std::int32_t* triangle;    ///< by item; null: the item's own number
    const Row<float>* centre;        ///< parents * fan_out
    Row<float>* next_centre;         ///< the same for the next pass
    float* moved;                    ///< by parent: how far its next centres moved last
    std::uint64_t* mask;             ///< by item: children that it belongs to
    Segments members_of;             ///< of each child
    unsigned long long* next_first;  ///< places of its members in the next pass
    CRUMPLE_HD int children() const { return parents * fan_out; }
};

/// Memberships of one level, child after child.
struct Members {
    std::int32_t* triangle;
    std::uint32_t* item;  ///< of the level
    unsigned long long capacity;
};

/// A leaf's frame, and its bins along the first axis.
struct BinnedFrame : LeafFrame {
    float base, scale;  ///< bin of x: (x - base) scale
};

/// The same with what all members have in common.
struct Frame : BinnedFrame {
    float reach;   ///< no corner of a member that is not big is further from the origin, in any coordinate
    float margin;  ///< error of a turned coordinate (docs/align.md)
};

/// By leaf. Where members lie now decides no more than how far they reach.
struct Frames {
    const BinnedFrame* binned;
    unsigned* reach;  ///< bits of a float, which is not negative: ordered as the numbers are

    CRUMPLE_HD float reach_of(std::size_t leaf) const { return std::bit_cast<float>(reach[leaf]); }
    CRUMPLE_HD Frame operator[](std::size_t leaf) const {
        const float far = reach_of(leaf);
        return {binned[leaf], far, box_margin(far)};
    }
};

/// What decides cost alone, never the answer.
struct Guide {
    Row<float>* centre[2];         ///< of each level
    unsigned long long* first[2];  ///< where its members lie
    BinnedFrame* frame;            ///< by leaf
};

/// A member's extent across the sweep direction.
struct alignas(16) CrossBox {
    float low_y, high_y, low_z, high_z;
};

/// A member in its place. Its columns are the rows behind it up to `end`.
struct alignas(16) SortedRow {
    CrossBox box;
    std::uint64_t conflict;  ///< pairs with a common bit are not ours: lower clusters of the last level, sides
    std::uint32_t end;
    std::int32_t triangle;
};

/// Members by leaf and by bin of their start; a leaf's rows are where its members were.
struct Sorted {
    std::uint32_t* bin;        ///< by member: first bin, last bin << 16
    std::uint32_t* rank;       ///< by member: place among those of its bin
    std::uint32_t* bin_first;  ///< bins + 1 a leaf: the last one is the end of its rows
    unsigned* binned;          ///< by leaf: members that are in their bins
    SortedRow* row;
    std::uint16_t* leaf;  ///< by row
};

/// Rows are swept 32 at a time, against `unit_columns` columns at a time: that is a unit of work.
struct alignas(16) Unit {
    std::uint32_t row, row_end;  ///< of one leaf
    std::uint32_t column, column_end;
};
inline constexpr unsigned unit_columns = 32;

struct alignas(8) Candidate {
    std::uint32_t row, column;
};

/// A pair of the answer in the bucket of its first element.
struct alignas(8) BucketedPair {
    std::int32_t first, second;
};

/// A colliding pair, in joint numbering, lower id first; `rank` among those of the same first triangle.
struct Hit {
    std::int32_t a, b;
    std::uint32_t rank;
};

/// Hits of each world, where flags of worlds are asked for; null: they are not. Each world has as many leaves.
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
