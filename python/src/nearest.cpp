#include "nearest.h"

#include <utility>

#include "arguments.h"
#include "detector.h"
#include "feature_search.h"
#include "gil.h"
#include "views.h"
#include "world.h"
#include "world_search.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

void make_nearest(DistanceQuery* place, nb::handle radius, const PairFilter& rules) {
    new (place) DistanceQuery{.radius = real("radius", radius), .filter = rules};
}

}  // namespace

NearestAnswer find_nearest(nb::handle self, nb::handle world, nb::handle poses, const DistanceQuery& question,
                           nb::handle excluded, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<DistanceQuery> asked(world, question, excluded);
    const Bodies& bodies = *asked.bodies;
    const BorrowedPoses at(poses, bodies);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    const World view = posed_world(bodies, at, detector);
    NearestAnswer answer{detector.storage<Distances>(), copied};
    without_gil([&] { detector.find(view, asked.question, *answer.storage); }, detector.stop());
    return answer;
}

void bind_nearest(nb::module_& module) {
    constexpr auto owner = nb::rv_policy::reference_internal;
    using A = NearestAnswer;
    nb::class_<DistanceQuery>(module, "Nearest", "What is asked about the distances of bodies.")
        .def("__init__", make_nearest, "radius"_a.none(), "rules"_a);
    nb::class_<A>(module, "NearestAnswer",
                  "The library's answer about distances of bodies; crumple.NearestBodies gives access to it.")
        .def_prop_ro(
            "bodies", [](const A& a) { return view<std::int32_t>(a.found().bodies, 2U); }, owner)
        .def_prop_ro(
            "squared_distance", [](const A& a) { return view<double>(a.found().squared_distance); }, owner)
        .def_prop_ro(
            "touching", [](const A& a) { return view<bool>(a.found().touching); }, owner)
        .def_prop_ro(
            "triangles", [](const A& a) { return view<std::int32_t>(a.found().triangles, 2U); }, owner)
        .def_prop_ro(
            "points", [](const A& a) { return view<double>(a.found().points, 2U, 3U); }, owner)
        .def_prop_ro("statistics", [](const A& a) { return Statistics(a.found().statistics); })
        .def_ro("copy", &A::copy);
}

}  // namespace crumple::python
