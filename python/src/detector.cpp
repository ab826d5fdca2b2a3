#include "detector.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/device.h"
#include "gil.h"
#include "method.h"
#include "names.h"
#include "part.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

unsigned long main_thread = 0;
nb::handle detector_class;  // the base of crumple.Detector

}  // namespace

void handle_signals() {
    if (PyThread_get_thread_ident() != main_thread) return;
    const nb::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

SharedDetector::SharedDetector(const Options& options) : detector_(options) { detector_.set_poll(handle_signals); }

SharedDetector::Turn::Turn(SharedDetector& detector) : detector_(detector) {
    const std::thread::id self = std::this_thread::get_id();
    if (detector_.caller_ == self) refuse("a signal handler cannot call the detector whose call it interrupts");
    while (detector_.caller_ != std::thread::id()) {
        if (interpreter_ends()) throw Error(ErrorCode::cancelled, "the interpreter ends in another thread's call");
        detector_.wait_for_another_turn();
    }
    detector_.caller_ = self;
}

SharedDetector::Turn::~Turn() {
    detector_.caller_ = std::thread::id();
    if (detector_.waiting_ == 0) return;
    const std::lock_guard lock(detector_.mutex_);
    ++detector_.turns_;
    detector_.turn_ended_.notify_one();
}

// No turn ends unseen: it ends with the GIL, which is let go here only with the mutex in hand.
void SharedDetector::wait_for_another_turn() {
    ++waiting_;
    {
        std::unique_lock lock(mutex_);
        const std::uint64_t seen = turns_;
        const WithoutGil released;
        turn_ended_.wait_for(lock, std::chrono::milliseconds(20), [&] { return turns_ != seen; });
        lock.unlock();
    }
    --waiting_;
    handle_signals();
}

std::shared_ptr<Collisions> SharedDetector::storage() {
    if (options().memory_limit > 0) return std::make_shared<Collisions>();
    if (last_.use_count() != 1) std::swap(last_, before_);
    if (last_.use_count() != 1) last_ = std::make_shared<Collisions>();
    return last_;
}

const Collisions& SharedDetector::search(const MeshView& first, const MeshView* second, const Part* part,
                                         const Query& query) {
    if (part)
        return second ? detector_.find_between(first, *second, *part, query) : detector_.find_self(first, *part, query);
    return second ? detector_.find_between(first, *second, query) : detector_.find_self(first, query);
}

// Storage moves in and comes back as the result, which outlives the detector and its next call.
void SharedDetector::find(const MeshView& first, const MeshView* second, const Part* part, const Query& query,
                          Collisions& answer) {
    detector_.swap_result(answer);
    search(first, second, part, query);
    detector_.swap_result(answer);
}

bool SharedDetector::any(const MeshView& first, const MeshView* second, const Query& query) {
    return second ? detector_.has_collision(first, *second, query) : detector_.has_collision(first, query);
}

std::vector<Part> SharedDetector::partition(const MeshView& first, const MeshView* second, int count) {
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

/// The meshes of one call, and the views of them that the library gets.
struct Meshes {
    GivenMesh a;
    std::optional<GivenMesh> b;
    BorrowedMesh first;
    std::optional<BorrowedMesh> second;

    Meshes(const SharedDetector& detector, GivenMesh soup) : a(std::move(soup)), first(a, "") {
        check_device(detector, first.device());
    }
    Meshes(const SharedDetector& detector, GivenMesh one, GivenMesh other)
        : a(std::move(one)), b(std::move(other)), first(a, "first mesh: ") {
        check_device(detector, first.device());
        second.emplace(*b, "second mesh: ");
        check_device(detector, second->device());
    }
    const MeshView* second_or_null() const { return second ? &second->view() : nullptr; }
};

/// The arguments that all methods share; null where nothing is given.
struct GivenQuery {
    nb::handle neighbours, intersections, weld, contacts, wanted, excluded_groups;

    /// `excluded` is where the query keeps its pairs.
    Query read(std::vector<GroupPair>& excluded) const {
        Query query;
        if (excluded_groups) query.excluded_groups = excluded = group_pairs(excluded_groups);
        if (neighbours) query.neighbours = named(neighbours_names, "neighbours", neighbours);
        if (intersections) query.intersections = named(intersections_names, "intersections", intersections);
        if (weld) query.weld = flag("weld", weld);
        if (contacts) query.contacts = flag("contacts", contacts);
        if (wanted) query.wanted = named(wanted_names, "wanted", wanted);
        return query;
    }
};

template <class Work>
auto without_gil(Work work, Detector* detector = nullptr) {
    const WithoutGil released(WithoutGil::AtExit::given_up, detector);
    return work();
}

void check_self(nb::handle self) {
    if (!PyObject_TypeCheck(self.ptr(), reinterpret_cast<PyTypeObject*>(detector_class.ptr())))
        refuse_type("self", "a crumple.Detector", self);
}

// The detector that a method is called on. A class of Python may leave it without what __init__ makes.
SharedDetector& detector_of(nb::handle self) {
    check_self(self);
    if (!nb::inst_ready(self)) refuse("crumple.Detector.__init__ has not been called");
    return *nb::inst_ptr<SharedDetector>(self);
}

// The soup of find_self and has_intersections: arrays, or one object that holds them.
GivenMesh given_soup(nb::handle vertices, nb::handle faces, nb::handle groups) {
    const bool grouped = groups && !groups.is_none();
    if (faces && !faces.is_none())
        return {nb::borrow(vertices), nb::borrow(faces), grouped ? nb::borrow(groups) : nb::none()};
    GivenMesh mesh = given_mesh(vertices);
    if (grouped) mesh.groups = nb::borrow(groups);
    return mesh;
}

nb::object find(SharedDetector& self, Meshes meshes, const GivenQuery& given, nb::handle part, nb::handle copy) {
    std::vector<GroupPair> excluded;
    const Query query = given.read(excluded);
    const Part* const of = part_or_null(part);
    const bool copied = copy && flag("copy", copy);
    const SharedDetector::Turn turn(self);
    Result result{self.storage(), std::move(meshes.a), std::move(meshes.b), query.contacts, copied};
    without_gil([&] { self.find(meshes.first.view(), meshes.second_or_null(), of, query, *result.storage); },
                &self.library());
    return make_result(std::move(result));
}

nb::object any(SharedDetector& self, const Meshes& meshes, const GivenQuery& given) {
    std::vector<GroupPair> excluded;
    const Query query = given.read(excluded);
    const SharedDetector::Turn turn(self);
    return nb::bool_(
        without_gil([&] { return self.any(meshes.first.view(), meshes.second_or_null(), query); }, &self.library()));
}

nb::object find_self(const Given<12>& given) {
    const auto& [self, vertices, faces, groups, neighbours, intersections, weld, contacts, wanted, excluded_groups,
                 part, copy] = given;
    SharedDetector& detector = detector_of(self);
    return find(detector, Meshes{detector, given_soup(vertices, faces, groups)},
                {neighbours, intersections, weld, contacts, wanted, excluded_groups}, part, copy);
}

nb::object find_between(const Given<11>& given) {
    const auto& [self, a, b, neighbours, intersections, weld, contacts, wanted, excluded_groups, part, copy] = given;
    SharedDetector& detector = detector_of(self);
    return find(detector, Meshes{detector, given_mesh(a), given_mesh(b)},
                {neighbours, intersections, weld, contacts, wanted, excluded_groups}, part, copy);
}

nb::object has_intersections(const Given<9>& given) {
    const auto& [self, vertices, faces, groups, neighbours, intersections, weld, wanted, excluded_groups] = given;
    SharedDetector& detector = detector_of(self);
    return any(detector, Meshes{detector, given_soup(vertices, faces, groups)},
               {neighbours, intersections, weld, {}, wanted, excluded_groups});
}

nb::object has_intersections_between(const Given<8>& given) {
    const auto& [self, a, b, neighbours, intersections, weld, wanted, excluded_groups] = given;
    SharedDetector& detector = detector_of(self);
    return any(detector, Meshes{detector, given_mesh(a), given_mesh(b)},
               {neighbours, intersections, weld, {}, wanted, excluded_groups});
}

// As crumple/_detector.py declares them.
constexpr Definition<12> find_self_method{{"self", "vertices", "faces", "groups", "neighbours", "intersections", "weld",
                                           "contacts", "wanted", "excluded_groups", "part", "copy"},
                                          find_self};
constexpr Definition<11> find_between_method{
    {"self", "a", "b", "neighbours", "intersections", "weld", "contacts", "wanted", "excluded_groups", "part", "copy"},
    find_between};
constexpr Definition<9> has_intersections_method{
    {"self", "vertices", "faces", "groups", "neighbours", "intersections", "weld", "wanted", "excluded_groups"},
    has_intersections};
constexpr Definition<8> has_intersections_between_method{
    {"self", "a", "b", "neighbours", "intersections", "weld", "wanted", "excluded_groups"}, has_intersections_between};

constexpr std::pair<std::string_view, nb::object (*)(nb::handle)> methods[]{
    {"find_self", make_method<find_self_method>},
    {"find_between", make_method<find_between_method>},
    {"has_intersections", make_method<has_intersections_method>},
    {"has_intersections_between", make_method<has_intersections_between_method>}};

nb::object method(nb::handle declaration) {
    const auto declared = nb::cast<std::string>(declaration.attr("__name__"));
    for (const auto& [name, make] : methods)
        if (name == declared) return make(declaration);
    refuse("no method " + declared + " is defined");
}

}  // namespace

void bind_detector(nb::module_& module) {
    main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
    nb::class_<SharedDetector> type(module, "Detector", "The library's detector; crumple.Detector is one.");
    detector_class = type;
    type.def("__init__",
             [](nb::handle self, const nb::kwargs& options) {
                 check_self(self);
                 const Options given{
                     .backend = named(backend_names, "backend", options["backend"]),
                     .threads = integer<int>("threads", options["threads"]),
                     .memory_limit = integer<std::int64_t>("memory_limit", options["memory_limit"]),
                     .count_bytes_needed = flag("count_bytes_needed", options["count_bytes_needed"]),
                     .clusters = integer<int>("clusters", options["clusters"]),
                     .leaf_size = integer<int>("leaf_size", options["leaf_size"]),
                     .fuzziness = real("fuzziness", options["fuzziness"]),
                     .max_iterations = integer<int>("max_iterations", options["max_iterations"]),
                     .first_iterations = integer<int>("first_iterations", options["first_iterations"]),
                     .stop = real("stop", options["stop"]),
                     .first_stop = real("first_stop", options["first_stop"]),
                     .simd = named(simd_names, "simd", options["simd"]),
                     .device = integer<int>("device", options["device"]),
                 };
                 // From here on no code of Python runs, and no other thread.
                 if (nb::inst_ready(self)) refuse("crumple.Detector.__init__ has been called already");
                 new (nb::inst_ptr<SharedDetector>(self)) SharedDetector(given);
                 nb::inst_mark_ready(self);
             })
        .def_prop_ro("backend", [](nb::handle self) { return name_of(backend_names, detector_of(self).backend()); })
        .def_prop_ro("fallback", [](nb::handle self) { return detector_of(self).fallback(); })
        .def("cancel", [](nb::handle self) { detector_of(self).cancel(); })
        .def(
            "partition",
            [](nb::handle object, nb::handle first, nb::handle second, nb::handle count) {
                SharedDetector& self = detector_of(object);
                const Meshes meshes = second.is_none() ? Meshes{self, given_mesh(first)}
                                                       : Meshes{self, given_mesh(first), given_mesh(second)};
                const int parts = integer<int>("count", count);
                const SharedDetector::Turn turn(self);
                return without_gil([&] { return self.partition(meshes.first.view(), meshes.second_or_null(), parts); },
                                   &self.library());
            },
            "first"_a.none(), "second"_a.none(), "count"_a.none());
    module.def("method", method, "declaration"_a);
    module.def("list_devices", [] {
        const DeviceList list = without_gil(list_devices);
        nb::list devices;
        for (const DeviceInfo& d : list.devices)
            devices.append(nb::make_tuple(d.number, d.name, d.major, d.minor, d.memory_bytes));
        return nb::make_tuple(devices, list.reason);
    });
}

}  // namespace crumple::python
