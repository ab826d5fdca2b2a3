#pragma once

// Number of rounds of randomised tests.

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

/// True if CRUMPLE_ROUNDS is set, as by scripts/test_long.sh: tests then run all of their cases.
inline bool thorough() {
    static const bool is_set = std::getenv("CRUMPLE_ROUNDS") != nullptr;
    return is_set;
}

/// Returns `usual` times CRUMPLE_ROUNDS if that is set; otherwise `usual`, or a fifth of it under sanitizers, which are
/// slow.
inline int scaled_rounds(int usual) {
    static const char* const times = std::getenv("CRUMPLE_ROUNDS");
    if (times) return usual * std::max(1, std::atoi(times));
    return sanitized ? usual / 5 : usual;
}

}  // namespace crumple
