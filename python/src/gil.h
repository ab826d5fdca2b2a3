#pragma once

// The GIL given up and taken back, and Python's code called, by threads that the interpreter may not wait for.
//
// A daemon thread that wants the GIL when the interpreter ends never gets it. CPython up to 3.13 unwinds the thread's
// stack (pthread_exit), which ends the process at the first noexcept function, and on its way destroys Python's objects
// without the GIL. From 3.14 on the thread hangs. Here it hangs always, in the call of Python's that does not return.

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <stop_token>
#include <type_traits>
#include <utility>

#include <nanobind/nanobind.h>

namespace crumple::python {

/// Where a thread goes that the interpreter has ended for.
[[noreturn]] void hang();

/// Whether the interpreter ends, so that no other thread gets the GIL any more. Call with the GIL.
bool interpreter_ends();

/// Gives what `call` gives, which calls one function of Python's C API that may run code of Python or wait for the GIL.
/// Nothing that `call` destroys afterwards may need the GIL. Not inlined: compilers leave destructors out where a
/// noexcept function would end the process.
template <class Call>
[[gnu::noinline]] std::invoke_result_t<Call> in_python(Call call) {
    struct Hanging {
        bool returned = false;
        ~Hanging() {
            if (!returned) hang();
        }
    } unless;
    const auto result = call();
    unless.returned = true;
    return result;
}

/// Calls a function of a module of Python.
nanobind::object call_python(const char* module, const char* function, std::initializer_list<nanobind::handle> given);

/// The GIL, in a thread that may be the library's own and does not have it.
class WithGil {
   public:
    WithGil() : state_(in_python([] { return PyGILState_Ensure(); })) {}
    ~WithGil() { PyGILState_Release(state_); }
    WithGil(const WithGil&) = delete;
    WithGil& operator=(const WithGil&) = delete;

   private:
    PyGILState_STATE state_;
};

/// Work without the GIL. Comes and goes with it.
class WithoutGil {
   public:
    /// What the process does about work that is under way when the interpreter has ended: it waits a moment, or until
    /// there is nothing left of it, such as a temporary file. `stop` is requested.
    enum class AtExit : std::uint8_t { given_up, finished };

    explicit WithoutGil(AtExit at_exit = AtExit::given_up, std::stop_source stop = std::stop_source(std::nostopstate));
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

    /// False once the interpreter has ended: the result of the work is lost.
    bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

    /// Has the process wait at its exit. Call once.
    static void watch_exit();

   private:
    static void end_all();

    static WithoutGil* all_;  ///< guarded by the GIL
    WithoutGil* next_;
    std::stop_source stop_;
    const AtExit at_exit_;
    std::atomic<bool> done_{false}, wanted_{true};
    PyThreadState* state_;
};

/// What `work` gives, which `stop` may end.
template <class Work>
auto without_gil(Work work, std::stop_source stop = std::stop_source(std::nostopstate)) {
    const WithoutGil released(WithoutGil::AtExit::given_up, std::move(stop));
    return work();
}

}  // namespace crumple::python
