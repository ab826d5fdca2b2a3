#include "cuda_on_cpu/machine/report.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include "cuda_on_cpu/machine/block.h"

namespace cuda_on_cpu {
namespace {

[[noreturn]] void end(const char* where, const char* format, std::va_list arguments) {
    std::fputs("cuda_on_cpu: ", stderr);
    std::fputs(where, stderr);
    std::vfprintf(stderr, format, arguments);
    std::fputc('\n', stderr);
    std::fflush(stderr);
    std::abort();
}

}  // namespace

void fail(const char* format, ...) {
    std::va_list arguments;
    va_start(arguments, format);
    end("", format, arguments);
}

void fail_in_kernel(const char* format, ...) {
    char where[120] = "";
    if (const Block* block = Block::running()) {
        const uint3 b = block->index(), t = block->thread();
        std::snprintf(where, sizeof where, "block (%u,%u,%u) thread (%u,%u,%u): ", b.x, b.y, b.z, t.x, t.y, t.z);
    }
    std::va_list arguments;
    va_start(arguments, format);
    end(where, format, arguments);
}

}  // namespace cuda_on_cpu
