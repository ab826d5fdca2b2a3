#pragma once

#include <array>

#include "crumple/crumple.h"

namespace crumple::fuzz {

/// The instruction sets asked for, or the best where this machine lacks it.
inline Simd present(Simd wanted) {
    static const auto there = [] {
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
    return there[static_cast<std::size_t>(wanted)] ? wanted : Simd::automatic;
}

}  // namespace crumple::fuzz
