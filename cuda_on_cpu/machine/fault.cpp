// Explains segmentation faults in kernels on stderr. The signal handler neither allocates nor locks. It reads the lists
// of allocations without a lock, which is safe because the host waits while kernels run, so nothing changes them.

#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <memory>

#include "cuda_on_cpu/machine/block.h"
#include "cuda_on_cpu/machine/memory.h"
#include "cuda_on_cpu/machine/report.h"
#include "cuda_on_cpu/machine/sanitizers.h"

namespace cuda_on_cpu {
namespace {

void explain(int, siginfo_t* info, void*) {
    signal(SIGSEGV, SIG_DFL);  // after the handler the access is repeated, and ends the process
    const void* address = info->si_addr;
    char text[300], what[160], where[120] = "the host";
    const Block* block = Block::running();
    if (block) {
        const uint3 b = block->index(), t = block->thread();
        std::snprintf(where, sizeof where, "block (%u,%u,%u) thread (%u,%u,%u)", b.x, b.y, b.z, t.x, t.y, t.z);
    }
    if (block && block->in_stack_guard(address))
        std::snprintf(what, sizeof what, "overflows its stack");
    else if (block && block->in_shared_guard(address))
        std::snprintf(what, sizeof what, "accesses memory past the end of its %zu bytes of shared memory",
                      block->shared_bytes());
    else {
        char place[120];
        memory::describe(address, place, sizeof place);
        std::snprintf(what, sizeof what, "accesses %s", place);
    }
    const int n = std::snprintf(text, sizeof text, "cuda_on_cpu: %s %s (address %p)\n", where, what, address);
    if (n > 0 && write(STDERR_FILENO, text, std::strlen(text)) < 0) _exit(1);
}

}  // namespace

void explain_faults() {
    if (address_sanitizer || thread_sanitizer) return;
    // The handler needs a stack of its own, for the current one may have overflowed.
    constexpr std::size_t stack_bytes = 64 << 10;
    thread_local const std::unique_ptr<char[]> memory(new char[stack_bytes]);
    stack_t stack{};
    stack.ss_sp = memory.get();
    stack.ss_size = stack_bytes;
    sigaltstack(&stack, nullptr);
    struct sigaction action {};
    action.sa_sigaction = explain;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK;
    sigemptyset(&action.sa_mask);
    sigaction(SIGSEGV, &action, nullptr);
}

}  // namespace cuda_on_cpu
