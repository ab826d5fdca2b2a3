#include "results.h"

#include <cstdint>
#include <string>

#include <nanobind/stl/string_view.h>

#include "held_binding.h"
#include "names.h"
#include "overlap_binding.h"
#include "pickling.h"
#include "views.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

void bind_statistics(nb::module_& module) {
    using S = Statistics;
    nb::class_<S> type(module, "Statistics",
                       "Counts and times of a call. Times are in milliseconds.\n\n"
                       "A plain value: it can be compared, copied and pickled.");
    type.attr("__hash__") = nb::none();
    type.def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
        .def_prop_ro(
            "stage_milliseconds", [](const S& s) { return milliseconds_by_name<Stage>(s, stage_count, stage_name); },
            "Milliseconds by stage, summed over threads: bounds, subdivide, align, sort, sweep, narrow, output.")
        .def_ro("triangles", &S::triangles, "Number of triangles of all meshes.")
        .def_ro("clusters", &S::clusters, "Clusters of the first level of subdivision.")
        .def_ro("leaves", &S::leaves, "Leaf clusters that were swept.")
        .def_ro("members", &S::members, "Triangles of all leaves, counted once per leaf.")
        .def_ro("interval_tests", &S::interval_tests, "Overlaps along the sweep direction.")
        .def_ro("box_overlaps", &S::box_overlaps, "Candidate pairs found by the sweep.")
        .def_ro("edge_tests", &S::edge_tests, "Pairs that no plane separated.")
        .def_ro("double_tests", &S::double_tests, "Pairs left undecided by float32 filters.")
        .def_ro("exact_tests", &S::exact_tests, "Pairs left undecided by float64 filters: decided in exact arithmetic.")
        .def_ro("rational_tests", &S::rational_tests,
                "Of exact_tests, pairs beyond the range of floating-point expansions.")
        .def_ro("rational_contacts", &S::rational_contacts, "Contacts computed in rational arithmetic.")
        .def_ro("pairs", &S::pairs, "Colliding pairs.")
        .def_ro("peak_memory_bytes", &S::peak_memory_bytes,
                "Most bytes that the detector has owned, including this result.")
        .def_ro("complete", &S::complete,
                "False if pairs may be missing: see `membership` of Method. Always True with its default.")
        .def_ro("threads", &S::threads, "Number of threads of the detector.")
        .def_ro("backend", &S::backend, "\"cpu\", \"cuda\" or \"reference\".")
        .def_ro("simd", &S::simd, "Instruction set that was used; empty for the reference backend.")
        .def("__repr__",
             [](const S& s) {
                 return nb::str(
                            "Statistics(milliseconds={:.3f}, triangles={}, box_overlaps={}, exact_tests={}, pairs={}, "
                            "threads={}, backend={!r}, simd={!r})")
                     .format(s.milliseconds, s.triangles, s.box_overlaps, s.exact_tests, s.pairs, s.threads, s.backend,
                             s.simd);
             })
        .def(
            "__eq__",
            [](const S& s, nb::handle other) -> nb::object {
                if (!nb::isinstance<S>(other) || !nb::inst_ready(other)) return nb::borrow(Py_NotImplemented);
                return nb::bool_(state_of(s).equal(state_of(*nb::inst_ptr<S>(other))));
            },
            "other"_a.none())
        .def("__getstate__", [](const S& s) { return state_of(s); })
        .def(
            "__setstate__", [](S& s, nb::handle state) { new (&s) S(statistics_of(state)); }, "state"_a.none());
}

template <class Result>
struct Binding : SharedBinding<Shown<Result>> {
    Binding(nb::module_& module, const char* name, const char* description)
        : SharedBinding<Shown<Result>>(module, name, description) {
        this->value("statistics", [](const Result& r) { return Statistics(r.statistics); });
    }
};

void bind_intersections(nb::module_& module) {
    using R = Intersections;
    Binding<R> result(module, "Intersections", "Storage of a crumple.Intersections.");
    result.value("any", [](const R& r) { return r.any; });
    result.value("count", [](const R& r) { return r.count; });
    result.array<std::int32_t>(
        "pairs", [](const R& r) -> auto& { return r.pairs; }, 2U);
    result.array<std::int32_t>(
        "bodies", [](const R& r) -> auto& { return r.bodies; }, 2U);
    result.array<bool>(
        "inside", [](const R& r) -> auto& { return r.inside; });
    result.array<std::int32_t>(
        "skipped", [](const R& r) -> auto& { return r.skipped; });
    result.array<std::int64_t>(
        "offsets", [](const R& r) -> auto& { return r.offsets; });
    result.array<bool>(
        "hit", [](const R& r) -> auto& { return r.hit; });
    result.array<bool>(
        "hit_second", [](const R& r) -> auto& { return r.hit_second; });
    result.array<bool>(
        "world_hit", [](const R& r) -> auto& { return r.world_hit; });
    result.array<std::int64_t>(
        "world_counts", [](const R& r) -> auto& { return r.world_counts; });
    result.array<std::int64_t>(
        "world_offsets", [](const R& r) -> auto& { return r.world_offsets; });
    result.array<std::int64_t>(
        "body_offsets", [](const R& r) -> auto& { return r.body_offsets; });
    result.array<std::int64_t>(
        "first_triangle", [](const R& r) -> auto& { return r.first_triangle; });
    result.array<std::uint8_t>(
        "contact_kinds", [](const R& r) -> auto& { return r.contacts.kinds; });
    result.array<std::int64_t>(
        "contact_offsets", [](const R& r) -> auto& { return r.contacts.offsets; });
    result.array<double>(
        "contact_points", [](const R& r) -> auto& { return r.contacts.points; }, 3U);
    result.type().def("deep_copy", [](const Shown<R>& r) { return Shown<R>{std::make_shared<R>(r.found())}; });
}

// Python names of the arrays of a list.
struct ListNames {
    std::string pairs, prefix;  ///< for example "vertex_faces" and "vertex_face_"
    const char *offsets, *second_offsets, *by_second;
};

const ListNames feature_lists[feature_kinds] = {
    {"vertex_faces", "vertex_face_", "vertex_offsets", "face_offsets", "by_face"},
    {"edge_edges", "edge_edge_", "edge_offsets", "second_edge_offsets", "by_second_edge"},
    {"vertex_edges", "vertex_edge_", "vertex_edge_offsets", "edge_vertex_offsets", "by_edge"},
    {"vertex_vertices", "vertex_vertex_", "vertex_vertex_offsets", "second_vertex_offsets", "by_second_vertex"},
};

// Binds the arrays of the list that list_of(result) returns. `value` and `flag`: last parts of the names of the arrays
// of values and of flags, such as "toi" and "start".
template <class Result, class ListOf>
void bind_list(Binding<Result>& result, ListOf list_of, const ListNames& names, const char* value, const char* flag) {
    result.template array<std::int32_t>(
        names.pairs, [=](const Result& r) -> auto& { return list_of(r).pairs; }, 2U);
    result.template array<std::int32_t>(
        names.prefix + "bodies", [=](const Result& r) -> auto& { return list_of(r).bodies; }, 2U);
    result.template array<double>(
        names.prefix + value, [=](const Result& r) -> auto& { return values(list_of(r)); });
    result.template array<bool>(
        names.prefix + flag, [=](const Result& r) -> auto& { return flags(list_of(r)); });
    result.template array<std::int64_t>(
        names.offsets, [=](const Result& r) -> auto& { return list_of(r).offsets; });
    result.template array<std::int64_t>(
        names.second_offsets, [=](const Result& r) -> auto& { return list_of(r).second_offsets; });
    result.template array<std::int64_t>(
        names.by_second, [=](const Result& r) -> auto& { return list_of(r).by_second; });
}

// Binds the members of all results about features.
template <class Result>
void bind_features(Binding<Result>& result) {
    result.value("any", [](const Result& r) { return r.any; });
    result.value("count", [](const Result& r) { return r.count; });
    result.template array<std::int32_t>(
        "edges", [](const Result& r) -> auto& { return r.edges; }, 2U);
    result.template array<std::int64_t>(
        "first_edge", [](const Result& r) -> auto& { return r.first_edge; });
    result.template array<std::int32_t>(
        "points", [](const Result& r) -> auto& { return r.points; });
    result.template array<std::int64_t>(
        "first_point", [](const Result& r) -> auto& { return r.first_point; });
}

template <class Result>
void bind_feature_lists(Binding<Result>& result, const char* value, const char* flag) {
    bind_features(result);
    result.template array<bool>(
        "world_hit", [](const Result& r) -> auto& { return r.world_hit; });
    for (int kind = 0; kind < feature_kinds; ++kind)
        bind_list(
            result, [kind](const Result& r) -> auto& { return r[static_cast<FeatureKind>(kind)]; }, feature_lists[kind],
            value, flag);
}

void bind_impacts(nb::module_& module) {
    using R = Impacts;
    Binding<R> result(module, "Impacts", "Storage of a crumple.Impacts.");
    bind_feature_lists(result, "toi", "start");
    bind_list(
        result, [](const R& r) -> auto& { return r.triangle_pairs; },
        {"triangle_pairs", "triangle_pair_", "triangle_offsets", "second_triangle_offsets", "by_second_triangle"},
        "toi", "start");
    result.value("first", [](const R& r) { return tuple_of(r.first); });
    result.value("world_first", [](const R& r) {
        nb::list firsts;
        for (const FirstImpact& first : r.world_first) firsts.append(tuple_of(first));
        return firsts;
    });
}

void bind_proximities(nb::module_& module) {
    using R = Proximities;
    Binding<R> result(module, "Proximities", "Storage of a crumple.Proximities.");
    bind_feature_lists(result, "squared_distance", "touching");
    for (int k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        const std::string& prefix = feature_lists[k].prefix;
        result.array<std::uint8_t>(
            prefix + "type", [kind](const R& r) -> auto& { return r[kind].type; });
        result.array<double>(
            prefix + "at", [kind](const R& r) -> auto& { return r[kind].at; }, 2U);
    }
    result.array<double>(
        "vertex_distance", [](const R& r) -> auto& { return r.vertex_distance; });
    result.array<double>(
        "face_distance", [](const R& r) -> auto& { return r.face_distance; });
    result.array<double>(
        "edge_distance", [](const R& r) -> auto& { return r.edge_distance; });
}

void bind_candidates(nb::module_& module) {
    using R = Candidates;
    Binding<R> result(module, "Candidates", "Storage of a crumple.Candidates.");
    bind_features(result);
    for (const auto& [name, kind] : candidate_kind_names) {
        const CandidateKind of = kind;
        result.array<std::int32_t>(
            plural_of_kind(name), [of](const R& r) -> auto& { return r[of].pairs; }, 2U);
        result.array<std::int32_t>(
            std::string(name) + "_bodies", [of](const R& r) -> auto& { return r[of].bodies; }, 2U);
    }
}

void bind_distances(nb::module_& module) {
    using R = Distances;
    Binding<R> result(module, "Distances", "Storage of a crumple.Distances.");
    result.array<std::int32_t>(
        "bodies", [](const R& r) -> auto& { return r.bodies; }, 2U);
    result.array<double>(
        "squared_distance", [](const R& r) -> auto& { return r.squared_distance; });
    result.array<bool>(
        "touching", [](const R& r) -> auto& { return r.touching; });
    result.array<std::int32_t>(
        "triangles", [](const R& r) -> auto& { return r.triangles; }, 2U);
    result.array<double>(
        "points", [](const R& r) -> auto& { return r.points; }, 2U, 3U);
    result.array<std::int64_t>(
        "world_rows", [](const R& r) -> auto& { return r.world_rows; });
}

void bind_overlaps(nb::module_& module) {
    using R = Overlaps;
    Binding<R> result(module, "Overlaps", "Storage of a crumple.Overlaps.");
    result.value("any", [](const R& r) { return r.any; });
    result.value("count", [](const R& r) { return r.count; });
    result.value("part", [](const R& r) { return nb::make_tuple(r.part.index, r.part.count, r.part.self_overlaps); });
    bind_overlap_arrays(result, [](const R& r) -> const Overlaps& { return r; });
}

}  // namespace

void bind_results(nb::module_& module) {
    bind_statistics(module);
    bind_intersections(module);
    bind_impacts(module);
    bind_proximities(module);
    bind_candidates(module);
    bind_distances(module);
    bind_overlaps(module);
}

}  // namespace crumple::python
