#include "mpi/local_world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {

BorrowedLocalWorld::BorrowedLocalWorld(nb::handle world, nb::handle body_ids)
    : bodies_(given_world(world).bodies),
      ids_(body_ids, "body", static_cast<std::int64_t>(bodies_->bodies.size())),
      start_(given_world(world).poses),
      end_(given_world(world).end_poses) {
    at_start_ = start_.read(*bodies_, start_buffer_);
    if (end_.given()) at_end_ = end_.read(*bodies_, end_buffer_);
}

void bind_local_world(nb::module_& module) {
    nb::class_<BorrowedLocalWorld>(module, "LocalWorld", "Local bodies of a rank.")
        .def(nb::init<nb::handle, nb::handle>(), "world"_a, "body_ids"_a.none());
}

}  // namespace crumple::python
