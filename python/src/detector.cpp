#include "detector.h"

#include <chrono>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "names.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

unsigned long main_thread = 0;

// Runs Python's signal handlers, which is for the main thread alone. Call without the GIL.
void handle_signals() {
    if (PyThread_get_thread_ident() != main_thread) return;
    const nb::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

}  // namespace

SharedDetector::SharedDetector(const Options& options) : detector_(options) { detector_.set_poll(handle_signals); }

SharedDetector::Turn::Turn(SharedDetector& detector) : detector_(detector) {
    if (detector_.caller_ == std::this_thread::get_id())
        refuse("a signal handler cannot call the detector whose call it interrupts");
    while (!detector_.mutex_.try_lock_for(std::chrono::milliseconds(20))) handle_signals();
    detector_.caller_ = std::this_thread::get_id();
}

SharedDetector::Turn::~Turn() {
    detector_.caller_ = std::thread::id();
    detector_.mutex_.unlock();
}

const Collisions& SharedDetector::search(const MeshView& first, const MeshView* second, const Part* part,
                                         const Query& query) {
    if (part)
        return second ? detector_.find_between(first, *second, *part, query) : detector_.find_self(first, *part, query);
    return second ? detector_.find_between(first, *second, query) : detector_.find_self(first, query);
}

// The result moves out, so that Python's outlives the next call and the detector; storage of a dropped one moves in.
std::unique_ptr<Result> SharedDetector::find(const MeshView& first, const MeshView* second, const Part* part,
                                             const Query& query) {
    const Turn turn(*this);
    detector_.take_result(spare_->take());
    search(first, second, part, query);
    auto result = std::make_unique<Result>(spare_);
    result->collisions = detector_.take_result();
    return result;
}

bool SharedDetector::any(const MeshView& first, const MeshView* second, const Query& query) {
    const Turn turn(*this);
    return second ? detector_.has_collision(first, *second, query) : detector_.has_collision(first, query);
}

std::vector<Part> SharedDetector::partition(const MeshView& first, const MeshView* second, int count) {
    const Turn turn(*this);
    return second ? detector_.partition(first, *second, count) : detector_.partition(first, count);
}

namespace {

/// What Python says of one call; holds what the views point to.
struct Call {
    BorrowedMesh first;
    std::optional<BorrowedMesh> second;
    std::vector<GroupPair> excluded;
    Query query;

    Call(nb::handle a, nb::handle b) : first(a, b.is_none() ? "" : "first mesh: ") {
        if (!b.is_none()) second.emplace(b, "second mesh: ");
    }
    Call(nb::handle a, nb::handle b, std::string_view neighbours, std::string_view intersections, bool weld,
         bool contacts, std::string_view wanted, nb::handle excluded_groups)
        : Call(a, b) {
        excluded = group_pairs(excluded_groups);
        query = {named(neighbours_names, "neighbours", neighbours),
                 named(intersections_names, "intersections", intersections),
                 weld,
                 contacts,
                 named(wanted_names, "wanted", wanted),
                 excluded};
    }
    const MeshView* second_or_null() const { return second ? &second->view() : nullptr; }
};

template <class Work>
auto without_gil(Work work) {
    const nb::gil_scoped_release released;
    return work();
}

template <class T>
nb::ndarray<nb::numpy, const T> column(nb::handle owner, const std::vector<T>& values) {
    return {values.data(), {values.size()}, owner};
}

void bind_part(nb::module_& module) {
    nb::class_<Part>(module, "Part",
                     "One of several independent, overlapping parts of a scene; see Detector.partition. A plain value\n"
                     "that can be pickled: send it anywhere and answer it there for the same meshes.")
        .def_ro("index", &Part::index, "Which of `centres` this part is.")
        .def_prop_ro(
            "centres",
            [](nb::handle self) {
                const auto& centres = nb::cast<const Part&>(self).centres;
                return nb::ndarray<nb::numpy, const double>(centres.empty() ? nullptr : centres[0].data(),
                                                            {centres.size(), 3}, self);
            },
            "(parts, 3) float64: cluster centres of all parts, in the scene's coordinates.")
        .def_prop_ro(
            "triangles", [](nb::handle self) { return column(self, nb::cast<const Part&>(self).triangles); },
            "int32: triangles of the first mesh that belong to the part, ascending.")
        .def_prop_ro(
            "triangles_second",
            [](nb::handle self) { return column(self, nb::cast<const Part&>(self).triangles_second); },
            "int32: triangles of the second mesh; empty for one soup.")
        .def("__repr__",
             [](const Part& p) {
                 return nb::str("<crumple.Part {} of {}: {} triangles>")
                     .format(p.index, p.centres.size(), p.triangles.size() + p.triangles_second.size());
             })
        .def("__getstate__",
             [](const Part& p) {
                 nb::list centres;
                 for (const auto& c : p.centres) centres.append(nb::make_tuple(c[0], c[1], c[2]));
                 return nb::make_tuple(p.index, centres, p.triangles, p.triangles_second);
             })
        .def("__setstate__", [](Part& p, const nb::tuple& state) {
            new (&p) Part();
            p.index = nb::cast<std::int32_t>(state[0]);
            for (const nb::handle c : nb::borrow<nb::list>(state[1]))
                p.centres.push_back({nb::cast<double>(c[0]), nb::cast<double>(c[1]), nb::cast<double>(c[2])});
            p.triangles = nb::cast<std::vector<std::int32_t>>(state[2]);
            p.triangles_second = nb::cast<std::vector<std::int32_t>>(state[3]);
        });
}

}  // namespace

void bind_detector(nb::module_& module) {
    main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
    bind_part(module);
    nb::class_<SharedDetector>(module, "Detector", "The library's detector; crumple.Detector gives access to it.")
        .def(
            "__init__",
            [](SharedDetector* self, std::string_view backend, int threads, std::int64_t memory_limit, int clusters,
               int leaf_size, double fuzziness, int max_iterations, int first_iterations, double stop,
               double first_stop, std::string_view simd) {
                new (self) SharedDetector({named(backend_names, "backend", backend), threads, memory_limit, clusters,
                                           leaf_size, fuzziness, max_iterations, first_iterations, stop, first_stop,
                                           named(simd_names, "simd", simd)});
            },
            "backend"_a, "threads"_a, "memory_limit"_a, "clusters"_a, "leaf_size"_a, "fuzziness"_a, "max_iterations"_a,
            "first_iterations"_a, "stop"_a, "first_stop"_a, "simd"_a)
        .def(
            "find",
            [](SharedDetector& self, nb::handle first, nb::handle second, const Part* part, std::string_view neighbours,
               std::string_view intersections, bool weld, bool contacts, std::string_view wanted,
               nb::handle excluded_groups) {
                const Call call(first, second, neighbours, intersections, weld, contacts, wanted, excluded_groups);
                return without_gil(
                    [&] { return self.find(call.first.view(), call.second_or_null(), part, call.query); });
            },
            "first"_a, "second"_a.none(), "part"_a.none(), "neighbours"_a, "intersections"_a, "weld"_a, "contacts"_a,
            "wanted"_a, "excluded_groups"_a.none())
        .def(
            "any",
            [](SharedDetector& self, nb::handle first, nb::handle second, std::string_view neighbours,
               std::string_view intersections, bool weld, std::string_view wanted, nb::handle excluded_groups) {
                const Call call(first, second, neighbours, intersections, weld, false, wanted, excluded_groups);
                return without_gil([&] { return self.any(call.first.view(), call.second_or_null(), call.query); });
            },
            "first"_a, "second"_a.none(), "neighbours"_a, "intersections"_a, "weld"_a, "wanted"_a,
            "excluded_groups"_a.none())
        .def(
            "partition",
            [](SharedDetector& self, nb::handle first, nb::handle second, int count) {
                const Call call(first, second);
                return without_gil([&] { return self.partition(call.first.view(), call.second_or_null(), count); });
            },
            "first"_a, "second"_a.none(), "count"_a);
}

}  // namespace crumple::python
