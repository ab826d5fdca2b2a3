#pragma once

// Single source of the version: CMakeLists.txt and pyproject.toml read these three numbers and the suffix, which is
// empty in a release and ".dev0" before it.
#define CRUMPLE_VERSION_MAJOR 0
#define CRUMPLE_VERSION_MINOR 4
#define CRUMPLE_VERSION_PATCH 0
#define CRUMPLE_VERSION_SUFFIX ".dev0"

#define CRUMPLE_TEXT_OF_(macro) CRUMPLE_TEXT_(macro)
#define CRUMPLE_TEXT_(text) #text

/// Version as a string literal: "major.minor.patch", followed by the suffix.
#define CRUMPLE_VERSION                     \
    CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_MAJOR) \
    "." CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_MINOR) "." CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_PATCH) CRUMPLE_VERSION_SUFFIX
