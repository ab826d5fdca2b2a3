#include "mpi/world_share.h"

#include <nanobind/ndarray.h>

#include "arguments.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {

BorrowedWorldShare::BorrowedWorldShare(nb::handle world, nb::handle body_ids, nb::handle poses, nb::handle end_poses,
                                       nb::handle excluded)
    : bodies_(given_world(world).bodies),
      ids_(body_ids, "body", static_cast<std::int64_t>(bodies_->bodies.size())),
      start_(poses.is_none() ? given_world(world).poses : BorrowedPoses(poses, *bodies_)),
      end_(end_poses, *bodies_, BorrowedPoses::When::end) {
    at_start_ = start_.read(*bodies_, start_buffer_);
    if (end_.given()) at_end_ = end_.read(*bodies_, end_buffer_);
    if (excluded.is_none()) return;
    nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu> pairs;
    if (!nb::try_cast(excluded, pairs)) throw std::logic_error("crumple/_rank_worlds.py gave no pairs of bodies");
    for (std::size_t i = 0; i < pairs.shape(0); ++i) excluded_.push_back({pairs(i, 0), pairs(i, 1)});
}

void bind_world_share(nb::module_& module) {
    nb::class_<BorrowedWorldShare>(module, "WorldShare", "The bodies that one rank brings to a call.")
        .def(nb::init<nb::handle, nb::handle, nb::handle, nb::handle, nb::handle>(), "world"_a, "body_ids"_a.none(),
             "poses"_a.none(), "end_poses"_a.none(), "excluded"_a.none());
}

}  // namespace crumple::python
