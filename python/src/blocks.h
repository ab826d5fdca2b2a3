#pragma once

// Answers in blocks on their way out: each becomes an answer of Python's, which outlives the call.

#include <memory>
#include <utility>

#include <nanobind/nanobind.h>

#include "arguments.h"
#include "detector.h"
#include "gil.h"

namespace crumple::python {

/// Calls `take` with make(copy of the block) for each Block of stream(detector, sink, stop). In a turn of one's own,
/// with the GIL.
template <class Block, class Make, class Stream>
Statistics hand_over_blocks(SharedDetector& detector, nanobind::handle take, Make make, Stream stream) {
    const auto hand_over = [&](const Block& block) {
        const nanobind::object answer = nanobind::cast(make(std::make_shared<Block>(block)), nanobind::rv_policy::move);
        PyObject* const done =
            in_python([&] { return PyObject_CallFunctionObjArgs(take.ptr(), answer.ptr(), nullptr); });
        if (!done) throw nanobind::python_error();
        Py_DECREF(done);
    };
    return without_gil([&] { return detector.stream<Block>(hand_over, stream); }, detector.stop());
}

}  // namespace crumple::python
