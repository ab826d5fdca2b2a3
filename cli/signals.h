#pragma once

// Handling of Ctrl-C and kill.

#include <csignal>

namespace crumple::cli {

/// Makes the process remove its unfinished files when SIGINT, SIGTERM, SIGHUP or SIGQUIT ends it.
void clean_up_when_killed();

/// Makes the first Ctrl-C set `stop`, and the second one end the process.
void stop_at_first_interrupt(volatile std::sig_atomic_t& stop);

}  // namespace crumple::cli
