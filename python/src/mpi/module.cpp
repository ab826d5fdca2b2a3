// crumple._mpi, the private extension module of crumple.mpi: a separate module, so that crumple._core does not need
// MPI. It uses types of crumple._core (World, Statistics), which is imported first: extension modules that use the same
// nanobind share their types.

#include <nanobind/nanobind.h>

#include "errors.h"
#include "gil.h"
#include "mpi/local_world.h"
#include "mpi/rank_detector.h"
#include "mpi/rank_results.h"
#include "signals.h"

NB_MODULE(_mpi, module) {
    module.doc() = "C++ library of crumple.mpi. Private.";
    nanobind::set_leak_warnings(false);  // daemon threads may hold objects at exit
    crumple::python::WithoutGil::watch_exit();
    crumple::python::set_main_thread();
    crumple::python::translate_errors();
    crumple::python::bind_rank_results(module);
    crumple::python::bind_local_world(module);
    crumple::python::bind_rank_detector(module);
}
