#pragma once

// How often tests of random numbers draw.

#include <algorithm>
#include <cstdlib>

namespace crumple {

/// Some times the usual number of rounds, by CRUMPLE_ROUNDS; a fifth under sanitizers, which are slow.
inline int more_or_less(int usual) {
    static const char* const times = std::getenv("CRUMPLE_ROUNDS");
    if (times) return usual * std::max(1, std::atoi(times));
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return usual / 5;
#else
    return usual;
#endif
}

}  // namespace crumple
