#pragma once

#include <array>

#include "crumple/crumple.h"

namespace crumple::fuzz {

/// Returns the requested instruction set, or `automatic` if this machine lacks it.
inline Simd present(Simd requested) {
    static const auto available = [] {
        std::array<bool, 6> result{};
        for (std::size_t i = 0; i < result.size(); ++i) {
            try {
                Options options;
                options.backend = Backend::cpu;
                options.threads = 1;
                options.simd = static_cast<Simd>(i);
                const Detector detector(options);
                result[i] = true;
            } catch (const Error&) {
            }
        }
        return result;
    }();
    return available[static_cast<std::size_t>(requested)] ? requested : Simd::automatic;
}

}  // namespace crumple::fuzz
