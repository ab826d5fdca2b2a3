#pragma once

// Release and acquisition of the GIL, and calls of Python code, in threads that may outlive the interpreter.
//
// A daemon thread that waits for the GIL when the interpreter ends never gets it. CPython up to 3.13 unwinds the
// thread's stack (pthread_exit), which ends the process at the first noexcept function, and destroys Python objects
// without the GIL. From CPython 3.14 on the thread hangs instead. The functions of this file make it hang in all
// versions: in_python() does not let the unwinding pass.

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

/// Returns the result of `call`, which must call a single function of Python's C API that may run Python code or wait
/// for the GIL. If that function unwinds the stack instead of returning, this thread hangs. Objects that `call`
/// destroys must not need the GIL. Not inlined: inside a noexcept function, compilers omit the destructor that makes
/// the thread hang.
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

/// Calls a function of a Python module and returns its result. Call with the GIL.
nanobind::object call_python(const char* module, const char* function, std::initializer_list<nanobind::handle> given);

/// Acquires the GIL during its lifetime, in a thread that does not have it, such as a thread of the library.
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
    /// Wait of the process at exit for the work of this object. given_up: for at most a second. finished: until the
    /// work is complete, so that no temporary file is left. In both cases the process first requests `stop`.
    enum class AtExit : std::uint8_t { given_up, finished };

    explicit WithoutGil(AtExit at_exit = AtExit::given_up, std::stop_source stop = std::stop_source(std::nostopstate));
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

    /// False after the interpreter has ended, when the result of the work is of no use any more.
    bool wanted() const { return wanted_.load(std::memory_order_relaxed); }

    /// Makes the process wait at exit for all work in progress, as AtExit describes. Call once, when the extension
    /// module is imported.
    static void watch_exit();

   private:
    static void end_all();

    static WithoutGil* all_;  ///< list of all objects in existence; guarded by the GIL
    WithoutGil* next_;
    std::stop_source stop_;
    const AtExit at_exit_;
    std::atomic<bool> done_{false}, wanted_{true};
    PyThreadState* state_;
};

/// Runs work() without the GIL and returns its result. `stop`: its stop is requested at exit, so `work` should watch
/// it.
template <class Work>
auto without_gil(Work work, std::stop_source stop = std::stop_source(std::nostopstate)) {
    const WithoutGil released(WithoutGil::AtExit::given_up, std::move(stop));
    return work();
}

}  // namespace crumple::python
