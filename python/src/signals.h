#pragma once

// Python's signal handlers, such as that of Ctrl-C, during calls of the library.

namespace crumple::python {

/// Stores the id of Python's main thread. Call once, when the module is initialised.
void set_main_thread();

/// Runs Python's signal handlers if called in the main thread, else returns at once. Call with or without the GIL.
/// Throws the exceptions of handlers.
void handle_signals();

}  // namespace crumple::python
