#pragma once

// The library's arrays as NumPy's, without a copy.

#include <cstddef>

#include <nanobind/ndarray.h>

#include "arrays.h"
#include "crumple/array.h"

namespace crumple::python {

/// A read-only NumPy view of an array, with as many columns as its elements have. The property that returns it names
/// its owner.
template <class Number, class Element, class... Columns>
nanobind::ndarray<nanobind::numpy, const Number> view(const Array<Element>& array, Columns... columns) {
    import_numpy();
    const void* const data = array.data();
    return {static_cast<const Number*>(data), {array.size(), std::size_t{columns}...}};
}

}  // namespace crumple::python
