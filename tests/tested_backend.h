#pragma once

// Backend under test. If the build can emulate a device on the CPU ("play" it), an executable runs twice: with the cpu
// backend, and, with CRUMPLE_TESTED_BACKEND=played in the environment, with the cuda backend on the emulated device.
// Builds for machines with a device define CRUMPLE_TESTED_BACKEND as cuda.

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/options.h"

#ifndef CRUMPLE_TESTED_BACKEND
#define CRUMPLE_TESTED_BACKEND cpu
#endif

namespace crumple::test {

/// True if the CPU emulates the device, which makes everything some hundred times as slow.
inline const bool played = [] {
    const char* const tested = std::getenv("CRUMPLE_TESTED_BACKEND");
    return tested && tested == std::string_view("played");
}();
inline const Backend tested_backend = played ? Backend::cuda : Backend::CRUMPLE_TESTED_BACKEND;
/// The reference backend (brute force) and the tested backend. On an emulated device, only the tested one, since the
/// run with the cpu backend includes the reference.
inline const std::vector<Backend> tested_backends =
    played ? std::vector{Backend::cuda} : std::vector{Backend::reference, tested_backend};

inline std::string_view backend_name(Backend backend) {
    return backend == Backend::reference ? "reference" : backend == Backend::cuda ? "cuda" : "cpu";
}

/// Names parameters that are backends.
inline const auto name_of_backend = [](const auto& info) { return std::string(backend_name(info.param)); };

}  // namespace crumple::test
