#pragma once

// How often tests of random numbers draw.

#include <algorithm>
#include <cstdlib>

namespace crumple {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // g++
inline constexpr bool sanitized = true;
#elif defined(__has_feature)  // clang++
inline constexpr bool sanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool sanitized = false;
#endif

/// Whether tests should do all they can, as scripts/test_long.sh wants.
inline bool thorough() {
    static const bool asked = std::getenv("CRUMPLE_ROUNDS") != nullptr;
    return asked;
}

/// Some times the usual number of rounds, by CRUMPLE_ROUNDS; a fifth under sanitizers, which are slow.
inline int more_or_less(int usual) {
    static const char* const times = std::getenv("CRUMPLE_ROUNDS");
    if (times) return usual * std::max(1, std::atoi(times));
    return sanitized ? usual / 5 : usual;
}

}  // namespace crumple
