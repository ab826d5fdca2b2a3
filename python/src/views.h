#pragma once

// NumPy views of the library's arrays, and first impacts as tuples.

#include <cstddef>
#include <string_view>
#include <utility>

#include <nanobind/ndarray.h>

#include "arrays.h"
#include "crumple/array.h"
#include "crumple/impacts.h"

namespace crumple::python {

/// Returns a read-only NumPy view of an array. `columns`: number of scalars of type Number in each element, if there
/// are several. The property that returns the view sets its owner, so the view itself keeps nothing alive.
template <class Number, class Element, class... Columns>
nanobind::ndarray<nanobind::numpy, const Number> view(const Array<Element>& array, Columns... columns) {
    import_numpy();
    const void* const data = array.data();
    return {static_cast<const Number*>(data), {array.size(), std::size_t{columns}...}};
}

/// Returns a NumPy array that owns the values, which are moved, not copied. `columns`: as for view().
template <class Number, class Element, class... Columns>
nanobind::object moved_to_numpy(Array<Element> array, Columns... columns) {
    namespace nb = nanobind;
    import_numpy();
    const auto given = new Array<Element>(std::move(array));
    const nb::capsule owner(given, [](void* p) noexcept { delete static_cast<Array<Element>*>(p); });
    void* const data = given->data();
    return nb::cast(
        nb::ndarray<nb::numpy, Number>(static_cast<Number*>(data), {given->size(), std::size_t{columns}...}, owner));
}

/// Returns a tuple of the members of crumple.FirstImpact, or None if there is no impact.
inline nanobind::object tuple_of(const FirstImpact& first) {
    namespace nb = nanobind;
    if (!first.found) return nb::none();
    const std::string_view kind = feature_kind_name(first.kind);
    return nb::make_tuple(nb::str(kind.data(), kind.size()), nb::make_tuple(first.pair.a, first.pair.b),
                          nb::make_tuple(first.bodies.first, first.bodies.second), first.toi, first.start);
}

}  // namespace crumple::python
