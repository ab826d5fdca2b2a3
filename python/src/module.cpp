// crumple._core, the library behind the Python package. Private: crumple/*.py is what people see.

#include <nanobind/nanobind.h>

#include "crumple/version.h"
#include "detector.h"
#include "errors.h"
#include "files.h"
#include "part.h"
#include "result.h"

NB_MODULE(_core, module) {
    module.doc() = "The C++ library behind crumple. Private.";
    module.attr("__version__") = CRUMPLE_VERSION;
    crumple::python::translate_errors();
    crumple::python::bind_result(module);
    crumple::python::bind_part(module);
    crumple::python::bind_detector(module);
    crumple::python::bind_files(module);
}
