#pragma once

// How a target reports a broken promise: a sentence, and the end, which libFuzzer turns into an artefact.

#include <cstdio>
#include <cstdlib>
#include <string>

namespace crumple::fuzz {

/// Tells more of the input that is being judged; may be null.
inline void (*tell_more)() = nullptr;

[[noreturn]] inline void fail(const std::string& what) {
    std::fprintf(stderr, "\nBroken promise: %s\n", what.c_str());
    if (tell_more) tell_more();
    std::abort();
}

inline void require(bool holds, const char* what) {
    if (!holds) fail(what);
}

}  // namespace crumple::fuzz
