#include "signals.h"

#include <nanobind/nanobind.h>

namespace nb = nanobind;

namespace crumple::python {
namespace {

unsigned long main_thread = 0;

}  // namespace

void set_main_thread() {
    main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
}

void handle_signals() {
    if (PyThread_get_thread_ident() != main_thread) return;
    const nb::gil_scoped_acquire acquired;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

}  // namespace crumple::python
