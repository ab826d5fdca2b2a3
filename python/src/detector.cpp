#include "detector.h"

#include <array>
#include <chrono>
#include <tuple>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/device.h"
#include "names.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

unsigned long main_thread = 0;

}  // namespace

void handle_signals() {
    if (PyThread_get_thread_ident() != main_thread) return;
    const nb::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

SharedDetector::SharedDetector(const Options& options) : detector_(options) { detector_.set_poll(handle_signals); }

SharedDetector::Turn::Turn(SharedDetector& detector) : detector_(detector) {
    if (detector_.caller_ == std::this_thread::get_id())
        refuse("a signal handler cannot call the detector whose call it interrupts");
    bool locked = detector_.mutex_.try_lock();  // the ordinary case, without a look at the clock
    while (!locked) {
        handle_signals();
        locked = detector_.mutex_.try_lock_for(std::chrono::milliseconds(20));
    }
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
void SharedDetector::find(const MeshView& first, const MeshView* second, const Part* part, const Query& query,
                          Collisions& answer) {
    const Turn turn(*this);
    detector_.take_result(std::move(answer));
    search(first, second, part, query);
    answer = detector_.take_result();
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

// Arrays on a device must lie on the one that the detector works on.
void check_device(const SharedDetector& detector, int device) {
    if (device == BorrowedArray::on_host) return;
    if (detector.backend() != Backend::cuda) {
        const std::string reason = list_devices().reason;
        refuse("the arrays lie in CUDA memory, which needs the cuda backend" + (reason.empty() ? "" : "; " + reason) +
               ": " + copy_to_host);
    }
    if (device != detector.options().device)
        refuse("the arrays lie in the memory of CUDA device " + std::to_string(device) +
               ", but the detector works on device " + std::to_string(detector.options().device));
}

/// What Python says of one call; holds what the views point to.
struct Call {
    BorrowedMesh first;
    std::optional<BorrowedMesh> second;
    std::vector<GroupPair> excluded;
    Query query;

    Call(const SharedDetector& detector, nb::handle a, nb::handle b) : first(a, b.is_none() ? "" : "first mesh: ") {
        check_device(detector, first.device());
        if (b.is_none()) return;
        second.emplace(b, "second mesh: ");
        check_device(detector, second->device());
    }
    Call(const SharedDetector& detector, nb::handle a, nb::handle b, nb::handle neighbours, nb::handle intersections,
         nb::handle weld, nb::handle contacts, nb::handle wanted, nb::handle excluded_groups)
        : Call(detector, a, b) {
        excluded = group_pairs(excluded_groups);
        query = {named(neighbours_names, "neighbours", neighbours),
                 named(intersections_names, "intersections", intersections),
                 flag("weld", weld),
                 flag("contacts", contacts),
                 named(wanted_names, "wanted", wanted),
                 excluded};
    }
    const MeshView* second_or_null() const { return second ? &second->view() : nullptr; }
};

// The Part in an object that __new__ may have left without one.
const Part& part_of(nb::handle object, std::string_view argument) {
    if (!nb::isinstance<Part>(object)) refuse_type(argument, "a crumple.Part", object);
    if (!nb::inst_ready(object)) refuse(std::string(argument) + " is a crumple.Part that nothing was put into");
    return *nb::inst_ptr<Part>(object);
}

const Part* part_or_null(nb::handle part) {
    if (part.is_none()) return nullptr;
    return &part_of(part, "part");
}

template <class Work>
auto without_gil(Work work) {
    const nb::gil_scoped_release released;
    return work();
}

template <class T>
nb::ndarray<nb::numpy, const T> column(nb::handle owner, const std::vector<T>& values) {
    return {values.data(), {values.size()}, owner};
}

using PartState =
    std::tuple<std::int32_t, std::vector<std::array<double, 3>>, std::vector<std::int32_t>, std::vector<std::int32_t>>;

void bind_part(nb::module_& module) {
    nb::class_<Part>(module, "Part",
                     "One of several independent, overlapping parts of a scene; see Detector.partition. A plain value\n"
                     "that can be pickled: send it anywhere and answer it there for the same meshes.")
        .def_ro("index", &Part::index, "Which of `centres` this part is.")
        .def_prop_ro(
            "centres",
            [](nb::handle self) {
                const auto& centres = part_of(self, "this").centres;
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

}  // namespace

void bind_detector(nb::module_& module) {
    main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
    bind_part(module);
    nb::class_<SharedDetector>(module, "Detector", "The library's detector; crumple.Detector gives access to it.")
        .def("__init__",
             [](SharedDetector* self, const nb::kwargs& options) {
                 new (self) SharedDetector({
                     .backend = named(backend_names, "backend", options["backend"]),
                     .threads = integer<int>("threads", options["threads"]),
                     .memory_limit = integer<std::int64_t>("memory_limit", options["memory_limit"]),
                     .clusters = integer<int>("clusters", options["clusters"]),
                     .leaf_size = integer<int>("leaf_size", options["leaf_size"]),
                     .fuzziness = real("fuzziness", options["fuzziness"]),
                     .max_iterations = integer<int>("max_iterations", options["max_iterations"]),
                     .first_iterations = integer<int>("first_iterations", options["first_iterations"]),
                     .stop = real("stop", options["stop"]),
                     .first_stop = real("first_stop", options["first_stop"]),
                     .simd = named(simd_names, "simd", options["simd"]),
                     .device = integer<int>("device", options["device"]),
                 });
             })
        .def_prop_ro("backend", [](const SharedDetector& self) { return name_of(backend_names, self.backend()); })
        .def_prop_ro("fallback", [](const SharedDetector& self) { return self.fallback(); })
        .def("cancel", [](SharedDetector& self) { self.cancel(); })
        .def(
            "find",
            [](SharedDetector& self, nb::handle first, nb::handle second, nb::handle part, nb::handle neighbours,
               nb::handle intersections, nb::handle weld, nb::handle contacts, nb::handle wanted,
               nb::handle excluded_groups, nb::handle copy) {
                const Call call(self, first, second, neighbours, intersections, weld, contacts, wanted,
                                excluded_groups);
                const Part* const of = part_or_null(part);
                Result result{self.storage(), nb::borrow(first), nb::borrow(second), call.query.contacts,
                              flag("copy", copy)};
                without_gil(
                    [&] { self.find(call.first.view(), call.second_or_null(), of, call.query, *result.storage); });
                return make_result(std::move(result));
            },
            "first"_a, "second"_a.none(), "part"_a.none(), "neighbours"_a.none(), "intersections"_a.none(),
            "weld"_a.none(), "contacts"_a.none(), "wanted"_a.none(), "excluded_groups"_a.none(), "copy"_a.none())
        .def(
            "any",
            [](SharedDetector& self, nb::handle first, nb::handle second, nb::handle neighbours,
               nb::handle intersections, nb::handle weld, nb::handle wanted, nb::handle excluded_groups) {
                const Call call(self, first, second, neighbours, intersections, weld, nb::bool_(false), wanted,
                                excluded_groups);
                return without_gil([&] { return self.any(call.first.view(), call.second_or_null(), call.query); });
            },
            "first"_a, "second"_a.none(), "neighbours"_a.none(), "intersections"_a.none(), "weld"_a.none(),
            "wanted"_a.none(), "excluded_groups"_a.none())
        .def(
            "partition",
            [](SharedDetector& self, nb::handle first, nb::handle second, nb::handle count) {
                const Call call(self, first, second);
                const int parts = integer<int>("count", count);
                return without_gil([&] { return self.partition(call.first.view(), call.second_or_null(), parts); });
            },
            "first"_a, "second"_a.none(), "count"_a.none());
    module.def("list_devices", [] {
        const DeviceList list = without_gil(list_devices);
        nb::list devices;
        for (const DeviceInfo& d : list.devices)
            devices.append(nb::make_tuple(d.number, d.name, d.major, d.minor, d.memory_bytes));
        return nb::make_tuple(devices, list.reason);
    });
}

}  // namespace crumple::python
