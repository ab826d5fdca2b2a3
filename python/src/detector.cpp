#include "detector.h"

#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "arguments.h"
#include "arrays.h"
#include "calls.h"
#include "crumple/device.h"
#include "gil.h"
#include "launches.h"
#include "names.h"
#include "options.h"
#include "signals.h"

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
        refuse("neither a signal handler nor take(block) can call a detector while another call of it is in progress");
    while (detector_.caller_ != std::thread::id()) {
        if (interpreter_ends())
            throw Error(ErrorCode::cancelled, "the interpreter is shutting down during another thread's call");
        detector_.wait_for_another_call();
    }
    detector_.caller_ = self;
    detector_.stop_.emplace();
}

SharedDetector::Turn::~Turn() {
    detector_.caller_ = std::thread::id();
    if (detector_.waiting_ == 0) return;
    const std::lock_guard lock(detector_.mutex_);
    ++detector_.calls_done_;
    detector_.call_done_.notify_one();
}

// Waits until another call may have ended. Cannot miss the end of a Turn: a Turn ends in a thread that has the GIL, and
// this function releases the GIL only while it holds the mutex, so calls_done_ cannot change before the wait begins.
void SharedDetector::wait_for_another_call() {
    ++waiting_;
    {
        std::unique_lock lock(mutex_);
        const std::uint64_t seen = calls_done_;
        const WithoutGil released;
        call_done_.wait_for(lock, std::chrono::milliseconds(20), [&] { return calls_done_ != seen; });
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

void make(nb::handle self, const nb::dict& given) {
    check_self(self);
    const Options options = options_of(given);
    // From here on no Python code and no other thread runs, so __init__ cannot be called twice at the same time.
    if (nb::inst_ready(self)) refuse("crumple.Detector.__init__ has been called already");
    new (nb::inst_ptr<SharedDetector>(self)) SharedDetector(options);
    nb::inst_mark_ready(self);
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
    nb::class_<SharedDetector> detector(module, "Detector", "Detector of the library; base class of crumple.Detector.");
    detector.def("__init__", make, "options"_a)
        .def_prop_ro("backend", [](nb::handle self) { return name_of(backend_names, detector_of(self).backend()); })
        .def_prop_ro("fallback", [](nb::handle self) { return detector_of(self).fallback(); })
        .def("cancel", [](nb::handle self) { detector_of(self).cancel(); });
    bind_calls(detector);
    bind_launches(detector);
    module.def("list_devices", listed_devices);
}

}  // namespace crumple::python
