#pragma once

// The version has its one place here: CMakeLists.txt and pyproject.toml read these three numbers.
#define CRUMPLE_VERSION_MAJOR 0
#define CRUMPLE_VERSION_MINOR 2
#define CRUMPLE_VERSION_PATCH 0

#define CRUMPLE_TEXT_OF_(macro) CRUMPLE_TEXT_(macro)
#define CRUMPLE_TEXT_(text) #text

/// "major.minor.patch"
#define CRUMPLE_VERSION                     \
    CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_MAJOR) \
    "." CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_MINOR) "." CRUMPLE_TEXT_OF_(CRUMPLE_VERSION_PATCH)
