#pragma once

// Bindings of results that Python owns: members as values, and arrays as NumPy views.

#include <cstdint>
#include <string>
#include <utility>

#include <nanobind/nanobind.h>

#include "crumple/impacts.h"
#include "crumple/proximities.h"
#include "views.h"

namespace crumple::python {

/// Binding of a class `Held`, whose member found() returns the result: binds members of this result as properties.
template <class Held>
class SharedBinding {
   public:
    using Result = std::remove_cvref_t<decltype(std::declval<Held>().found())>;

    SharedBinding(nanobind::module_& module, const char* name, const char* description)
        : type_(module, name, description) {}
    template <class Get>
    void value(const std::string& name, Get get) {
        type_.def_prop_ro(name.c_str(), [get](const Held& held) { return get(held.found()); });
    }
    /// Binds an array as a property. array_of(result) returns the array. `columns`: number of scalars of type Number in
    /// each element, if there are several.
    template <class Number, class ArrayOf, class... Columns>
    void array(const std::string& name, ArrayOf array_of, Columns... columns) {
        const auto show = [=](const Held& held) { return view<Number>(array_of(held.found()), columns...); };
        type_.def_prop_ro(name.c_str(), show, nanobind::rv_policy::reference_internal);
    }
    nanobind::class_<Held>& type() { return type_; }

   private:
    nanobind::class_<Held> type_;
};

inline const Array<double>& values(const ImpactList& list) { return list.toi; }
inline const Array<double>& values(const ProximityList& list) { return list.squared_distance; }
inline const Array<std::uint8_t>& flags(const ImpactList& list) { return list.start; }
inline const Array<std::uint8_t>& flags(const ProximityList& list) { return list.touching; }

/// Returns a dict with the milliseconds of each stage or phase, by its name.
template <class Part, class Statistics, class NameOf>
nanobind::typed<nanobind::dict, nanobind::str, double> milliseconds_by_name(const Statistics& statistics, int count,
                                                                            NameOf name_of) {
    nanobind::typed<nanobind::dict, nanobind::str, double> result;
    for (int i = 0; i < count; ++i) {
        const std::string_view name = name_of(static_cast<Part>(i));
        result[nanobind::str(name.data(), name.size())] = statistics[static_cast<Part>(i)];
    }
    return result;
}

}  // namespace crumple::python
