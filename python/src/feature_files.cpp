#include "feature_files.h"

#include <array>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/io_features.h"
#include "files.h"
#include "gil.h"
#include "names.h"
#include "results.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

constexpr std::array<FeatureKind, feature_kinds> all_kinds{FeatureKind::vertex_face, FeatureKind::edge_edge,
                                                           FeatureKind::vertex_edge, FeatureKind::vertex_vertex};

// Copies an array from `found`, a Stored of crumple/_pickles.py, which has validated the array.
template <class Number, class Element>
void take(nb::handle found, const std::string& name, Array<Element>& array) {
    nb::ndarray<const Number, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(found.attr(name.c_str()), given) || given.size() * sizeof(Number) % sizeof(Element) != 0)
        throw std::logic_error("crumple/_pickles.py keeps another kind of " + name);
    array.resize_discard(given.size() * sizeof(Number) / sizeof(Element));
    if (!array.empty()) std::memcpy(static_cast<void*>(array.data()), given.data(), given.size() * sizeof(Number));
}

template <class List>
void read_feature_list(nb::handle found, FeatureKind kind, Array<double>& values, const char* value,
                       Array<std::uint8_t>& flags, const char* flag, List& list) {
    const std::string name(feature_kind_name(kind));
    take<std::int32_t>(found, plural_of_kind(name), list.pairs);
    take<std::int32_t>(found, name + "_bodies", list.bodies);
    take<double>(found, name + "_" + value, values);
    take<bool>(found, name + "_" + flag, flags);
}

// Copies the members that all results about features have.
template <class Storage>
void read_rest(nb::handle found, Storage& storage) {
    storage.count = nb::cast<std::int64_t>(found.attr("count"));
    storage.any = nb::cast<bool>(found.attr("any"));
    take<std::int32_t>(found, "edges", storage.edges);
    take<std::int64_t>(found, "first_edge", storage.first_edge);
    take<std::int32_t>(found, "points", storage.points);
    take<std::int64_t>(found, "first_point", storage.first_point);
    storage.statistics = nb::cast<Statistics>(found.attr("statistics"));
}

FirstImpact read_first(nb::handle given) {
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

// True if the member `options` of the request of a result ("options" or "kinds") contains `item`.
bool is_requested(nb::handle result, const char* options, std::string_view item) {
    const nb::object requested = result.attr("_request").attr(options);
    return nb::cast<bool>(requested.attr("__contains__")(nb::str(item.data(), item.size())));
}

// Returns the storage of a crumple.Impacts, crumple.Proximities or crumple.Candidates: the library's own result or, for
// an unpickled object, a new one that read_feature_lists(found, result) fills.
template <class Result, class Take>
std::shared_ptr<const Result> storage_of(nb::handle result, Take read_feature_lists) {
    const nb::object found = result.attr("_found");
    if (nb::isinstance<Shown<Result>>(found)) return nb::cast<const Shown<Result>&>(found).storage;
    const auto made = std::make_shared<Result>();
    read_rest(found, *made);
    read_feature_lists(found, *made);
    return made;
}

std::shared_ptr<const Candidates> candidates_of(nb::handle result) {
    return storage_of<Candidates>(result, [&](nb::handle found, Candidates& made) {
        for (const auto& [name, kind] : candidate_kind_names) {
            CandidateList& list = made[kind];
            take<std::int32_t>(found, plural_of_kind(name), list.pairs);
            take<std::int32_t>(found, std::string(name) + "_bodies", list.bodies);
            made.listed[static_cast<std::size_t>(kind)] = is_requested(result, "kinds", name);
        }
    });
}

}  // namespace

std::shared_ptr<const Impacts> impacts_of(nb::handle result) {
    return storage_of<Impacts>(result, [&](nb::handle found, Impacts& made) {
        for (const FeatureKind kind : all_kinds) {
            ImpactList& list = made[kind];
            read_feature_list(found, kind, list.toi, "toi", list.start, "start", list);
        }
        take<std::int32_t>(found, "triangle_pairs", made.triangle_pairs.pairs);
        take<std::int32_t>(found, "triangle_pair_bodies", made.triangle_pairs.bodies);
        take<double>(found, "triangle_pair_toi", made.triangle_pairs.toi);
        take<bool>(found, "triangle_pair_start", made.triangle_pairs.start);
        made.lists_triangle_pairs = is_requested(result, "options", "triangle_pairs");
        made.first = read_first(found.attr("first"));
    });
}

std::shared_ptr<const Proximities> proximities_of(nb::handle result) {
    return storage_of<Proximities>(result, [](nb::handle found, Proximities& made) {
        for (const FeatureKind kind : all_kinds) {
            ProximityList& list = made[kind];
            read_feature_list(found, kind, list.squared_distance, "squared_distance", list.touching, "touching", list);
        }
    });
}

// Binds writers of results. With a mesh they write the mesh, coloured by the result; without one, the rows of the
// result.
void bind_feature_files(nb::module_& module) {
    module.def(
        "write_impacts",
        [](nb::handle path, nb::handle result, const std::optional<nb::tuple>& mesh) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Impacts> impacts = impacts_of(result);
            std::optional<BorrowedMesh> start;
            if (mesh) start.emplace(*mesh);
            const WithoutGil released(at_exit(to));
            if (start)
                io::write_coloured(to, copy_of(start->view()), *impacts);
            else
                io::write_impacts(to, *impacts);
        },
        "path"_a.none(), "result"_a, "mesh"_a.none());
    module.def(
        "write_proximities",
        [](nb::handle path, nb::handle result, const std::optional<nb::tuple>& mesh) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Proximities> found = proximities_of(result);
            std::optional<BorrowedMesh> borrowed;
            if (mesh) borrowed.emplace(*mesh);
            const WithoutGil released(at_exit(to));
            if (borrowed)
                io::write_coloured(to, copy_of(borrowed->view()), nullptr, *found);
            else
                io::write_near(to, *found);
        },
        "path"_a.none(), "result"_a, "mesh"_a.none());
    module.def(
        "write_candidates",
        [](nb::handle path, nb::handle result) {
            const std::filesystem::path to = python::path("path", path);
            const std::shared_ptr<const Candidates> candidates = candidates_of(result);
            const WithoutGil released(at_exit(to));
            io::write_candidates(to, *candidates);
        },
        "path"_a.none(), "result"_a);
}

}  // namespace crumple::python
