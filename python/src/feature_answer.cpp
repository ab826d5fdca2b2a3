#include "feature_answer.h"

#include <cstdint>

#include <nanobind/stl/string_view.h>

#include "names.h"
#include "views.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

constexpr auto owner = nb::rv_policy::reference_internal;

// The arrays of a list, by their names in Python.
struct ListNames {
    const char *pairs, *bodies, *value, *flag, *offsets, *second_offsets, *by_second;
};

const Array<double>& values(const ImpactList& list) { return list.toi; }
const Array<double>& values(const ProximityList& list) { return list.squared_distance; }
const Array<std::uint8_t>& flags(const ImpactList& list) { return list.start; }
const Array<std::uint8_t>& flags(const ProximityList& list) { return list.touching; }

// `list_of`: of the answer.
template <class A, class ListOf>
void bind_list(nb::class_<A>& type, ListOf list_of, const ListNames& names) {
    const auto show = [&](const char* name, auto as_numpy) {
        type.def_prop_ro(
            name, [list_of, as_numpy](const A& a) { return as_numpy(list_of(a.found())); }, owner);
    };
    show(names.pairs, [](const auto& list) { return view<std::int32_t>(list.pairs, 2U); });
    show(names.bodies, [](const auto& list) { return view<std::int32_t>(list.bodies, 2U); });
    show(names.value, [](const auto& list) { return view<double>(values(list)); });
    show(names.flag, [](const auto& list) { return view<bool>(flags(list)); });
    show(names.offsets, [](const auto& list) { return view<std::int64_t>(list.offsets); });
    show(names.second_offsets, [](const auto& list) { return view<std::int64_t>(list.second_offsets); });
    show(names.by_second, [](const auto& list) { return view<std::int64_t>(list.by_second); });
}

template <class A>
void bind_list(nb::class_<A>& type, FeatureKind kind, const ListNames& names) {
    bind_list(
        type, [kind](const auto& found) -> const auto& { return found[kind]; }, names);
}

// What both answers have.
template <class A>
void bind_answer_about_features(nb::class_<A>& type) {
    type.def_prop_ro("any", [](const A& a) { return a.found().any; })
        .def_prop_ro("count", [](const A& a) { return a.found().count; })
        .def_prop_ro(
            "world_hit", [](const A& a) { return view<bool>(a.found().world_hit); }, owner)
        .def_prop_ro(
            "edges", [](const A& a) { return view<std::int32_t>(a.found().edges, 2U); }, owner)
        .def_prop_ro(
            "first_edge", [](const A& a) { return view<std::int64_t>(a.found().first_edge); }, owner)
        .def_prop_ro(
            "points", [](const A& a) { return view<std::int32_t>(a.found().points); }, owner)
        .def_prop_ro(
            "first_point", [](const A& a) { return view<std::int64_t>(a.found().first_point); }, owner)
        .def_prop_ro("statistics", [](const A& a) { return Statistics(a.found().statistics); })
        .def_ro("of_world", &A::of_world)
        .def_ro("has_index", &A::has_index)
        .def_ro("is_block", &A::is_block)
        .def_ro("of_part", &A::of_part)
        .def_ro("copy", &A::copy);
}

// The members of crumple.FirstImpact.
nb::object told(const FirstImpact& first, bool of_world) {
    if (!first.found) return nb::none();
    const std::string_view kind = feature_kind_name(first.kind);
    nb::object bodies = nb::none();
    if (of_world) bodies = nb::make_tuple(first.bodies.first, first.bodies.second);
    return nb::make_tuple(nb::str(kind.data(), kind.size()), nb::make_tuple(first.pair.a, first.pair.b), bodies,
                          first.toi, first.start);
}

}  // namespace

void bind_feature_answers(nb::module_& module) {
    using I = ImpactsAnswer;
    nb::class_<I> impacts(module, "ImpactsAnswer",
                          "The library's answer about motion; crumple.Impacts gives access to it.");
    bind_answer_about_features(impacts);
    bind_list(impacts, FeatureKind::vertex_face,
              {"vertex_faces", "vertex_face_bodies", "vertex_face_toi", "vertex_face_start", "vertex_offsets",
               "face_offsets", "by_face"});
    bind_list(impacts, FeatureKind::edge_edge,
              {"edge_edges", "edge_edge_bodies", "edge_edge_toi", "edge_edge_start", "edge_offsets",
               "second_edge_offsets", "by_second_edge"});
    bind_list(impacts, FeatureKind::vertex_edge,
              {"vertex_edges", "vertex_edge_bodies", "vertex_edge_toi", "vertex_edge_start", "vertex_edge_offsets",
               "edge_vertex_offsets", "by_edge"});
    bind_list(impacts, FeatureKind::vertex_vertex,
              {"vertex_vertices", "vertex_vertex_bodies", "vertex_vertex_toi", "vertex_vertex_start",
               "vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"});
    bind_list(impacts, [](const Impacts& found) -> const ImpactList& { return found.triangle_pairs; },
              {"triangle_pairs", "triangle_pair_bodies", "triangle_pair_toi", "triangle_pair_start", "triangle_offsets",
               "second_triangle_offsets", "by_second_triangle"});
    impacts.def_ro("has_triangle_pairs", &I::has_triangle_pairs);
    impacts.def_prop_ro("first", [](const I& a) { return told(a.found().first, a.of_world); })
        .def_prop_ro("world_first",
                     [](const I& a) {
                         nb::list result;
                         for (const FirstImpact& first : a.found().world_first) result.append(told(first, a.of_world));
                         return result;
                     })
        .def_prop_ro("wants", [](const I& a) { return name_of(motion_wants_names, a.output); });

    using N = NearbyAnswer;
    nb::class_<N> nearby(module, "NearbyAnswer",
                         "The library's answer about nearness; crumple.Nearby gives access to it.");
    bind_answer_about_features(nearby);
    bind_list(nearby, FeatureKind::vertex_face,
              {"vertex_faces", "vertex_face_bodies", "vertex_face_squared_distance", "vertex_face_touching",
               "vertex_offsets", "face_offsets", "by_face"});
    bind_list(nearby, FeatureKind::edge_edge,
              {"edge_edges", "edge_edge_bodies", "edge_edge_squared_distance", "edge_edge_touching", "edge_offsets",
               "second_edge_offsets", "by_second_edge"});
    bind_list(nearby, FeatureKind::vertex_edge,
              {"vertex_edges", "vertex_edge_bodies", "vertex_edge_squared_distance", "vertex_edge_touching",
               "vertex_edge_offsets", "edge_vertex_offsets", "by_edge"});
    bind_list(nearby, FeatureKind::vertex_vertex,
              {"vertex_vertices", "vertex_vertex_bodies", "vertex_vertex_squared_distance", "vertex_vertex_touching",
               "vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"});
    const auto show = [&](const char* name, auto as_numpy) {
        nearby.def_prop_ro(
            name, [as_numpy](const N& a) { return as_numpy(a.found()); }, owner);
    };
    show("vertex_face_type", [](const Proximities& n) { return view<std::uint8_t>(n.vertex_faces().type); });
    show("vertex_face_at", [](const Proximities& n) { return view<double>(n.vertex_faces().at, 2U); });
    show("edge_edge_type", [](const Proximities& n) { return view<std::uint8_t>(n.edge_edges().type); });
    show("edge_edge_at", [](const Proximities& n) { return view<double>(n.edge_edges().at, 2U); });
    show("vertex_edge_type", [](const Proximities& n) { return view<std::uint8_t>(n.vertex_edges().type); });
    show("vertex_edge_at", [](const Proximities& n) { return view<double>(n.vertex_edges().at, 2U); });
    show("vertex_vertex_type", [](const Proximities& n) { return view<std::uint8_t>(n.vertex_vertices().type); });
    show("vertex_vertex_at", [](const Proximities& n) { return view<double>(n.vertex_vertices().at, 2U); });
    show("vertex_distance", [](const Proximities& n) { return view<double>(n.vertex_distance); });
    show("face_distance", [](const Proximities& n) { return view<double>(n.face_distance); });
    show("edge_distance", [](const Proximities& n) { return view<double>(n.edge_distance); });
    nearby.def_ro("has_closest", &N::has_closest)
        .def_ro("has_least", &N::has_least)
        .def_prop_ro("wants", [](const N& a) { return name_of(near_wants_names, a.output); });
}

}  // namespace crumple::python
