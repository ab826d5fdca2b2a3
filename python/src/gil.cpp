#include "gil.h"

#include <pthread.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace crumple::python {

void hang() {
    for (;;) pause();
}

bool interpreter_ends() {
    PyObject* const ends = PySys_GetObject("is_finalizing");  // Py_IsFinalizing is not in the stable ABI
    if (!ends) return true;
    const nb::object answer = nb::steal(PyObject_CallNoArgs(ends));
    if (!answer) throw nb::python_error();
    return answer.is(Py_True);
}

nb::object call_python(const char* module, const char* function, std::initializer_list<nb::handle> given) {
    const nb::object from = nb::steal(in_python([&] { return PyImport_ImportModule(module); }));
    if (!from) throw nb::python_error();
    const nb::object called = from.attr(function);
    std::vector<PyObject*> arguments;
    for (const nb::handle argument : given) arguments.push_back(argument.ptr());
    PyObject* const result =
        in_python([&] { return PyObject_Vectorcall(called.ptr(), arguments.data(), arguments.size(), nullptr); });
    if (!result) throw nb::python_error();
    return nb::steal(result);
}

WithoutGil* WithoutGil::all_ = nullptr;

WithoutGil::WithoutGil(AtExit at_exit, std::stop_source stop) : next_(all_), stop_(std::move(stop)), at_exit_(at_exit) {
    all_ = this;
    state_ = PyEval_SaveThread();
}

WithoutGil::~WithoutGil() {
    done_.store(true, std::memory_order_release);
    in_python([&] {
        PyEval_RestoreThread(state_);
        return true;
    });
    WithoutGil** link = &all_;
    while (*link && *link != this) link = &(*link)->next_;
    if (*link) *link = next_;
}

void WithoutGil::watch_exit() {
    Py_AtExit(end_all);
    // In the child process of a fork, the other threads and their work do not exist.
    pthread_atfork(nullptr, nullptr, [] { all_ = nullptr; });
}

// Requests a stop of all work and waits for it as AtExit describes, because work that continues while static objects
// are destroyed may crash the process. Runs after the interpreter has ended: no thread gets the GIL any more, so the
// list does not change.
void WithoutGil::end_all() {
    using Clock = std::chrono::steady_clock;
    const auto patience = Clock::now() + std::chrono::seconds(1);
    for (bool waiting = true; waiting; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
        const bool patient = Clock::now() < patience;
        waiting = false;
        for (WithoutGil* work = all_; work; work = work->next_) {
            if (work->done_.load(std::memory_order_acquire)) continue;
            work->wanted_.store(false, std::memory_order_relaxed);
            work->stop_.request_stop();
            waiting = waiting || patient || work->at_exit_ == AtExit::finished;
        }
        if (!waiting) return;
    }
}

}  // namespace crumple::python
