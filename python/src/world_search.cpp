#include "world_search.h"

#include <utility>

#include "arguments.h"
#include "detector.h"
#include "gil.h"
#include "names.h"
#include "world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

void make_question(IntersectionQuery* place, nb::handle wants, nb::handle neighbours, nb::handle intersections,
                   nb::handle weld, nb::handle bodies, nb::handle groups, nb::handle excluded_groups,
                   nb::handle index) {
    IntersectionQuery question;
    question.output = named(wants_names, "wants", wants);
    question.neighbours = named(neighbours_names, "neighbours", neighbours);
    question.kind = named(intersections_names, "intersections", intersections);
    question.weld = flag("weld", weld);
    question.filter.bodies = named(wanted_names, "bodies", bodies);
    question.filter.groups = named(wanted_names, "groups", groups);
    question.filter.excluded_groups = group_pairs(excluded_groups);
    question.index = flag("index", index);
    new (place) IntersectionQuery(std::move(question));
}

}  // namespace

World posed_world(const Bodies& bodies, const BorrowedPoses& poses, SharedDetector& detector) {
    World world{bodies.shapes, bodies.bodies, {}};
    if (poses.device() == BorrowedArray::on_host) {
        world.poses = poses.read(bodies, detector.poses());
    } else {
        check_device(detector, poses.device());
        world.device_poses = poses.on_device(bodies);
    }
    return world;
}

// The world may get other poses while the call runs without the GIL: it reads those that were there when it began.
WorldAnswer find_world(nb::handle self, nb::handle world, nb::handle poses, const IntersectionQuery& question,
                       nb::handle excluded, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const BorrowedWorld& given = given_world(world);
    const std::shared_ptr<const Bodies> bodies = given.bodies;
    const BorrowedPoses at = poses.is_none() ? given.poses : BorrowedPoses(poses, *bodies);
    const bool copied = flag("copy", copy);
    IntersectionQuery asked = question;
    asked.filter.excluded_bodies = excluded_bodies(*bodies, excluded);
    const SharedDetector::Turn turn(detector);
    const World view = posed_world(*bodies, at, detector);
    WorldAnswer answer{detector.storage<Intersections>(), asked.output, asked.index && asked.output >= Output::pairs,
                       copied};
    without_gil([&] { detector.find(view, asked, *answer.storage); }, detector.stop());
    return answer;
}

void bind_question(nb::module_& module) {
    nb::class_<IntersectionQuery>(module, "Question", "What is asked about a world.")
        .def("__init__", make_question, "wants"_a.none(), "neighbours"_a.none(), "intersections"_a.none(),
             "weld"_a.none(), "bodies"_a.none(), "groups"_a.none(), "excluded_groups"_a.none(), "index"_a.none());
}

}  // namespace crumple::python
