#include "mpi/rank_answer.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>

#include <nanobind/stl/string_view.h>

#include "names.h"
#include "views.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

nb::typed<nb::dict, nb::str, double> phase_milliseconds(const DistributedStatistics& statistics) {
    nb::typed<nb::dict, nb::str, double> result;
    for (int i = 0; i < phase_count; ++i) {
        const auto phase = static_cast<Phase>(i);
        const std::string_view name = phase_name(phase);
        result[nb::str(name.data(), name.size())] = statistics[phase];
    }
    return result;
}

void bind_statistics(nb::module_& module) {
    using S = DistributedStatistics;
    nb::class_<S>(module, "Statistics", "What a call did on this rank. Times are in milliseconds.")
        .def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
        .def_prop_ro("phase_milliseconds", phase_milliseconds,
                     "Milliseconds by phase, with the communication that follows each: question, input, ids, place,\n"
                     "members, room, search, rows, output.")
        .def_ro("parts", &S::parts, "Parts of the scene that this rank has searched.")
        .def_ro("members", &S::members, "Triangles of these, each counted in each.")
        .def_ro("bytes_sent", &S::bytes_sent, "Bytes to other ranks.")
        .def_ro("messages", &S::messages, "Messages to other ranks.")
        .def_ro("work_milliseconds", &S::work_milliseconds, "Time of this rank's searches.")
        .def_ro("largest_work", &S::largest_work, "The largest of these over all ranks, in milliseconds.")
        .def_ro("mean_work", &S::mean_work, "Their mean over all ranks, in milliseconds.")
        .def_ro("moved", &S::moved,
                "Whether only vertices have moved since the call before, so that only coordinates were sent.")
        .def_prop_ro(
            "search", [](const S& s) { return Statistics(s.search); },
            "A crumple.Statistics: the sum over this rank's parts.")
        .def("__repr__", [](const S& s) {
            return nb::str(
                       "Statistics(milliseconds={:.3f}, parts={}, members={}, bytes_sent={}, messages={}, "
                       "work_milliseconds={:.3f}, largest_work={:.3f}, mean_work={:.3f}, moved={!r})")
                .format(s.milliseconds, s.parts, s.members, s.bytes_sent, s.messages, s.work_milliseconds,
                        s.largest_work, s.mean_work, s.moved);
        });
}

constexpr auto owner = nb::rv_policy::reference_internal;

const Array<double>& values(const ImpactList& list) { return list.toi; }
const Array<double>& values(const ProximityList& list) { return list.squared_distance; }
const Array<std::uint8_t>& flags(const ImpactList& list) { return list.start; }
const Array<std::uint8_t>& flags(const ProximityList& list) { return list.touching; }

// What both answers about features have. Ranks have lists of two kinds: no others occur where nothing is listed.
template <class A>
void bind_features(nb::class_<A>& type, const char* value, const char* flag) {
    const auto show = [&](const std::string& name, auto as_numpy) { type.def_prop_ro(name.c_str(), as_numpy, owner); };
    for (const auto& [kind, name, pairs] : {std::tuple(FeatureKind::vertex_face, "vertex_face", "vertex_faces"),
                                            std::tuple(FeatureKind::edge_edge, "edge_edge", "edge_edges")}) {
        const std::string of = std::string(name) + '_';
        show(pairs, [kind = kind](const A& a) { return view<std::int32_t>(a.found[kind].pairs, 2U); });
        show(of + "bodies", [kind = kind](const A& a) { return view<std::int32_t>(a.found[kind].bodies, 2U); });
        show(of + value, [kind = kind](const A& a) { return view<double>(values(a.found[kind])); });
        show(of + flag, [kind = kind](const A& a) { return view<bool>(flags(a.found[kind])); });
    }
    show("edges", [](const A& a) { return view<std::int32_t>(a.found.edges, 2U); });
    show("edge_ids", [](const A& a) { return view<std::int32_t>(a.found.edge_ids); });
    show("edge_bodies", [](const A& a) { return view<std::int32_t>(a.found.edge_bodies); });
    type.def_prop_ro("any", [](const A& a) { return a.found.any; })
        .def_prop_ro("total", [](const A& a) { return a.found.count; })
        .def_prop_ro("statistics", [](const A& a) { return DistributedStatistics(a.found.statistics); })
        .def_ro("has_closest", &A::has_closest)
        .def_ro("of_world", &A::of_world);
}

void bind_impacts(nb::module_& module) {
    using I = RankImpacts;
    nb::class_<I> impacts(module, "ImpactsAnswer", "One rank's answer about motion; crumple.mpi.Impacts shows it.");
    bind_features(impacts, "toi", "start");
    impacts.def_prop_ro("wants", [](const I& a) { return name_of(motion_wants_names, a.output); })
        .def_prop_ro("first", [](const I& a) -> nb::object {
            const FirstImpact& first = a.found.first;
            if (!first.found) return nb::none();
            const std::string_view kind = feature_kind_name(first.kind);
            nb::object bodies = nb::none();
            if (a.of_world) bodies = nb::make_tuple(first.bodies.first, first.bodies.second);
            return nb::make_tuple(nb::str(kind.data(), kind.size()), nb::make_tuple(first.pair.a, first.pair.b), bodies,
                                  first.toi, first.start);
        });
}

void bind_nearby(nb::module_& module) {
    using N = RankNearby;
    nb::class_<N> nearby(module, "NearbyAnswer", "One rank's answer about nearness; crumple.mpi.Nearby shows it.");
    bind_features(nearby, "squared_distance", "touching");
    nearby.def_prop_ro("wants", [](const N& a) { return name_of(near_wants_names, a.output); });
    for (const auto& [kind, type, at] : {std::tuple(FeatureKind::vertex_face, "vertex_face_type", "vertex_face_at"),
                                         std::tuple(FeatureKind::edge_edge, "edge_edge_type", "edge_edge_at")}) {
        nearby.def_prop_ro(
            type, [kind = kind](const N& a) { return view<std::uint8_t>(a.found[kind].type); }, owner);
        nearby.def_prop_ro(
            at, [kind = kind](const N& a) { return view<double>(a.found[kind].at, 2U); }, owner);
    }
}

template <class A>
void bind_contacts(nb::class_<A>& type) {
    type.def_prop_ro(
            "contact_kinds", [](const A& a) { return view<std::uint8_t>(a.found.contacts.kinds); }, owner)
        .def_prop_ro(
            "contact_offsets", [](const A& a) { return view<std::int64_t>(a.found.contacts.offsets); }, owner)
        .def_prop_ro(
            "contact_points", [](const A& a) { return view<double>(a.found.contacts.points, 3U); }, owner);
}

void bind_world_answer_of_rank(nb::module_& module) {
    using W = RankWorldAnswer;
    nb::class_<W> answer(module, "WorldAnswer", "One rank's answer for a world; crumple.mpi.WorldResult shows it.");
    answer.def("__len__", [](const W& a) { return a.found.bodies.size(); })
        .def_prop_ro("wants", [](const W& a) { return name_of(wants_names, a.output); })
        .def_prop_ro("any", [](const W& a) { return a.found.any; })
        .def_prop_ro("count", [](const W& a) { return a.found.count; })
        .def_prop_ro(
            "bodies", [](const W& a) { return view<std::int32_t>(a.found.bodies, 2U); }, owner)
        .def_prop_ro(
            "pairs", [](const W& a) { return view<std::int32_t>(a.found.pairs, 2U); }, owner)
        .def_prop_ro("statistics", [](const W& a) { return DistributedStatistics(a.found.statistics); });
    bind_contacts(answer);
}

}  // namespace

void bind_rank_answer(nb::module_& module) {
    bind_statistics(module);
    bind_impacts(module);
    bind_nearby(module);
    bind_world_answer_of_rank(module);
    using A = RankAnswer;
    nb::class_<A> answer(module, "Answer", "One rank's answer to a call; crumple.mpi.Result gives access to it.");
    answer.def("__len__", [](const A& a) { return a.found.pairs.size(); })
        .def_prop_ro(
            "pairs", [](const A& a) { return view<std::int32_t>(a.found.pairs, 2U); }, owner)
        .def_prop_ro("total", [](const A& a) { return a.found.count; })
        .def_prop_ro("statistics", [](const A& a) { return DistributedStatistics(a.found.statistics); })
        .def_ro("has_contacts", &A::has_contacts);
    bind_contacts(answer);
}

}  // namespace crumple::python
