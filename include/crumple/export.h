#pragma once

/// Marks symbols that a shared library exports; all others are hidden. Empty for static libraries, so that a binary
/// that links one (a Python module, say) does not export them. The targets crumple::crumple, crumple::io and
/// crumple::mpi define CRUMPLE_SHARED.
#if defined(CRUMPLE_SHARED)
#define CRUMPLE_API __attribute__((visibility("default")))
#else
#define CRUMPLE_API
#endif
