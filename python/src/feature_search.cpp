#include "feature_search.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "arrays.h"
#include "detector.h"
#include "gil.h"
#include "names.h"
#include "part.h"
#include "world.h"
#include "world_search.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// Of one mesh, where pairs may be told apart by groups alone.
PairFilter rules_of_mesh(nb::handle wanted, nb::handle excluded_groups) {
    PairFilter rules;
    rules.groups = named(wanted_names, "wanted", wanted);
    rules.excluded_groups = group_pairs(excluded_groups);
    return rules;
}

// Without bodies that are excluded, which the call itself is given.
PairFilter rules_of_world(nb::handle bodies, nb::handle groups, nb::handle excluded_groups) {
    PairFilter rules;
    rules.bodies = named(wanted_names, "bodies", bodies);
    rules.groups = named(wanted_names, "groups", groups);
    rules.excluded_groups = group_pairs(excluded_groups);
    return rules;
}

void make_motion(ImpactQuery* place, nb::handle wants, nb::handle min_distance, nb::handle min_distance_share,
                 nb::handle weld, const PairFilter& rules, nb::handle index, nb::handle triangle_pairs) {
    ImpactQuery question;
    question.output = named(motion_wants_names, "wants", wants);
    question.min_distance = real("min_distance", min_distance);
    question.min_distance_share = real("min_distance_share", min_distance_share);
    question.weld = flag("weld", weld);
    question.filter = rules;
    question.index = flag("index", index);
    question.triangle_pairs = flag("triangle_pairs", triangle_pairs);
    new (place) ImpactQuery(std::move(question));
}

void make_near(ProximityQuery* place, nb::handle wants, nb::handle radius, nb::handle strict, nb::handle closest,
               nb::handle least, nb::handle weld, nb::handle rings, nb::handle rest_radius, const PairFilter& rules,
               nb::handle index) {
    ProximityQuery question;
    question.output = named(near_wants_names, "wants", wants);
    question.radius = real("radius", radius);
    question.strict = flag("strict", strict);
    question.closest = flag("closest", closest);
    question.least = flag("least", least);
    question.weld = flag("weld", weld);
    question.rings = integer<std::int32_t>("rings", rings);
    question.rest_radius = real("rest_radius", rest_radius);
    question.filter = rules;
    question.index = flag("index", index);
    new (place) ProximityQuery(std::move(question));
}

bool lists_triangle_pairs(const ImpactQuery& question) {
    return question.triangle_pairs && question.output == Output::pairs;
}

// (n, 3), which owns its memory.
template <class Number>
nb::object give_rows(const Array<double>& values) {
    import_numpy();
    const auto given = new std::vector<Number>(values.begin(), values.end());
    const nb::capsule owner(given, [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, Number>(given->data(), {given->size() / 3, 3}, owner));
}

}  // namespace

AskedOfVertices::AskedOfVertices(const ProximityQuery& asked, const BorrowedMesh& mesh, nb::handle radii,
                                 nb::handle rest)
    : question(asked) {
    if (!radii.is_none()) question.radii = of_vertices.emplace(radii, mesh).view();
    if (!rest.is_none()) question.rest = at_rest.emplace(rest, mesh, "", BorrowedEnd::When::rest).view();
}

AskedOfMesh::AskedOfMesh(const SharedDetector& detector, const nb::tuple& given, const nb::tuple& listed, void* stream)
    : mesh(given, "", stream), lists(listed, mesh.device(), "", stream), view(mesh.view()) {
    check_device(detector, mesh.device());
    lists.put_into(view);
}

World moving_world(const Bodies& bodies, const BorrowedPoses& start, const BorrowedPoses& end,
                   SharedDetector& detector) {
    World world = posed_world(bodies, start, detector);
    if (!end.given()) return world;
    if (end.device() == BorrowedArray::on_host) {
        world.end_poses = end.read(bodies, detector.end_poses());
    } else {
        check_device(detector, end.device());
        world.device_end_poses = end.on_device(bodies);
    }
    return world;
}

ImpactsAnswer find_impacts(nb::handle self, const nb::tuple& mesh, nb::handle end, const ImpactQuery& question,
                           nb::handle copy, const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    const BorrowedEnd at_end(end, start.mesh);
    const bool copied = flag("copy", copy), index = question.index && question.output == Output::pairs;
    const SharedDetector::Turn turn(detector);
    ImpactsAnswer answer{detector.storage<Impacts>(),   question.output, false, index, false, false, copied,
                         lists_triangle_pairs(question)};
    without_gil([&] { detector.find(start.view.moving_to(at_end.view()), question, *answer.storage); },
                detector.stop());
    return answer;
}

ImpactsAnswer find_impacts_in_world(nb::handle self, nb::handle world, nb::handle poses, nb::handle end_poses,
                                    const ImpactQuery& question, nb::handle excluded, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<ImpactQuery> asked(world, question, excluded);
    const Bodies& bodies = *asked.bodies;
    const BorrowedPoses start(poses, bodies), end(end_poses, bodies, BorrowedPoses::When::end);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    const World view = moving_world(bodies, start, end, detector);
    ImpactsAnswer answer{detector.storage<Impacts>(),   question.output, true, false, false, false, copied,
                         lists_triangle_pairs(question)};
    without_gil([&] { detector.find(view, asked.question, *answer.storage); }, detector.stop());
    return answer;
}

nb::tuple find_free_step(nb::handle self, const nb::tuple& mesh, nb::handle end, const ImpactQuery& question,
                         const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    const BorrowedEnd at_end(end, start.mesh);
    const SharedDetector::Turn turn(detector);
    const FreeStep step = without_gil(
        [&] { return detector.find(start.view.moving_to(at_end.view()), FreeStepQuery{question}); }, detector.stop());
    const bool single = start.view.vertices.type == ScalarType::float32 && at_end.view().type == ScalarType::float32;
    return nb::make_tuple(step.share, single ? give_rows<float>(step.positions) : give_rows<double>(step.positions));
}

NearbyAnswer find_near(nb::handle self, const nb::tuple& mesh, const ProximityQuery& asked, nb::handle radii,
                       nb::handle rest, nb::handle copy, const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh given(detector, mesh, lists);
    const AskedOfVertices vertices(asked, given.mesh, radii, rest);
    const ProximityQuery& question = vertices.question;
    const bool copied = flag("copy", copy), index = question.index && question.output == Output::pairs;
    const SharedDetector::Turn turn(detector);
    const bool listed = question.output == Output::pairs;
    NearbyAnswer answer{detector.storage<Proximities>(), question.output,          false, index,
                        listed && question.closest,      listed && question.least, copied};
    without_gil([&] { detector.find(given.view, question, *answer.storage); }, detector.stop());
    return answer;
}

NearbyAnswer find_near_in_world(nb::handle self, nb::handle world, nb::handle poses, const ProximityQuery& question,
                                nb::handle excluded, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<ProximityQuery> asked(world, question, excluded);
    const BorrowedPoses at(poses, *asked.bodies);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    const World view = posed_world(*asked.bodies, at, detector);
    const bool closest = question.closest && question.output == Output::pairs;
    NearbyAnswer answer{detector.storage<Proximities>(), question.output, true, false, closest, false, copied};
    without_gil([&] { detector.find(view, asked.question, *answer.storage); }, detector.stop());
    return answer;
}

ImpactsAnswer find_impacts_in_part(nb::handle self, nb::handle part, const ImpactQuery& question, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const Part& of = given_part(part);
    const bool copied = flag("copy", copy), index = question.index && question.output == Output::pairs;
    const SharedDetector::Turn turn(detector);
    ImpactsAnswer answer{detector.storage<Impacts>(), question.output, false, index, false, false, copied};
    answer.of_part = true;
    without_gil([&] { detector.find(of, question, *answer.storage); }, detector.stop());
    return answer;
}

NearbyAnswer find_near_in_part(nb::handle self, nb::handle part, const ProximityQuery& question, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const Part& of = given_part(part);
    const bool listed = question.output == Output::pairs;
    const bool copied = flag("copy", copy), index = question.index && listed;
    const SharedDetector::Turn turn(detector);
    NearbyAnswer answer{detector.storage<Proximities>(), question.output,          false, index,
                        listed && question.closest,      listed && question.least, copied};
    answer.of_part = true;
    without_gil([&] { detector.find(of, question, *answer.storage); }, detector.stop());
    return answer;
}

std::vector<Part> partition_motion(nb::handle self, const nb::tuple& mesh, nb::handle end, const ImpactQuery& question,
                                   nb::handle count, const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    const BorrowedEnd at_end(end, start.mesh);
    const int parts = integer<int>("count", count);
    const SharedDetector::Turn turn(detector);
    return without_gil([&] { return detector.partition(start.view.moving_to(at_end.view()), question, parts); },
                       detector.stop());
}

std::vector<Part> partition_near(nb::handle self, const nb::tuple& mesh, const ProximityQuery& asked, nb::handle radii,
                                 nb::handle rest, nb::handle count, const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh given(detector, mesh, lists);
    const AskedOfVertices vertices(asked, given.mesh, radii, rest);
    const int parts = integer<int>("count", count);
    const SharedDetector::Turn turn(detector);
    return without_gil([&] { return detector.partition(given.view, vertices.question, parts); }, detector.stop());
}

void bind_feature_questions(nb::module_& module) {
    nb::class_<PairFilter>(module, "Rules", "Which pairs are wanted.");
    module.def("rules_of_mesh", rules_of_mesh, "wanted"_a.none(), "excluded_groups"_a.none());
    module.def("rules_of_world", rules_of_world, "bodies"_a.none(), "groups"_a.none(), "excluded_groups"_a.none());
    nb::class_<ImpactQuery>(module, "Motion", "What is asked about motion.")
        .def("__init__", make_motion, "wants"_a.none(), "min_distance"_a.none(), "min_distance_share"_a.none(),
             "weld"_a.none(), "rules"_a, "index"_a.none(), "triangle_pairs"_a.none());
    nb::class_<ProximityQuery>(module, "Near", "What is asked about nearness.")
        .def("__init__", make_near, "wants"_a.none(), "radius"_a.none(), "strict"_a.none(), "closest"_a.none(),
             "least"_a.none(), "weld"_a.none(), "rings"_a.none(), "rest_radius"_a.none(), "rules"_a, "index"_a.none());
}

}  // namespace crumple::python
