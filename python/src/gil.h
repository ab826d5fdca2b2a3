#pragma once

// Release and acquisition of the GIL, and calls of Python code, in threads that may outlive the interpreter.
//
// A daemon thread that waits for the GIL when the interpreter ends never gets it. CPython up to 3.13 unwinds the
// thread's stack (pthread_exit), which ends the process at the first noexcept function, and destroys Python objects
// without the GIL. From 3.14 on the thread hangs. Here it always hangs, in the call of Python's C API that does not
// return.

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <stop_token>
#include <type_traits>
#include <utility>

#include <nanobind/nanobind.h>

namespace crumple::python {

/// Suspends this thread forever, after the interpreter has ended.
[[noreturn]] void hang();

/// True if the interpreter is ending, so that no other thread gets the GIL any more. Call with the GIL.
bool interpreter_ends();

/// Returns the result of `call`, which calls one function of Python's C API that may run Python code or wait for the
/// GIL. Objects that `call` destroys afterwards must not need the GIL. Not inlined, because compilers omit destructors
/// where a noexcept function would end the process.
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

/// Calls a function of a Python module.
nanobind::object call_python(const char* module, const char* function, std::initializer_list<nanobind::handle> given);

/// Acquires the GIL in a thread that does not have it, for instance one of the library's.
class WithGil {
   public:
    WithGil() : state_(in_python([] { return PyGILState_Ensure(); })) {}
    ~WithGil() { PyGILState_Release(state_); }
    WithGil(const WithGil&) = delete;
    WithGil& operator=(const WithGil&) = delete;

   private:
    PyGILState_STATE state_;
};

/// Releases the GIL during its lifetime. Construct it with the GIL; its destructor reacquires it.
class WithoutGil {
   public:
    /// How long the process waits at exit for work in progress: a second, or until the work is complete, so that no
    /// temporary file is left. Requests `stop` first.
    enum class AtExit : std::uint8_t { given_up, finished };

    explicit WithoutGil(AtExit at_exit = AtExit::given_up, std::stop_source stop = std::stop_source(std::nostopstate));
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

    /// False after the interpreter has ended: nobody uses the result of the work.
    bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

    /// Makes the process wait at exit for work in progress. Call once.
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

/// Returns the result of `work`, without the GIL. `stop` can end the work.
template <class Work>
auto without_gil(Work work, std::stop_source stop = std::stop_source(std::nostopstate)) {
    const WithoutGil released(WithoutGil::AtExit::given_up, std::move(stop));
    return work();
}

}  // namespace crumple::python
