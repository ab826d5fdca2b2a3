#include "part.h"

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "arrays.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// The Part in an object that __new__ may have left without one.
const Part& part_of(nb::handle object, std::string_view argument) {
    if (!nb::isinstance<Part>(object)) refuse_type(argument, "a crumple.Part", object);
    if (!nb::inst_ready(object)) refuse(std::string(argument) + " is a crumple.Part that nothing was put into");
    return *nb::inst_ptr<Part>(object);
}

template <class T>
nb::ndarray<nb::numpy, const T> column(nb::handle owner, const std::vector<T>& values) {
    import_numpy();
    return {values.data(), {values.size()}, owner};
}

using PartState =
    std::tuple<std::int32_t, std::vector<std::array<double, 3>>, std::vector<std::int32_t>, std::vector<std::int32_t>>;

}  // namespace

const Part* part_or_null(nb::handle part) {
    if (!part || part.is_none()) return nullptr;
    return &part_of(part, "part");
}

void bind_part(nb::module_& module) {
    nb::class_<Part>(module, "Part",
                     "One of several independent, overlapping parts of a scene; see Detector.partition. A plain value\n"
                     "that can be pickled: send it anywhere and answer it there for the same meshes.")
        .def_ro("index", &Part::index, "Which of `centres` this part is.")
        .def_prop_ro(
            "centres",
            [](nb::handle self) {
                const auto& centres = part_of(self, "this").centres;
                import_numpy();
                return nb::ndarray<nb::numpy, const double>(centres.empty() ? nullptr : centres[0].data(),
                                                            {centres.size(), 3}, self);
            },
            "(parts, 3) float64: cluster centres of all parts, in the scene's coordinates.")
        .def_prop_ro(
            "triangles", [](nb::handle self) { return column(self, part_of(self, "this").triangles); },
            "int32: triangles of the first mesh that belong to the part, ascending.")
        .def_prop_ro(
            "triangles_second", [](nb::handle self) { return column(self, part_of(self, "this").triangles_second); },
            "int32: triangles of the second mesh; empty for one soup.")
        .def("__repr__",
             [](const Part& p) {
                 return nb::str("<crumple.Part {} of {}: {} triangles>")
                     .format(p.index, p.centres.size(), p.triangles.size() + p.triangles_second.size());
             })
        .def("__getstate__",
             [](const Part& p) {
                 return PartState{p.index, p.centres, p.triangles, p.triangles_second};
             })
        .def(
            "__setstate__",
            [](Part& p, nb::handle given) {
                PartState state;
                if (!nb::try_cast(given, state))
                    throw InvalidType(
                        "the state of a Part must be a tuple (index, centres, triangles, triangles_second)");
                auto& [index, centres, triangles, triangles_second] = state;
                new (&p) Part{index, std::move(centres), std::move(triangles), std::move(triangles_second)};
            },
            "state"_a.none());
}

}  // namespace crumple::python
