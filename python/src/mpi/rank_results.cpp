#include "mpi/rank_results.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>

#include <nanobind/stl/string_view.h>

#include "held_binding.h"
#include "names.h"
#include "overlap_binding.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

void bind_statistics(nb::module_& module) {
    using S = DistributedStatistics;
    nb::class_<S>(module, "Statistics", "Counts and times of a call on this rank. Times are in milliseconds.")
        .def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
        .def_prop_ro(
            "phase_milliseconds", [](const S& s) { return milliseconds_by_name<Phase>(s, phase_count, phase_name); },
            "Milliseconds by phase, with the communication at the end of each: query, input, ids, place,\n"
            "members, room, search, rows, output.")
        .def_ro("parts", &S::parts, "Number of parts that this rank has searched; for overlaps, of pairs of bodies.")
        .def_ro("members", &S::members, "Triangles of these parts, counted once per part.")
        .def_ro("bytes_sent", &S::bytes_sent, "Bytes sent to other ranks.")
        .def_ro("messages", &S::messages, "Number of messages to other ranks.")
        .def_ro("work_milliseconds", &S::work_milliseconds, "Milliseconds of this rank's searches.")
        .def_ro("largest_work", &S::largest_work, "Maximum of work_milliseconds over all ranks.")
        .def_ro("mean_work", &S::mean_work, "Mean of work_milliseconds over all ranks.")
        .def_ro("moved", &S::moved,
                "True if only vertices have moved since the previous call, so that only coordinates were sent.")
        .def_prop_ro(
            "search", [](const S& s) { return Statistics(s.search); },
            "crumple.Statistics, summed over this rank's parts.")
        .def("__repr__", [](const S& s) {
            return nb::str(
                       "Statistics(milliseconds={:.3f}, parts={}, members={}, bytes_sent={}, messages={}, "
                       "work_milliseconds={:.3f}, largest_work={:.3f}, mean_work={:.3f}, moved={!r})")
                .format(s.milliseconds, s.parts, s.members, s.bytes_sent, s.messages, s.work_milliseconds,
                        s.largest_work, s.mean_work, s.moved);
        });
}

template <class Result>
struct Binding : SharedBinding<RankShown<Result>> {
    Binding(nb::module_& module, const char* name, const char* description)
        : SharedBinding<RankShown<Result>>(module, name, description) {
        this->value("any", [](const Result& r) { return r.any; });
        this->value("count", [](const Result& r) { return r.count; });
        this->value("statistics", [](const Result& r) { return DistributedStatistics(r.statistics); });
    }
};

void bind_intersections(nb::module_& module) {
    using R = DistributedIntersections;
    Binding<R> result(module, "Intersections", "Storage of a crumple.mpi.Intersections.");
    result.array<std::int32_t>(
        "pairs", [](const R& r) -> auto& { return r.pairs; }, 2U);
    result.array<std::int32_t>(
        "bodies", [](const R& r) -> auto& { return r.bodies; }, 2U);
    result.array<std::uint8_t>(
        "contact_kinds", [](const R& r) -> auto& { return r.contacts.kinds; });
    result.array<std::int64_t>(
        "contact_offsets", [](const R& r) -> auto& { return r.contacts.offsets; });
    result.array<double>(
        "contact_points", [](const R& r) -> auto& { return r.contacts.points; }, 3U);
}

// Binds the members that DistributedImpacts and DistributedProximities have in common. Ranks have only two kinds of
// lists, because their meshes have no codimensional edges and points.
template <class Result>
void bind_features(Binding<Result>& result, const char* value, const char* flag) {
    for (const auto& [kind, name, pairs] : {std::tuple(FeatureKind::vertex_face, "vertex_face_", "vertex_faces"),
                                            std::tuple(FeatureKind::edge_edge, "edge_edge_", "edge_edges")}) {
        const FeatureKind of = kind;
        const std::string prefix = name;
        result.template array<std::int32_t>(
            pairs, [of](const Result& r) -> auto& { return r[of].pairs; }, 2U);
        result.template array<std::int32_t>(
            prefix + "bodies", [of](const Result& r) -> auto& { return r[of].bodies; }, 2U);
        result.template array<double>(
            prefix + value, [of](const Result& r) -> auto& { return values(r[of]); });
        result.template array<bool>(
            prefix + flag, [of](const Result& r) -> auto& { return flags(r[of]); });
        if constexpr (std::is_same_v<Result, DistributedProximities>) {
            result.template array<std::uint8_t>(
                prefix + "type", [of](const Result& r) -> auto& { return r[of].type; });
            result.template array<double>(
                prefix + "at", [of](const Result& r) -> auto& { return r[of].at; }, 2U);
        }
    }
    result.template array<std::int32_t>(
        "edges", [](const Result& r) -> auto& { return r.edges; }, 2U);
    result.template array<std::int32_t>(
        "edge_ids", [](const Result& r) -> auto& { return r.edge_ids; });
    result.template array<std::int32_t>(
        "edge_bodies", [](const Result& r) -> auto& { return r.edge_bodies; });
}

}  // namespace

void bind_rank_results(nb::module_& module) {
    bind_statistics(module);
    bind_intersections(module);
    Binding<DistributedImpacts> impacts(module, "Impacts", "Storage of a crumple.mpi.Impacts.");
    bind_features(impacts, "toi", "start");
    impacts.value("first", [](const DistributedImpacts& r) { return tuple_of(r.first); });
    Binding<DistributedProximities> proximities(module, "Proximities", "Storage of a crumple.mpi.Proximities.");
    bind_features(proximities, "squared_distance", "touching");
    Binding<DistributedOverlaps> overlaps(module, "Overlaps", "Storage of a crumple.mpi.Overlaps.");
    bind_overlap_arrays(overlaps, [](const DistributedOverlaps& r) -> const Overlaps& { return r.rows; });
}

}  // namespace crumple::python
