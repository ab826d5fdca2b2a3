#pragma once

// The arrays that the stages of the cuda backend hand on, all in device memory. Structs of plain pointers, passed to
// kernels by value; src/engine/cuda/search.h owns the memory.
//
//   bounds      scene            -> Points (a row of four a vertex), balls (one a triangle)
//   subdivide   balls            -> Levels: a mask an item; Members: leaf after leaf, in no order within
//   align       members, balls   -> a Frame each leaf
//   sort        members, frames  -> Sorted: members of each leaf by start along its first axis, and their boxes; beside
//                                   them what the question keeps of each (questions/)
//   sweep       Sorted           -> survivors: pairs whose boxes overlap and that the question's filter keeps
//   narrow      survivors        -> hits
//   output      hits             -> pairs, offsets, hit flags
//
// How many members, survivors and hits there will be is known to the device alone. The host gives each list a capacity;
// a kernel that meets a full list counts on without writing, and the host, when it looks (wait), grows the list and
// runs all again. So nothing is dropped, and in a steady frame the host reads one struct of counters, at the end.

#include <cstdint>

#include "crumple/collisions.h"
#include "geometry/ball.h"
#include "geometry/leaf_frame.h"
#include "geometry/point_rows.h"

namespace crumple::cuda {

inline constexpr int max_fan_out = 64;  ///< children of a cluster: bits of a mask
/// The same between two meshes: a row's conflicts are lower children, of 63 at most 62, and in two bits its side.
inline constexpr int max_fan_out_between = 63;
inline constexpr int bins = 1024;  ///< of a leaf's sweep axis

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
    unsigned long long members[2];                      ///< of each level of subdivision
    unsigned long long interval_tests, box_overlaps;
    unsigned long long next_unit;  ///< of the sweep: that no warp has taken yet
    unsigned long long survivors;  ///< that no plane separates
    unsigned long long doubles;    ///< of these, undecided in float32
    unsigned long long undecided;  ///< of these, undecided by filters in float64
    unsigned long long beyond;     ///< what expansions cannot hold: for the host
    unsigned long long hits;
    unsigned long long long_rows;  ///< rows of the answer that a block sorts
};

/// One level of subdivision. Items are triangles on the first level, members of the first level on the second. Parent p
/// has the items [first[p], first[p + 1]) and the children [p fan_out, (p + 1) fan_out).
struct Level {
    int parents, fan_out;
    const unsigned long long* first;  ///< parents + 1; null: one parent has all items
    unsigned long long items;         ///< where first is null
    const std::int32_t* triangle;     ///< by item; null: the item's own number
    Row<float>* centre;               ///< parents * fan_out
    float* moved;                     ///< by parent: how far its centres moved last
    std::uint64_t* mask;              ///< by item: children that it belongs to
    unsigned long long* count;        ///< by child
    unsigned long long* cursor;       ///< by child: scratch
    unsigned long long* child_first;  ///< children + 1: the next level's `first`
    CRUMPLE_HD int children() const { return parents * fan_out; }
};

/// Memberships of one level, child after child.
struct Members {
    std::int32_t* triangle;
    std::uint32_t* item;   ///< of the level
    std::uint16_t* child;  ///< of the level
    unsigned long long capacity;
};

/// A leaf's frame, and what all its members have in common.
struct Frame : LeafFrame {
    float reach;        ///< no corner of a member that is not big is further from the origin, in any coordinate
    float margin;       ///< error of a turned coordinate (docs/align.md)
    float base, scale;  ///< bin of x: (x - base) scale
};

/// A member's extent across the sweep direction.
struct alignas(16) CrossBox {
    float low_y, high_y, low_z, high_z;
};

/// Members by leaf and by bin of their start. A row's columns are the rows behind it up to `end`.
///
/// Rows are swept 32 at a time, against `unit_columns` columns at a time: that is a unit. Prefix sums of the groups'
/// units tell which rows a unit has ([MZ] sec. 3.1).
struct Sorted {
    std::uint32_t* bin;        ///< by member: first bin, last bin << 16
    std::uint32_t* rank;       ///< by member: place among those of its bin
    std::uint32_t* bin_first;  ///< leaves * bins + 1
    CrossBox* box;             ///< by row, as all that follow
    std::uint64_t* conflict;   ///< pairs with a common bit are not ours: lower clusters of the last level, sides
    std::uint32_t* end;
    std::int32_t* triangle;
    std::uint16_t* leaf;
    std::uint32_t* group_end;        ///< by group of 32 rows: largest end
    unsigned long long* unit_first;  ///< groups + 1
};
inline constexpr unsigned unit_columns = 128;

/// First triangles whose pairs are counted together, too, so that prefix sums need one kernel.
inline constexpr int offset_tile = 2048;

struct Candidate {
    std::uint32_t row, column;
};

/// A colliding pair, in joint numbering, lower id first; `rank` among those of the same first triangle.
struct Hit {
    std::int32_t a, b;
    std::uint32_t rank;
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
