#include "cli/signals.h"

#include "io/bytes/unfinished_files.h"

namespace crumple::cli {
namespace {

volatile std::sig_atomic_t* flag = nullptr;

extern "C" void die(int signal) {
    io::remove_unfinished_files();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

extern "C" void stop_first(int signal) {
    *flag = 1;
    std::signal(signal, die);
}

/// Sets a handler, unless the process was started with this signal ignored, as nohup does.
void handle(int signal, void (*handler)(int)) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) return;
    struct sigaction action {};
    action.sa_handler = handler;
    sigaction(signal, &action, nullptr);
}

}  // namespace

void clean_up_when_killed() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) handle(signal, die);
    std::signal(SIGXFSZ, SIG_IGN);  // writing beyond the limit on file sizes then fails with EFBIG instead
}

void stop_at_first_interrupt(volatile std::sig_atomic_t& stop) {
    flag = &stop;
    handle(SIGINT, stop_first);
}

}  // namespace crumple::cli
