#include "part.h"

#include <cstdint>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "arrays.h"
#include "part_features.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// Returns the Part of a Python object. Throws Error if the object was created by __new__ alone and has no Part.
const Part& part_of(nb::handle object, std::string_view argument) {
    if (!nb::isinstance<Part>(object)) refuse_type(argument, "a crumple.Part", object);
    if (!nb::inst_ready(object))
        refuse(std::string(argument) + " is an empty crumple.Part; get parts from Detector.partition");
    return *nb::inst_ptr<Part>(object);
}

template <class T>
nb::ndarray<nb::numpy, const T> column(nb::handle owner, const std::vector<T>& values) {
    import_numpy();
    return {values.data(), {values.size()}, owner};
}

// Returns the arguments of crumple.Mesh, (vertices, faces, groups or None). `owner` keeps the arrays alive.
nb::tuple arrays_of(nb::handle owner, const PartMesh& mesh) {
    import_numpy();
    const nb::object vertices = std::visit(
        [&](const auto& xyz) {
            using Scalar = typename std::decay_t<decltype(xyz)>::value_type;
            return nb::cast(nb::ndarray<nb::numpy, const Scalar>(xyz.data(), {xyz.size() / 3, 3}, owner));
        },
        mesh.vertices);
    const nb::object faces =
        nb::cast(nb::ndarray<nb::numpy, const std::int32_t>(mesh.corners.data(), {mesh.corners.size() / 3, 3}, owner));
    return nb::make_tuple(vertices, faces,
                          mesh.groups.empty() ? nb::none() : nb::object(nb::cast(column(owner, mesh.groups))));
}

constexpr const char* wrong_state =
    "the state of a Part must be a tuple (index, count, mesh, second, levels, features) as __getstate__ returns it";

template <class T>
std::vector<T> values_of(nb::handle given) {
    nb::ndarray<const T, nb::c_contig, nb::device::cpu> array;
    if (!nb::try_cast(given, array, false)) throw InvalidType(wrong_state);
    return {array.data(), array.data() + array.size()};
}

nb::tuple state_of(nb::handle owner, const PartMesh& mesh) {
    const nb::tuple arrays = arrays_of(owner, mesh);
    return nb::make_tuple(arrays[0], arrays[1], arrays[2], column(owner, mesh.ids));
}

PartMesh mesh_from_state(nb::handle given) {
    nb::tuple state;
    nb::ndarray<const float, nb::c_contig, nb::device::cpu> single;
    if (!nb::try_cast(given, state, false) || state.size() != 4) throw InvalidType(wrong_state);
    PartMesh mesh;
    if (nb::try_cast(state[0], single, false))
        mesh.vertices = values_of<float>(state[0]);
    else
        mesh.vertices = values_of<double>(state[0]);
    mesh.corners = values_of<std::int32_t>(state[1]);
    if (!state[2].is_none()) mesh.groups = values_of<std::int32_t>(state[2]);
    mesh.ids = values_of<std::int32_t>(state[3]);
    return mesh;
}

// Returns the ids that a member of PartFeatures lists; None if the part was not made for a query about features.
nb::object ids_of(nb::handle self, std::vector<std::int32_t> PartFeatures::*ids) {
    const auto& features = part_of(self, "this").features;
    return features ? nb::cast(column(self, (*features).*ids)) : nb::none();
}

// Converts a state that __getstate__ returned to a Part. Checks types only; Detector.find refuses inconsistent parts.
Part part_from(nb::handle given) {
    nb::tuple state;
    nb::list levels;
    Part part;
    if (!nb::try_cast(given, state, false) || state.size() != 6 || !nb::try_cast(state[0], part.index, false) ||
        !nb::try_cast(state[1], part.count, false) || !nb::try_cast(state[4], levels, false))
        throw InvalidType(wrong_state);
    part.mesh = mesh_from_state(state[2]);
    if (!state[3].is_none()) part.second = mesh_from_state(state[3]);
    if (!state[5].is_none()) part.features = features_from(state[5]);
    for (const nb::handle item : levels) {
        nb::tuple level;
        PartLevel& added = part.levels.emplace_back();
        if (!nb::try_cast(item, level, false) || level.size() != 2 || !nb::try_cast(level[0], added.cluster, false))
            throw InvalidType(wrong_state);
        added.masks = values_of<std::uint64_t>(level[1]);
    }
    return part;
}

}  // namespace

const Part& given_part(nb::handle part) { return part_of(part, "part"); }

void bind_part(nb::module_& module) {
    nb::class_<Part>(
        module, "Part",
        "One of several independent, overlapping parts of a scene (Detector.partition).\n\n"
        "A plain value that owns its arrays and can be pickled: send it to another machine, and search it\n"
        "there by Detector.find, without the meshes.")
        .def_ro("index", &Part::index, "Index of this part, from 0.")
        .def_ro("count", &Part::count, "Number of parts.")
        .def_prop_ro(
            "mesh", [](nb::handle self) { return arrays_of(self, part_of(self, "this").mesh); },
            "(vertices, faces, groups or None): the part's triangles of the first mesh, as a mesh.")
        .def_prop_ro(
            "second",
            [](nb::handle self) {
                const auto& second = part_of(self, "this").second;
                return second ? nb::object(arrays_of(self, *second)) : nb::none();
            },
            "(vertices, faces, groups or None): those of the second mesh; None if there is one mesh.")
        .def_prop_ro(
            "triangles", [](nb::handle self) { return column(self, part_of(self, "this").mesh.ids); },
            "(m,) int32: ids in the first mesh of the triangles of `mesh`, ascending.")
        .def_prop_ro(
            "triangles_second",
            [](nb::handle self) {
                static const std::vector<std::int32_t> none;
                const auto& second = part_of(self, "this").second;
                return column(self, second ? second->ids : none);
            },
            "(m,) int32: ids in the second mesh of the triangles of `second`, ascending; empty if there is one mesh.")
        .def_prop_ro(
            "vertex_ids", [](nb::handle self) { return ids_of(self, &PartFeatures::vertices); },
            "(n,) int32: ids of the vertices of `mesh`, ascending. None unless the part is for impacts or proximities.")
        .def_prop_ro(
            "edge_ids", [](nb::handle self) { return ids_of(self, &PartFeatures::edges); },
            "(k,) int32: ids of the edges that the part's triangles own, ascending; None as for vertex_ids.")
        .def_prop_ro(
            "point_ids", [](nb::handle self) { return ids_of(self, &PartFeatures::points); },
            "(k,) int32: ids of the points (Mesh.points) that the part's triangles own, ascending; None as for\n"
            "vertex_ids.")
        .def_prop_ro(
            "has_radii",
            [](nb::handle self) {
                const auto& features = part_of(self, "this").features;
                return features && !features->radii.empty();
            },
            "True if the part was made with radii of the vertices.")
        .def("__repr__",
             [](const Part& p) {
                 return nb::str("<crumple.Part {} of {}: {} triangles>").format(p.index, p.count, p.triangle_count());
             })
        .def("__getstate__",
             [](nb::handle self) {
                 const Part& p = part_of(self, "this");
                 nb::list levels;
                 for (const PartLevel& level : p.levels)
                     levels.append(nb::make_tuple(level.cluster, column(self, level.masks)));
                 return nb::make_tuple(p.index, p.count, state_of(self, p.mesh),
                                       p.second ? nb::object(state_of(self, *p.second)) : nb::none(), levels,
                                       p.features ? nb::object(state_of(*p.features)) : nb::none());
             })
        .def(
            "__setstate__", [](Part& p, nb::handle given) { new (&p) Part(part_from(given)); }, "state"_a.none());
}

}  // namespace crumple::python
