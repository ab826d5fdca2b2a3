#pragma once

// What a question does where [MZ] has one triangle test: the seam between the order of the stages, which knows balls,
// boxes and who owns a pair, and the questions, which know the rest. A virtual call costs nothing here: there are a few
// a leaf, and one for each tile of a large one.

#include <cstddef>
#include <cstdint>

#include "backends/cpu/stages/layout.h"
#include "backends/cpu/stages/leaf_members.h"
#include "backends/cpu/stages/ownership.h"
#include "crumple/intersections.h"

namespace crumple::cpu {

struct Call;

/// One question, with the scratch and the findings of each worker. The members between begin() and finish() are called
/// by several workers at once, each with its own number.
class LeafQuestion {
   public:
    virtual ~LeafQuestion() = default;

    /// A search begins; nothing is found yet. The bounds are there.
    virtual void begin(const Call& call) = 0;
    /// Leaves out (Buffers::included) triangles that need not be searched. `levels`: those above the scene, to which
    /// one may be added.
    virtual void leave_out(const Call&, Levels& /*levels*/) {}
    /// Reserves scratch of a worker for a leaf of so many members and rows, so that warm calls allocate nothing.
    virtual void make_room(const Call&, std::int64_t /*members*/, std::int64_t /*rows*/, std::size_t /*worker*/) {}

    /// Asked before each leaf. Throws if the call was cancelled.
    virtual bool stop() const = 0;
    /// Beside `align`: boxes of a leaf's members, and records.
    virtual void build(const BuildInput& input, LeafMembers& members, std::size_t worker) = 0;
    /// Beside `sort`: each record to its member's row.
    virtual void place(const SortedLeaf& leaf, std::size_t worker) = 0;
    /// Stages `sweep` and `narrow` of rows [first, last) of a leaf that `builder` has built.
    virtual void sweep(const SortedLeaf& leaf, const Ownership& ownership, std::int64_t first, std::int64_t last,
                       std::size_t builder, std::size_t worker) = 0;

    /// Begin and end a unit of the work of a stream, on a worker. Rows that sweep() finds between belong to the unit.
    virtual void begin_unit(std::int64_t /*unit*/, std::size_t /*worker*/) {}
    virtual void end_unit(std::size_t /*worker*/) {}
    /// The search ends by an error; may be called several times.
    virtual void fail() {}

    /// The search is over: adds what sweep() counted, and its times.
    virtual void finish(Statistics& statistics) = 0;
};

}  // namespace crumple::cpu
