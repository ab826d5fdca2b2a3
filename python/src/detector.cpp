#include "detector.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include "answer.h"
#include "arguments.h"
#include "arrays.h"
#include "blocks.h"
#include "candidates.h"
#include "crumple/device.h"
#include "feature_search.h"
#include "feature_streams.h"
#include "gil.h"
#include "launches.h"
#include "names.h"
#include "nearest.h"
#include "options.h"
#include "part.h"
#include "query.h"
#include "signals.h"
#include "world_search.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
void check_device(const SharedDetector& detector, int device) {
    if (device == BorrowedArray::on_host) return;
    if (detector.backend() != Backend::cuda) {
        const std::string reason = list_devices().reason;
        refuse("the arrays lie in CUDA memory, which needs the cuda backend" + (reason.empty() ? "" : "; " + reason) +
               ": " + copy_to_host);
    }
    const int own = detector.options().first_device();
    if (device != own)
        refuse("the arrays lie in the memory of CUDA device " + std::to_string(device) +
               ", but the detector works on device " + std::to_string(own));
}

SharedDetector::SharedDetector(const Options& options) : detector_(options) { detector_.set_poll(handle_signals); }

SharedDetector::Turn::Turn(SharedDetector& detector) : detector_(detector) {
    const std::thread::id self = std::this_thread::get_id();
    if (detector_.caller_ == self)
        refuse("neither a signal handler nor what takes a block can call the detector whose call goes on");
    while (detector_.caller_ != std::thread::id()) {
        if (interpreter_ends()) throw Error(ErrorCode::cancelled, "the interpreter ends in another thread's call");
        detector_.wait_for_another_turn();
    }
    detector_.caller_ = self;
    detector_.stop_.emplace();
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

namespace {

void check_self(nb::handle self) {
    if (!nb::isinstance<SharedDetector>(self)) refuse_type("self", "a crumple.Detector", self);
}

}  // namespace

SharedDetector& detector_of(nb::handle self) {
    check_self(self);
    if (!nb::inst_ready(self)) refuse("crumple.Detector.__init__ has not been called");
    return *nb::inst_ptr<SharedDetector>(self);
}

namespace {

void check_devices(const SharedDetector& detector, const BorrowedMeshes& meshes) {
    check_device(detector, meshes.first.device());
    if (meshes.second) check_device(detector, meshes.second->device());
}

void make(nb::handle self, const nb::dict& given) {
    check_self(self);
    const Options options = options_of(given);
    // From here on no code of Python runs, and no other thread.
    if (nb::inst_ready(self)) refuse("crumple.Detector.__init__ has been called already");
    new (nb::inst_ptr<SharedDetector>(self)) SharedDetector(options);
    nb::inst_mark_ready(self);
}

Answer find(nb::handle self, const nb::tuple& first, const std::optional<nb::tuple>& second,
            const IntersectionQuery& query, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const BorrowedMeshes meshes(first, second);
    check_devices(detector, meshes);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    Answer answer{detector.storage<Intersections>(), query.contacts(), copied};
    without_gil([&] { detector.find(meshes.scene(), query, *answer.storage); }, detector.stop());
    return answer;
}

Answer find_part(nb::handle self, nb::handle part, const IntersectionQuery& query, nb::handle copy) {
    SharedDetector& detector = detector_of(self);
    const Part& of = given_part(part);
    const bool copied = flag("copy", copy);
    const SharedDetector::Turn turn(detector);
    Answer answer{detector.storage<Intersections>(), query.contacts(), copied};
    without_gil([&] { detector.find(of, query, *answer.storage); }, detector.stop());
    return answer;
}

bool any(nb::handle self, const nb::tuple& first, const std::optional<nb::tuple>& second,
         const IntersectionQuery& query) {
    SharedDetector& detector = detector_of(self);
    const BorrowedMeshes meshes(first, second);
    check_devices(detector, meshes);
    const SharedDetector::Turn turn(detector);
    return without_gil([&] { return detector.any(meshes.scene(), query); }, detector.stop());
}

Statistics stream(nb::handle self, nb::handle take, const nb::tuple& first, const std::optional<nb::tuple>& second,
                  const IntersectionQuery& query, nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const BorrowedMeshes meshes(first, second);
    check_devices(detector, meshes);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    const auto make = [&](std::shared_ptr<Intersections> block) {
        return Answer{std::move(block), query.contacts(), false};
    };
    return hand_over_blocks<Intersections>(detector, take, make, [&](Detector& by, auto& sink, std::stop_token stop) {
        return by.stream(meshes.scene(), query, sink, rows, std::move(stop));
    });
}

std::vector<Part> partition(nb::handle self, const nb::tuple& first, const std::optional<nb::tuple>& second,
                            nb::handle count) {
    SharedDetector& detector = detector_of(self);
    const BorrowedMeshes meshes(first, second);
    check_devices(detector, meshes);
    const int parts = integer<int>("count", count);
    const SharedDetector::Turn turn(detector);
    return without_gil([&] { return detector.partition(meshes.scene(), IntersectionQuery(), parts); }, detector.stop());
}

nb::tuple listed_devices() {
    const DeviceList list = without_gil(list_devices);
    nb::list devices;
    for (const DeviceInfo& d : list.devices)
        devices.append(nb::make_tuple(d.number, d.name, d.major, d.minor, d.memory_bytes));
    return nb::make_tuple(devices, list.reason);
}

}  // namespace

void bind_detector(nb::module_& module) {
    bind_question(module);
    module.def("Query", make_query, "neighbours"_a.none(), "intersections"_a.none(), "weld"_a.none(),
               "contacts"_a.none(), "wanted"_a.none(), "excluded_groups"_a.none());
    bind_feature_questions(module);
    nb::class_<SharedDetector> detector(module, "Detector", "The library's detector; crumple.Detector is one.");
    bind_launches(detector);
    detector.def("__init__", make, "options"_a)
        .def_prop_ro("backend", [](nb::handle self) { return name_of(backend_names, detector_of(self).backend()); })
        .def_prop_ro("fallback", [](nb::handle self) { return detector_of(self).fallback(); })
        .def("cancel", [](nb::handle self) { detector_of(self).cancel(); })
        .def("_find", find, "first"_a, "second"_a.none(), "query"_a, "copy"_a.none())
        .def("_find_part", find_part, "part"_a.none(), "query"_a, "copy"_a.none())
        .def("_find_world", find_world, "world"_a.none(), "poses"_a.none(), "question"_a, "excluded"_a.none(),
             "copy"_a.none())
        .def("_find_impacts", find_impacts, "mesh"_a, "end"_a.none(), "question"_a, "copy"_a.none(), "lists"_a)
        .def("_find_impacts_in_world", find_impacts_in_world, "world"_a, "poses"_a.none(), "end_poses"_a.none(),
             "question"_a, "excluded"_a.none(), "copy"_a.none())
        .def("_find_impacts_in_part", find_impacts_in_part, "part"_a.none(), "question"_a, "copy"_a.none())
        .def("_find_near_in_part", find_near_in_part, "part"_a.none(), "question"_a, "copy"_a.none())
        .def("_partition_motion", partition_motion, "mesh"_a, "end"_a.none(), "question"_a, "count"_a.none(), "lists"_a)
        .def("_partition_near", partition_near, "mesh"_a, "question"_a, "radii"_a.none(), "rest"_a.none(),
             "count"_a.none(), "lists"_a)
        .def("_find_free_step", find_free_step, "mesh"_a, "end"_a.none(), "question"_a, "lists"_a)
        .def("_find_near", find_near, "mesh"_a, "question"_a, "radii"_a.none(), "rest"_a.none(), "copy"_a.none(),
             "lists"_a)
        .def("_find_near_in_world", find_near_in_world, "world"_a, "poses"_a.none(), "question"_a, "excluded"_a.none(),
             "copy"_a.none())
        .def("_find_candidates", find_candidates, "mesh"_a, "end"_a.none(), "question"_a, "copy"_a.none(), "lists"_a)
        .def("_find_candidates_in_world", find_candidates_in_world, "world"_a, "poses"_a.none(), "end_poses"_a.none(),
             "question"_a, "excluded"_a.none(), "copy"_a.none())
        .def("_find_nearest", find_nearest, "world"_a, "poses"_a.none(), "question"_a, "excluded"_a.none(),
             "copy"_a.none())
        .def("_stream_impacts", stream_impacts, "take"_a, "mesh"_a, "end"_a.none(), "question"_a, "lists"_a,
             "block_rows"_a.none())
        .def("_stream_impacts_in_world", stream_impacts_in_world, "take"_a, "world"_a, "poses"_a.none(),
             "end_poses"_a.none(), "question"_a, "excluded"_a.none(), "block_rows"_a.none())
        .def("_stream_near", stream_near, "take"_a, "mesh"_a, "question"_a, "radii"_a.none(), "rest"_a.none(),
             "lists"_a, "block_rows"_a.none())
        .def("_stream_near_in_world", stream_near_in_world, "take"_a, "world"_a, "poses"_a.none(), "question"_a,
             "excluded"_a.none(), "block_rows"_a.none())
        .def("_stream_candidates", stream_candidates, "take"_a, "mesh"_a, "end"_a.none(), "question"_a, "lists"_a,
             "block_rows"_a.none())
        .def("_stream_candidates_in_world", stream_candidates_in_world, "take"_a, "world"_a, "poses"_a.none(),
             "end_poses"_a.none(), "question"_a, "excluded"_a.none(), "block_rows"_a.none())
        .def("_stream", stream, "take"_a, "first"_a, "second"_a.none(), "query"_a, "block_rows"_a.none())
        .def("_any", any, "first"_a, "second"_a.none(), "query"_a)
        .def("_partition", partition, "first"_a, "second"_a.none(), "count"_a.none());
    module.def("list_devices", listed_devices);
}

}  // namespace crumple::python
