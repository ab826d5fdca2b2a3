#include "feature_files.h"

#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "arguments.h"
#include "arrays.h"
#include "candidates.h"
#include "crumple/io_features.h"
#include "feature_answer.h"
#include "files.h"
#include "gil.h"
#include "names.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

constexpr std::array<FeatureKind, feature_kinds> all_kinds{FeatureKind::vertex_face, FeatureKind::edge_edge,
                                                           FeatureKind::vertex_edge, FeatureKind::vertex_vertex};

// An array of crumple/_feature_pickling.py's StoredAnswer, which has checked it.
template <class Number, class Element>
void take(nb::handle answer, const std::string& name, Array<Element>& array) {
    nb::ndarray<const Number, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(answer.attr(name.c_str()), given) || given.size() * sizeof(Number) % sizeof(Element) != 0)
        throw std::logic_error("crumple/_feature_pickling.py keeps another kind of " + name);
    array.resize_discard(given.size() * sizeof(Number) / sizeof(Element));
    if (!array.empty()) std::memcpy(static_cast<void*>(array.data()), given.data(), given.size() * sizeof(Number));
}

template <class List>
void take_list(nb::handle answer, FeatureKind kind, Array<double>& values, const char* value,
               Array<std::uint8_t>& flags, const char* flag, List& list) {
    const std::string name(feature_kind_name(kind));
    take<std::int32_t>(answer, plural_of_kind(name), list.pairs);
    take<std::int32_t>(answer, name + "_bodies", list.bodies);
    take<double>(answer, name + "_" + value, values);
    take<bool>(answer, name + "_" + flag, flags);
}

// What all answers have.
template <class Storage>
void take_rest(nb::handle answer, Storage& storage) {
    storage.count = nb::cast<std::int64_t>(answer.attr("count"));
    if constexpr (std::is_same_v<Storage, Candidates>)  // whose count is that of the rows
        storage.any = storage.count > 0;
    else
        storage.any = nb::cast<bool>(answer.attr("any"));
    take<std::int32_t>(answer, "edges", storage.edges);
    take<std::int64_t>(answer, "first_edge", storage.first_edge);
    take<std::int32_t>(answer, "points", storage.points);
    take<std::int64_t>(answer, "first_point", storage.first_point);
    storage.statistics = nb::cast<Statistics>(answer.attr("statistics"));
}

FirstImpact taken_first(nb::handle given) {
    FirstImpact first;
    if (given.is_none()) return first;
    const nb::object pair = given[1], bodies = given[2];
    first.found = true;
    for (const FeatureKind kind : all_kinds)
        if (nb::cast<std::string>(given[0]) == feature_kind_name(kind)) first.kind = kind;
    first.pair = {nb::cast<std::int32_t>(pair[0]), nb::cast<std::int32_t>(pair[1])};
    if (!bodies.is_none()) first.bodies = {nb::cast<std::int32_t>(bodies[0]), nb::cast<std::int32_t>(bodies[1])};
    first.toi = nb::cast<double>(given[3]);
    first.start = nb::cast<bool>(given[4]);
    return first;
}

// What a crumple.Impacts, crumple.Nearby or crumple.Candidates holds: the library's answer, or arrays that came through
// pickle.
std::shared_ptr<const Impacts> impacts_of(nb::handle answer) {
    if (nb::isinstance<ImpactsAnswer>(answer)) return nb::cast<const ImpactsAnswer&>(answer).storage;
    const auto made = std::make_shared<Impacts>();
    take_rest(answer, *made);
    for (const FeatureKind kind : all_kinds) {
        ImpactList& list = (*made)[kind];
        take_list(answer, kind, list.toi, "toi", list.start, "start", list);
    }
    take<std::int32_t>(answer, "triangle_pairs", made->triangle_pairs.pairs);
    take<std::int32_t>(answer, "triangle_pair_bodies", made->triangle_pairs.bodies);
    take<double>(answer, "triangle_pair_toi", made->triangle_pairs.toi);
    take<bool>(answer, "triangle_pair_start", made->triangle_pairs.start);
    made->lists_triangle_pairs = nb::cast<bool>(answer.attr("has_triangle_pairs"));
    made->first = taken_first(answer.attr("first"));
    return made;
}

std::shared_ptr<const Proximities> nearby_of(nb::handle answer) {
    if (nb::isinstance<NearbyAnswer>(answer)) return nb::cast<const NearbyAnswer&>(answer).storage;
    const auto made = std::make_shared<Proximities>();
    take_rest(answer, *made);
    for (const FeatureKind kind : all_kinds) {
        ProximityList& list = (*made)[kind];
        take_list(answer, kind, list.squared_distance, "squared_distance", list.touching, "touching", list);
    }
    return made;
}

std::shared_ptr<const Candidates> candidates_of(nb::handle answer) {
    if (nb::isinstance<CandidatesAnswer>(answer)) return nb::cast<const CandidatesAnswer&>(answer).storage;
    const auto made = std::make_shared<Candidates>();
    take_rest(answer, *made);
    for (const auto& [name, kind] : candidate_kind_names) {
        CandidateList& list = (*made)[kind];
        take<std::int32_t>(answer, plural_of_kind(name), list.pairs);
        take<std::int32_t>(answer, std::string(name) + "_bodies", list.bodies);
        made->listed[static_cast<std::size_t>(kind)] =
            nb::cast<bool>(answer.attr("kinds").attr("__contains__")(std::string(name)));
    }
    return made;
}

}  // namespace

// Of a mesh, if there is one, and of the list of rows otherwise.
void bind_feature_files(nb::module_& module) {
    module.def(
        "write_impacts",
        [](nb::handle path, nb::handle answer, const std::optional<nb::tuple>& mesh) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Impacts> impacts = impacts_of(answer);
            std::optional<BorrowedMesh> start;
            if (mesh) start.emplace(*mesh);
            const WithoutGil released(at_exit(to));
            if (start)
                io::write_coloured(to, copy_of(start->view()), *impacts);
            else
                io::write_impacts(to, *impacts);
        },
        "path"_a.none(), "answer"_a, "mesh"_a.none());
    module.def(
        "write_near",
        [](nb::handle path, nb::handle answer, const std::optional<nb::tuple>& mesh) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Proximities> nearby = nearby_of(answer);
            std::optional<BorrowedMesh> borrowed;
            if (mesh) borrowed.emplace(*mesh);
            const WithoutGil released(at_exit(to));
            if (borrowed)
                io::write_coloured(to, copy_of(borrowed->view()), nullptr, *nearby);
            else
                io::write_near(to, *nearby);
        },
        "path"_a.none(), "answer"_a, "mesh"_a.none());
    module.def(
        "write_candidates",
        [](nb::handle path, nb::handle answer) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Candidates> candidates = candidates_of(answer);
            const WithoutGil released(at_exit(to));
            io::write_candidates(to, *candidates);
        },
        "path"_a.none(), "answer"_a);
}

}  // namespace crumple::python
