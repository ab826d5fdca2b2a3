#include "part_features.h"

#include <array>
#include <cstring>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "arrays.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

/// Calls visit(name, member) for each member of a PartFeatures.
template <class Features, class Visit>
void for_each_member(Features& f, Visit visit) {
    visit("moving", f.moving);
    visit("distance", f.distance);
    visit("share", f.share);
    visit("weld", f.weld);
    visit("end", f.end);
    visit("radii", f.radii);
    visit("rest", f.rest);
    visit("faces", f.faces);
    visit("vertices", f.vertices);
    visit("edges", f.edges);
    visit("edge_ends", f.edge_ends);
    visit("owned", f.owned);
    visit("edges_of", f.edges_of);
    visit("names", f.names);
    visit("lists_points", f.lists_points);
    visit("points", f.points);
    visit("point_vertices", f.point_vertices);
    visit("points_of", f.points_of);
    visit("of_no_face", f.of_no_face);
    visit("joined", f.joined);
    visit("rings", f.rings);
    visit("first_ring", f.first_ring);
    visit("ring", f.ring);
}

[[noreturn]] void refuse_state(const char* name) {
    throw InvalidType(std::string("the state of a Part's features needs ") + name + " as __getstate__ returns it");
}

// Scalar type of the numbers that an element consists of.
template <class T>
struct NumberOf {
    using type = T;
};
template <>
struct NumberOf<Edge> {
    using type = std::int32_t;
};
template <>
struct NumberOf<std::array<std::int32_t, 3>> {
    using type = std::int32_t;
};

template <class T>
nb::object put(const std::vector<T>& values) {
    using Number = typename NumberOf<T>::type;
    import_numpy();
    const auto copy = new std::vector<T>(values);
    const nb::capsule owner(copy, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    const void* const data = copy->data();
    constexpr std::size_t columns = sizeof(T) / sizeof(Number);
    if constexpr (columns == 1)
        return nb::cast(nb::ndarray<nb::numpy, const Number>(static_cast<const Number*>(data), {copy->size()}, owner));
    else
        return nb::cast(
            nb::ndarray<nb::numpy, const Number>(static_cast<const Number*>(data), {copy->size(), columns}, owner));
}
template <class... Vectors>
nb::object put(const std::variant<Vectors...>& values) {
    return std::visit([](const auto& of_type) { return put(of_type); }, values);
}
inline nb::object put(bool value) { return nb::bool_(value); }
inline nb::object put(double value) { return nb::float_(value); }
inline nb::object put(std::int64_t value) { return nb::int_(value); }
inline nb::object put(std::int32_t value) { return nb::int_(value); }

template <class T>
void take(const char* name, nb::handle given, std::vector<T>& values) {
    using Number = typename NumberOf<T>::type;
    constexpr std::size_t columns = sizeof(T) / sizeof(Number);
    nb::ndarray<const Number, nb::c_contig, nb::device::cpu> array;
    if (!nb::try_cast(given, array, false) || array.ndim() != (columns == 1 ? 1 : 2) ||
        (columns > 1 && array.shape(1) != columns))
        refuse_state(name);
    values.resize(array.shape(0));
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), array.data(), values.size() * sizeof(T));
}
inline void take(const char* name, nb::handle given, std::variant<std::vector<float>, std::vector<double>>& values) {
    nb::ndarray<const float, nb::c_contig, nb::device::cpu> single;
    if (nb::try_cast(given, single, false))
        take(name, given, values.emplace<std::vector<float>>());
    else
        take(name, given, values.emplace<std::vector<double>>());
}
template <class Number>
requires std::is_arithmetic_v<Number>
void take(const char* name, nb::handle given, Number& value) {
    if (!nb::try_cast(given, value, false)) refuse_state(name);
}

}  // namespace

nb::dict state_of(const PartFeatures& features) {
    nb::dict state;
    for_each_member(features, [&](const char* name, const auto& member) { state[name] = put(member); });
    return state;
}

PartFeatures features_from(nb::handle given) {
    nb::dict state;
    if (!nb::try_cast(given, state, false)) throw InvalidType("the state of a Part's features must be a dict");
    PartFeatures features;
    for_each_member(features, [&](const char* name, auto& member) {
        if (!state.contains(name)) refuse_state(name);
        take(name, state[name], member);
    });
    return features;
}

}  // namespace crumple::python
