#pragma once

// Ctrl-C, and what else Python has handlers for, while the library works.

namespace crumple::python {

/// Which thread is Python's main thread. Call once, at the module's start.
void know_main_thread();

/// Runs Python's signal handlers, which is for the main thread alone: others return at once. Call with the GIL or
/// without. Throws what a handler raises.
void handle_signals();

}  // namespace crumple::python
