#pragma once

// The bodies that one rank brings, in place.

#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/distributed.h"
#include "world.h"

namespace crumple::python {

/// Needs the GIL to come and go.
class BorrowedWorldShare {
   public:
    /// `world` is a crumple.World; all others may be None. `poses` None: the world's own. `excluded`:
    /// (n, 2) int32, numbers of bodies over all ranks.
    BorrowedWorldShare(nanobind::handle world, nanobind::handle body_ids, nanobind::handle poses,
                       nanobind::handle end_poses, nanobind::handle excluded);

    WorldShare view() const { return {{bodies_->shapes, bodies_->bodies, at_start_, at_end_}, ids_.view()}; }
    /// The question, which then also excludes the pairs of bodies.
    template <class Question>
    Question with_excluded(Question question) const {
        question.filter.excluded_bodies = excluded_;
        return question;
    }

   private:
    std::shared_ptr<const Bodies> bodies_;
    BorrowedIds ids_;
    BorrowedPoses start_, end_;
    std::vector<Pose> start_buffer_, end_buffer_;
    std::span<const Pose> at_start_, at_end_;
    std::vector<BodyPair> excluded_;
};

void bind_world_share(nanobind::module_& module);

}  // namespace crumple::python
