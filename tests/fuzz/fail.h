#pragma once

// Reports broken promises of a fuzz target: prints a sentence and aborts, which libFuzzer turns into an artefact.

#include <cstdio>
#include <cstdlib>
#include <string>

namespace crumple::fuzz {

/// Prints the input under test before the process ends; may be null.
inline void (*on_failure)() = nullptr;

[[noreturn]] inline void fail(const std::string& what) {
    std::fprintf(stderr, "\nBroken promise: %s\n", what.c_str());
    if (on_failure) on_failure();
    std::abort();
}

inline void require(bool holds, const char* what) {
    if (!holds) fail(what);
}

}  // namespace crumple::fuzz
