#include "candidates.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "detector.h"
#include "feature_search.h"
#include "gil.h"
#include "names.h"
#include "views.h"
#include "world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

void make_question(CandidateQuery* place, const nb::tuple& kinds, nb::handle inflation, nb::handle weld,
                   const PairFilter& rules) {
    CandidateQuery question;
    question.kinds.clear();
    for (const nb::handle kind : kinds) question.kinds.push_back(named(candidate_kind_names, "kinds", kind));
    question.inflation = real("inflation", inflation);
    question.weld = flag("weld", weld);
    question.filter = rules;
    new (place) CandidateQuery(std::move(question));
}

}  // namespace

CandidatesAnswer find_candidates(nb::handle self, const nb::tuple& mesh, nb::handle end, const CandidateQuery& question,
                                 nb::handle copy, const nb::tuple& lists) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    std::optional<BorrowedEnd> at_end;
    if (!end.is_none()) at_end.emplace(end, start.mesh);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    CandidatesAnswer answer{detector.storage<Candidates>(), question.kinds, false, copied};
    const MeshView view = at_end ? start.view.moving_to(at_end->view()) : start.view;
    without_gil([&] { detector.find(view, question, *answer.storage); }, detector.stop());
    return answer;
}

CandidatesAnswer find_candidates_in_world(nb::handle self, nb::handle world, nb::handle poses, nb::handle end_poses,
                                          const CandidateQuery& question, nb::handle excluded, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<CandidateQuery> asked(world, question, excluded);
    const Bodies& bodies = *asked.bodies;
    const BorrowedPoses start(poses, bodies), end(end_poses, bodies, BorrowedPoses::When::end);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    const World view = moving_world(bodies, start, end, detector);
    CandidatesAnswer answer{detector.storage<Candidates>(), question.kinds, true, copied};
    without_gil([&] { detector.find(view, asked.question, *answer.storage); }, detector.stop());
    return answer;
}

void bind_candidates(nb::module_& module) {
    constexpr auto owner = nb::rv_policy::reference_internal;
    using A = CandidatesAnswer;
    nb::class_<CandidateQuery>(module, "CandidateQuestion", "What is asked about candidates.")
        .def("__init__", make_question, "kinds"_a, "inflation"_a.none(), "weld"_a.none(), "rules"_a);
    nb::class_<A> type(module, "CandidatesAnswer",
                       "The library's answer about candidates; crumple.Candidates gives access to it.");
    for (const auto& [name, kind] : candidate_kind_names) {
        const CandidateKind of = kind;
        type.def_prop_ro(
            plural_of_kind(name).c_str(), [of](const A& a) { return view<std::int32_t>(a.found()[of].pairs, 2U); },
            owner);
        type.def_prop_ro((std::string(name) + "_bodies").c_str(),
                         [of](const A& a) { return view<std::int32_t>(a.found()[of].bodies, 2U); }, owner);
    }
    type.def_prop_ro(
            "edges", [](const A& a) { return view<std::int32_t>(a.found().edges, 2U); }, owner)
        .def_prop_ro(
            "first_edge", [](const A& a) { return view<std::int64_t>(a.found().first_edge); }, owner)
        .def_prop_ro(
            "points", [](const A& a) { return view<std::int32_t>(a.found().points); }, owner)
        .def_prop_ro(
            "first_point", [](const A& a) { return view<std::int64_t>(a.found().first_point); }, owner)
        .def_prop_ro("kinds",
                     [](const A& a) {
                         nb::list names;
                         for (const CandidateKind kind : a.kinds) {
                             const std::string_view name = name_of(candidate_kind_names, kind);
                             names.append(nb::str(name.data(), name.size()));
                         }
                         return nb::tuple(names);
                     })
        .def_prop_ro("count", [](const A& a) { return a.found().count; })
        .def_prop_ro("statistics", [](const A& a) { return Statistics(a.found().statistics); })
        .def_ro("of_world", &A::of_world)
        .def_ro("copy", &A::copy);
}

}  // namespace crumple::python
