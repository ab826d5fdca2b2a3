#pragma once

// Interface between order.cpp, which runs the stages that are the same for all queries (balls, leaves, sorting,
// ownership of pairs), and the steps that depend on the kind of query: the boxes and records of a leaf's members, and
// the filters and decisions of candidate pairs. A leaf is a small set of triangles that one sweep searches. The cost of
// virtual calls does not matter: there are a few per leaf, and one per tile (range of rows) of a large leaf.

#include <cstddef>
#include <cstdint>

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/leaf_members.h"
#include "backends/cpu/stages/ownership.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

struct Call;

/// One query, with scratch and results of each worker. Several workers call the members between begin() and finish() at
/// once, each with its own number.
class LeafQuery {
   public:
    virtual ~LeafQuery() = default;

    /// Starts a search: discards earlier results. Called after stage `bounds`.
    virtual void begin(const Call& call) = 0;
    /// Leaves out triangles that need not be searched (Buffers::included). `levels`: the levels of subdivision above
    /// the scene; an override may add one.
    virtual void leave_out(const Call&, Levels& /*levels*/) {}
    /// Reserves a worker's scratch for a leaf with these numbers of members and rows, so that warm calls allocate
    /// nothing.
    virtual void reserve(const Call&, std::int64_t /*members*/, std::int64_t /*rows*/, std::size_t /*worker*/) {}

    /// Returns true if the search may end. Called before each leaf. Throws if the call was cancelled.
    virtual bool stop() const = 0;
    /// Completes `align`: computes the boxes and the records of a leaf's members.
    virtual void build(const BuildInput& input, LeafMembers& members, std::size_t worker) = 0;
    /// Completes `sort`: copies each record to its member's row.
    virtual void place(const SortedLeaf& leaf, std::size_t worker) = 0;
    /// Runs stages `sweep` and `narrow` for rows [first, last) of a leaf that worker `builder` has built.
    virtual void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
                       std::size_t builder, std::size_t worker) = 0;

    /// Begin and end a unit of a stream (RowStream: queries/row_stream.h) on a worker. Pairs that sweep() finds in
    /// between belong to the unit.
    virtual void begin_unit(std::int64_t /*unit*/, std::size_t /*worker*/) {}
    virtual void end_unit(std::size_t /*worker*/) {}
    /// Reports that the search ends with an error. May be called several times.
    virtual void fail() {}

    /// Ends a search: adds the counts and times of sweep().
    virtual void finish(Statistics& statistics) = 0;
};

}  // namespace crumple::cpu
