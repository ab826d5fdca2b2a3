#include "result.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

// A read-only NumPy view that keeps its owner alive.
template <class Element, class... Shape>
auto view(nb::handle owner, const void* data, Shape... shape) {
    return nb::ndarray<nb::numpy, const Element>(static_cast<const Element*>(data),
                                                 {static_cast<std::size_t>(shape)...}, owner);
}

const Collisions& collisions_of(nb::handle self) { return nb::cast<const Result&>(self).collisions; }

nb::dict stage_milliseconds(const Statistics& statistics) {
    nb::dict result;
    for (int i = 0; i < stage_count; ++i) {
        const auto stage = static_cast<Stage>(i);
        const std::string_view name = stage_name(stage);
        result[nb::str(name.data(), name.size())] = statistics[stage];
    }
    return result;
}

void bind_statistics(nb::module_& module) {
    using S = Statistics;
    nb::class_<S>(module, "Statistics", "What a call did. Times are in milliseconds.")
        .def_ro("milliseconds", &S::milliseconds, "Wall-clock time of the call inside the library.")
        .def_prop_ro(
            "stage_milliseconds", stage_milliseconds,
            "Milliseconds by stage, summed over threads: bounds, subdivide, align, sort, sweep, narrow, output.")
        .def_ro("triangles", &S::triangles, "Triangles, of both meshes.")
        .def_ro("clusters", &S::clusters, "Clusters of the first level of subdivision.")
        .def_ro("leaves", &S::leaves, "Clusters that were swept.")
        .def_ro("members", &S::members, "Memberships of triangles in leaves.")
        .def_ro("interval_tests", &S::interval_tests, "Overlaps along the sweep direction.")
        .def_ro("box_overlaps", &S::box_overlaps, "Candidate pairs that left the sweep.")
        .def_ro("edge_tests", &S::edge_tests, "Pairs that no plane separated.")
        .def_ro("double_tests", &S::double_tests, "Pairs that float32 filters left undecided.")
        .def_ro("exact_tests", &S::exact_tests, "Pairs that float64 filters left undecided: exact arithmetic.")
        .def_ro("rational_tests", &S::rational_tests, "Of these, beyond the range of expansions or degenerate.")
        .def_ro("pairs", &S::pairs, "Colliding pairs.")
        .def_ro("peak_memory_bytes", &S::peak_memory_bytes, "Most that the detector has owned, this result included.")
        .def_ro("threads", &S::threads, "Threads of the detector.")
        .def_ro("backend", &S::backend, "\"cpu\" or \"reference\".")
        .def_ro("simd", &S::simd, "Instruction set that was used; empty for the reference backend.")
        .def("__repr__", [](const S& s) {
            return nb::str(
                       "Statistics(milliseconds={:.3f}, triangles={}, box_overlaps={}, exact_tests={}, pairs={}, "
                       "threads={}, backend={!r}, simd={!r})")
                .format(s.milliseconds, s.triangles, s.box_overlaps, s.exact_tests, s.pairs, s.threads, s.backend,
                        s.simd);
        });
}

}  // namespace

void bind_result(nb::module_& module) {
    bind_statistics(module);
    nb::class_<Result>(module, "Collisions", "The library's answer; crumple.Result gives access to it.")
        .def("__len__", [](const Result& r) { return r.collisions.pairs.size(); })
        .def_prop_ro("pairs",
                     [](nb::handle self) {
                         const auto& pairs = collisions_of(self).pairs;
                         return view<std::int32_t>(self, pairs.data(), pairs.size(), 2);
                     })
        .def_prop_ro("offsets",
                     [](nb::handle self) {
                         const auto& offsets = collisions_of(self).offsets;
                         return view<std::int64_t>(self, offsets.data(), offsets.size());
                     })
        .def_prop_ro("hit",
                     [](nb::handle self) {
                         const auto& hit = collisions_of(self).hit;
                         return view<bool>(self, hit.data(), hit.size());
                     })
        .def_prop_ro("hit_second",
                     [](nb::handle self) {
                         const auto& hit = collisions_of(self).hit_second;
                         return view<bool>(self, hit.data(), hit.size());
                     })
        .def_prop_ro("contact_kinds",
                     [](nb::handle self) {
                         const auto& kinds = collisions_of(self).contacts.kinds;
                         return view<std::uint8_t>(self, kinds.data(), kinds.size());
                     })
        .def_prop_ro("contact_offsets",
                     [](nb::handle self) {
                         const auto& offsets = collisions_of(self).contacts.offsets;
                         return view<std::int64_t>(self, offsets.data(), offsets.size());
                     })
        .def_prop_ro("contact_points",
                     [](nb::handle self) {
                         const auto& points = collisions_of(self).contacts.points;
                         return view<double>(self, points.data(), points.size(), 3);
                     })
        .def_prop_ro(
            "statistics", [](const Result& r) -> const Statistics& { return r.collisions.statistics; },
            nb::rv_policy::copy);
}

}  // namespace crumple::python
