#pragma once

// Backend under test. An executable runs twice where the CPU can play a device: on the cpu backend, and, with
// CRUMPLE_TESTED_BACKEND=played in the environment, on the cuda backend. Builds for machines with a device define
// CRUMPLE_TESTED_BACKEND as cuda.

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/options.h"

#ifndef CRUMPLE_TESTED_BACKEND
#define CRUMPLE_TESTED_BACKEND cpu
#endif

namespace crumple::test {

/// True if the CPU plays the device, on which everything takes some hundred times as long.
inline const bool played = [] {
    const char* const tested = std::getenv("CRUMPLE_TESTED_BACKEND");
    return tested && tested == std::string_view("played");
}();
inline const Backend tested_backend = played ? Backend::cuda : Backend::CRUMPLE_TESTED_BACKEND;
/// The reference backend (brute force) and the tested one. If the CPU plays a device, only the tested one: the run on
/// the cpu backend covers brute force.
inline const std::vector<Backend> tested_backends =
    played ? std::vector{Backend::cuda} : std::vector{Backend::reference, tested_backend};

inline std::string_view backend_name(Backend backend) {
    return backend == Backend::reference ? "reference" : backend == Backend::cuda ? "cuda" : "cpu";
}

/// Names parameters that are backends.
inline const auto name_of_backend = [](const auto& info) { return std::string(backend_name(info.param)); };

}  // namespace crumple::test
