#pragma once

// View of the local bodies of a rank.

#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/distributed.h"
#include "world.h"

namespace crumple::python {

/// View of a crumple.World with the bodies of this rank, and of their ids over all ranks. Construct and destroy it with
/// the GIL.
class BorrowedLocalWorld {
   public:
    /// `world` is a crumple.World; `body_ids` may be None.
    BorrowedLocalWorld(nanobind::handle world, nanobind::handle body_ids);

    LocalWorld view() const { return {{bodies_->shapes, bodies_->bodies, at_start_, at_end_}, ids_.view()}; }

   private:
    std::shared_ptr<const Bodies> bodies_;
    BorrowedIds ids_;
    BorrowedPoses start_, end_;
    std::vector<Pose> start_buffer_, end_buffer_;
    std::span<const Pose> at_start_, at_end_;
};

void bind_local_world(nanobind::module_& module);

}  // namespace crumple::python
