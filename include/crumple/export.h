#pragma once

/// What a shared library shows of itself; all else is hidden. Empty in static libraries, so that what contains one (a
/// Python module, say) does not show it. CRUMPLE_SHARED comes with the targets crumple::crumple, crumple::io and
/// crumple::mpi.
#if defined(CRUMPLE_SHARED)
#define CRUMPLE_API __attribute__((visibility("default")))
#else
#define CRUMPLE_API
#endif
