#pragma once

// Effects of Ctrl-C and kill.

#include <csignal>

namespace crumple::cli {

/// From now on a process that is interrupted, told to end, or has lost its terminal removes its unfinished files first.
void clean_up_when_killed();

/// The first Ctrl-C sets `stop`, the second one ends the process.
void stop_at_first_interrupt(volatile std::sig_atomic_t& stop);

}  // namespace crumple::cli
