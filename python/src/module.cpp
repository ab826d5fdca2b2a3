// crumple._core, the private extension module of the Python package. crumple/*.py is public.

#include <nanobind/nanobind.h>

#include "checks.h"
#include "crumple/version.h"
#include "detector.h"
#include "errors.h"
#include "feature_files.h"
#include "feature_pairs.h"
#include "files.h"
#include "gil.h"
#include "part.h"
#include "pickling.h"
#include "results.h"
#include "signals.h"
#include "stencils.h"
#include "world.h"
#include "world_files.h"

NB_MODULE(_core, module) {
    module.doc() = "C++ library of crumple. Private.";
    module.attr("__version__") = CRUMPLE_VERSION;
    nanobind::set_leak_warnings(false);  // daemon threads may hold objects at exit
    crumple::python::WithoutGil::watch_exit();
    crumple::python::set_main_thread();
    crumple::python::translate_errors();
    crumple::python::bind_results(module);
    crumple::python::bind_pickling(module);
    crumple::python::bind_part(module);
    crumple::python::bind_world(module);
    crumple::python::bind_detector(module);
    crumple::python::bind_files(module);
    crumple::python::bind_world_files(module);
    crumple::python::bind_feature_files(module);
    crumple::python::bind_feature_pairs(module);
    crumple::python::bind_stencils(module);
    crumple::python::bind_checks(module);
}
