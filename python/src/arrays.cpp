#include "arrays.h"

#include <nanobind/stl/string.h>

#include <stdexcept>

namespace nb = nanobind;

namespace crumple::python {
namespace {

bool on_host(const AnyArray& array) {
    return array.device_type() == nb::device::cpu::value || array.device_type() == nb::device::cuda_host::value;
}

bool has_rows_of(std::size_t columns, const AnyArray& array) { return array.ndim() == 2 && array.shape(1) == columns; }

template <class... Types>
bool holds_one_of(const AnyArray& array) {
    return ((array.dtype() == nb::dtype<Types>()) || ...);
}

bool are_vertices(const AnyArray& array) {
    return on_host(array) && has_rows_of(3, array) && holds_one_of<float, double>(array);
}

bool are_faces(const AnyArray& array) {
    return on_host(array) && has_rows_of(3, array) && holds_one_of<std::int32_t, std::uint32_t, std::int64_t>(array);
}

bool are_groups(const AnyArray& array) {
    return on_host(array) && array.ndim() == 1 && holds_one_of<std::int32_t>(array) &&
           (array.shape(0) < 2 || array.stride(0) == 1);
}

bool are_group_pairs(const AnyArray& array) {
    return on_host(array) && has_rows_of(2, array) && holds_one_of<std::int32_t>(array);
}

AnyArray import_array(nb::handle object, bool (*accepted)(const AnyArray&), const char* converter,
                      const std::string& which) {
    AnyArray array;
    if (nb::try_cast(object, array) && accepted(array)) return array;
    const nb::object converted = nb::module_::import_("crumple._arrays").attr(converter)(object, which);
    if (nb::try_cast(converted, array) && accepted(array)) return array;
    throw std::logic_error(std::string("crumple._arrays.") + converter + " gave an array of another kind");
}

template <class Type>
ArrayView<Type> rows_of_three(const AnyArray& array, Type type) {
    const auto size = static_cast<std::int64_t>(array.itemsize());
    return {array.data(), static_cast<std::int64_t>(array.shape(0)), array.stride(0) * size, array.stride(1) * size,
            type};
}

ScalarType scalar_type(const AnyArray& array) {
    return holds_one_of<float>(array) ? ScalarType::float32 : ScalarType::float64;
}

IndexType index_type(const AnyArray& array) {
    if (holds_one_of<std::int32_t>(array)) return IndexType::int32;
    return holds_one_of<std::uint32_t>(array) ? IndexType::uint32 : IndexType::int64;
}

}  // namespace

BorrowedMesh::BorrowedMesh(nb::handle mesh, const std::string& which)
    : vertices_(import_array(mesh[0], are_vertices, "vertices", which)),
      faces_(import_array(mesh[1], are_faces, "faces", which)),
      view_(rows_of_three(vertices_, scalar_type(vertices_)), rows_of_three(faces_, index_type(faces_))) {
    const nb::object groups = mesh[2];
    if (groups.is_none()) return;
    groups_ = import_array(groups, are_groups, "groups", which);
    view_.groups = {static_cast<const std::int32_t*>(groups_.data()), groups_.shape(0)};
}

std::vector<GroupPair> group_pairs(nb::handle pairs) {
    if (pairs.is_none()) return {};
    const AnyArray array = import_array(pairs, are_group_pairs, "group_pairs", "");
    const auto* data = static_cast<const std::int32_t*>(array.data());
    std::vector<GroupPair> result;
    for (std::size_t i = 0; i < array.shape(0); ++i) {
        const std::int32_t* row = data + static_cast<std::int64_t>(i) * array.stride(0);
        result.push_back({row[0], row[array.stride(1)]});
    }
    return result;
}

}  // namespace crumple::python
