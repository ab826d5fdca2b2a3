#include "arrays.h"

#include "errors.h"
#include "gil.h"

#include <nanobind/stl/string.h>

#define NPY_NO_DEPRECATED_API NPY_1_22_API_VERSION
#define NPY_TARGET_VERSION NPY_1_22_API_VERSION
#include <numpy/arrayobject.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace nb = nanobind;

namespace crumple::python {
namespace {

using Number = BorrowedArray::Number;

Number number_of(PyArrayObject* array) {
    constexpr bool long_is_64 = sizeof(long) == 8;
    if (!PyArray_ISNOTSWAPPED(array)) return Number::other;
    switch (PyArray_TYPE(array)) {
        case NPY_FLOAT:
            return Number::float32;
        case NPY_DOUBLE:
            return Number::float64;
        case NPY_INT:
            return Number::int32;
        case NPY_UINT:
            return Number::uint32;
        case NPY_LONG:
            return long_is_64 ? Number::int64 : Number::int32;
        case NPY_ULONG:
            return long_is_64 ? Number::other : Number::uint32;
        case NPY_LONGLONG:
            return Number::int64;
        default:
            return Number::other;
    }
}

Number number_of(nb::dlpack::dtype type) {
    if (type == nb::dtype<float>()) return Number::float32;
    if (type == nb::dtype<double>()) return Number::float64;
    if (type == nb::dtype<std::int32_t>()) return Number::int32;
    if (type == nb::dtype<std::uint32_t>()) return Number::uint32;
    if (type == nb::dtype<std::int64_t>()) return Number::int64;
    return Number::other;
}

bool has_rows_of(std::int64_t columns, const BorrowedArray& array) {
    return array.dimensions == 2 && array.shape[1] == columns;
}

bool are_vertices(const BorrowedArray& a) {
    return has_rows_of(3, a) && (a.number == Number::float32 || a.number == Number::float64);
}

// True if a flat array of indices may be a list of triangles that are each preceded by the size 3, as VTK stores cells:
// (3, a, b, c, 3, d, e, f, ...). False for arrays in device memory, which are not read.
bool may_be_cells(const BorrowedArray& a) {
    if (a.device != BorrowedArray::on_host || a.shape[0] == 0 || a.shape[0] % 4 != 0) return false;
    const std::size_t size = a.number == Number::int64 ? sizeof(std::int64_t) : sizeof(std::int32_t);
    for (std::int64_t i = 0; i < a.shape[0]; i += 4) {
        std::int64_t index = 0;  // on big-endian machines int32 cells are not detected
        std::memcpy(&index, static_cast<const std::byte*>(a.data) + i * a.strides[0], size);
        if (index != 3) return false;
    }
    return true;
}

bool are_faces(const BorrowedArray& a) {
    const bool flat = a.dimensions == 1 && a.shape[0] % 3 == 0;
    const bool integers = a.number == Number::int32 || a.number == Number::uint32 || a.number == Number::int64;
    return integers && (flat ? !may_be_cells(a) : has_rows_of(3, a));
}

bool are_groups(const BorrowedArray& a) {
    constexpr std::int64_t size = sizeof(std::int32_t);
    return a.dimensions == 1 && a.number == Number::int32 && (a.shape[0] < 2 || a.strides[0] == size) &&
           reinterpret_cast<std::uintptr_t>(a.data) % size == 0;
}

bool are_radii(const BorrowedArray& a) {
    constexpr std::int64_t size = sizeof(double);
    return a.dimensions == 1 && a.number == Number::float64 && (a.shape[0] < 2 || a.strides[0] == size) &&
           reinterpret_cast<std::uintptr_t>(a.data) % size == 0;
}

bool are_ids(const BorrowedArray& a) {
    return a.dimensions == 1 && a.device == BorrowedArray::on_host && a.number == Number::int64 && is_contiguous(a) &&
           reinterpret_cast<std::uintptr_t>(a.data) % alignof(std::int64_t) == 0;
}

bool are_group_pairs(const BorrowedArray& a) {
    constexpr std::int64_t size = sizeof(std::int32_t);
    return has_rows_of(2, a) && a.device == BorrowedArray::on_host && a.number == Number::int32 &&
           a.strides[0] % size == 0 && a.strides[1] % size == 0 && reinterpret_cast<std::uintptr_t>(a.data) % size == 0;
}

// True for contiguous, aligned int32 rows of two, which the library reads in place as Edge.
bool are_edges(const BorrowedArray& a) {
    return has_rows_of(2, a) && a.number == Number::int32 && is_contiguous(a) &&
           reinterpret_cast<std::uintptr_t>(a.data) % alignof(Edge) == 0;
}

bool are_points(const BorrowedArray& a) {
    return a.dimensions == 1 && a.number == Number::int32 && is_contiguous(a) &&
           reinterpret_cast<std::uintptr_t>(a.data) % alignof(std::int32_t) == 0;
}

bool are_host_poses(const BorrowedArray& a) {
    if (a.dimensions != 3 && a.dimensions != 4) return false;
    const auto rows = static_cast<std::size_t>(a.dimensions) - 2;
    return a.device == BorrowedArray::on_host && (a.shape[rows] == 3 || a.shape[rows] == 4) && a.shape[rows + 1] == 4 &&
           (a.number == Number::float32 || a.number == Number::float64);
}

// True for any poses in host memory, and for contiguous (n, 3, 4) or (k, n, 3, 4) poses in device memory, where nothing
// can be converted.
bool are_poses(const BorrowedArray& a) {
    if (a.device == BorrowedArray::on_host) return are_host_poses(a);
    BorrowedArray there = a;
    there.device = BorrowedArray::on_host;
    const std::size_t size = a.number == Number::float32 ? sizeof(float) : sizeof(double);
    return are_host_poses(there) && a.shape[static_cast<std::size_t>(a.dimensions) - 2] == 3 && is_contiguous(a) &&
           reinterpret_cast<std::uintptr_t>(a.data) % size == 0;
}

bool borrow_numpy(nb::handle object, BorrowedArray& result) {
    if (!PyArray_Check(object.ptr())) return false;
    const auto array = reinterpret_cast<PyArrayObject*>(object.ptr());
    result.data = PyArray_DATA(array);
    result.number = number_of(array);
    result.dimensions = PyArray_NDIM(array) <= BorrowedArray::most_dimensions ? PyArray_NDIM(array) : 0;
    for (int i = 0; i < result.dimensions; ++i) {
        result.shape[static_cast<std::size_t>(i)] = PyArray_DIM(array, i);
        result.strides[static_cast<std::size_t>(i)] = PyArray_STRIDE(array, i);
    }
    return true;
}

// Array argument of a Python call.
struct Argument {
    const char* kind;        ///< name of the function of crumple/_arrays.py that converts such arrays
    const char* which;       ///< prefix of all messages about the array: "first mesh: " or empty
    void* stream = nullptr;  ///< CUDA stream on which an array in CUDA memory must be ready
};

// Returns DLPack's number for a CUDA stream: 1 for the legacy default stream (null), -1 for no_stream(), otherwise the
// address of the stream.
nb::int_ dlpack_stream(void* stream) {
    if (stream == no_stream()) return nb::int_(-1);
    constexpr std::uintptr_t legacy_default = 1;
    return nb::int_(stream ? reinterpret_cast<std::uintptr_t>(stream) : legacy_default);
}

// Calls __dlpack__ with keyword arguments. If it raises, returns null, and Python's error remains set.
nb::object call_dlpack(const nb::object& method, const nb::dict& named) {
    const nb::tuple none;
    return nb::steal(in_python([&] { return PyObject_Call(method.ptr(), none.ptr(), named.ptr()); }));
}

// Calls __dlpack__. If that raises BufferError, as for a read-only array, calls it again with max_version: only
// capsules of DLPack 1.0 can describe read-only arrays.
nb::object call_dlpack_of_any_version(const nb::object& method, nb::dict named) {
    nb::object capsule = call_dlpack(method, named);
    if (capsule || !PyErr_ExceptionMatches(PyExc_BufferError)) return capsule;
    nb::python_error first;
    named["max_version"] = nb::make_tuple(nb::dlpack::major_version, nb::dlpack::minor_version);
    capsule = call_dlpack(method, named);
    if (!capsule && PyErr_ExceptionMatches(PyExc_TypeError))
        first.restore();  // the package is older and has no parameter max_version
    return capsule;
}

// Returns the capsule that __dlpack__ makes; an array in CUDA memory is then ready on the stream of `argument`. If
// __dlpack__ raises, returns null for an array in host memory, which may be readable by other means, and raises an
// error for one in CUDA memory. nanobind is not used for the call: it would pass no stream, and not use in_python().
nb::object capsule_of(const nb::object& method, const Argument& argument, bool in_cuda_memory) {
    nb::dict named;
    if (in_cuda_memory) named["stream"] = dlpack_stream(argument.stream);
    nb::object capsule = call_dlpack_of_any_version(method, named);
    if (capsule) return capsule;
    const nb::python_error error;
    if (in_cuda_memory)
        call_python("crumple._arrays", "refuse_failed_dlpack",
                    {error.value(), named["stream"], nb::str(argument.kind), nb::str(argument.which)});
    return capsule;
}

bool lies_in_cuda_memory(nb::handle object) {
    return call_python("crumple._arrays", "lies_in_cuda_memory", {object}).is(Py_True);
}

// Borrows an array through DLPack, or returns false if that is not possible. `object` may also be a bare capsule, which
// has no __dlpack__: if its array is in CUDA memory, the Python caller must have synchronized it.
bool borrow_dlpack(nb::handle object, const Argument& argument, BorrowedArray& result, Kept& kept) {
    using Tensor = nb::ndarray<nb::ro>;
    Tensor tensor;
    const nb::object method = nb::steal(in_python([&] { return PyObject_GetAttrString(object.ptr(), "__dlpack__"); }));
    if (!method) PyErr_Clear();
    const bool in_cuda_memory = method && lies_in_cuda_memory(object);
    const nb::object capsule = method ? capsule_of(method, argument, in_cuda_memory) : nb::object();
    if (!nb::try_cast(capsule ? nb::handle(capsule) : object, tensor)) return false;
    switch (tensor.device_type()) {
        case nb::device::cpu::value:
        case nb::device::cuda_host::value:
            break;
        case nb::device::cuda::value:
        case nb::device::cuda_managed::value:
            if (method && !in_cuda_memory)
                call_python("crumple._arrays", "refuse_unannounced_cuda_memory",
                            {nb::str(argument.kind), nb::str(argument.which)});
            result.device = tensor.device_id();
            break;
        default:
            return false;
    }
    result.data = tensor.data();
    result.number = number_of(tensor.dtype());
    result.dimensions = tensor.ndim() <= BorrowedArray::most_dimensions ? static_cast<int>(tensor.ndim()) : 0;
    for (int i = 0; i < result.dimensions; ++i) {
        const auto k = static_cast<std::size_t>(i);
        result.shape[k] = static_cast<std::int64_t>(tensor.shape(k));
        result.strides[k] = tensor.stride(k) * static_cast<std::int64_t>(tensor.itemsize());
    }
    kept.push_back(
        nb::capsule(new Tensor(std::move(tensor)), [](void* p) noexcept { delete static_cast<Tensor*>(p); }));
    return true;
}

// Returns a view of the array `object` if `accepted` holds for it, otherwise of the array that crumple/_arrays.py makes
// from it. Adds to `kept` what keeps the array alive.
BorrowedArray borrow_array(nb::handle object, bool (*accepted)(const BorrowedArray&), const Argument& argument,
                           Kept& kept) {
    BorrowedArray array;
    import_numpy();
    if (!PyArray_CheckExact(object.ptr()) && PyArray_Check(object.ptr()))
        call_python("crumple._arrays", "refuse_masked", {object, nb::str(argument.kind), nb::str(argument.which)});
    if (borrow_numpy(object, array) || borrow_dlpack(object, argument, array, kept))
        if (accepted(array)) return array;
    const nb::object converted = call_python("crumple._arrays", argument.kind, {object, nb::str(argument.which)});
    kept.push_back(converted);
    array = BorrowedArray();
    if (borrow_numpy(converted, array) && accepted(array)) return array;
    throw std::logic_error(std::string("crumple._arrays.") + argument.kind + " gave an array of another kind");
}

std::string place(int device) {
    return device == BorrowedArray::on_host ? "host memory" : "the memory of CUDA device " + std::to_string(device);
}

void check_place(const BorrowedArray& array, const std::string& name, int device) {
    if (array.device != device) refuse(name + " lie in " + place(array.device) + ", but vertices in " + place(device));
}

// Returns a view of the rows of an (n, 3) array, or of a flat array as rows of three.
template <class Type>
ArrayView<Type> rows_of_three(const BorrowedArray& array, Type type) {
    if (array.dimensions == 1) return {array.data, array.shape[0] / 3, 3 * array.strides[0], array.strides[0], type};
    return {array.data, array.shape[0], array.strides[0], array.strides[1], type};
}

ScalarType scalar_type(const BorrowedArray& array) {
    return array.number == Number::float32 ? ScalarType::float32 : ScalarType::float64;
}

IndexType index_type(const BorrowedArray& array) {
    if (array.number == Number::int32) return IndexType::int32;
    return array.number == Number::uint32 ? IndexType::uint32 : IndexType::int64;
}

}  // namespace

void import_numpy() {
    if (in_python([] { return PyArray_ImportNumPyAPI(); }) != 0) throw nb::python_error();
}

BorrowedMesh::BorrowedMesh(const nb::tuple& mesh, const char* which, void* stream)
    : kept_{mesh},
      vertices_(borrow_array(mesh[0], are_vertices, {"vertices", which, stream}, kept_)),
      faces_(borrow_array(mesh[1], are_faces, {"faces", which, stream}, kept_)),
      view_(rows_of_three(vertices_, scalar_type(vertices_)), rows_of_three(faces_, index_type(faces_))) {
    view_.stream = stream;
    check_place(faces_, std::string(which) + "faces", device());
    if (device() != BorrowedArray::on_host) view_.memory = MemorySpace::cuda;
    if (mesh[2].is_none()) return;
    groups_ = borrow_array(mesh[2], are_groups, {"groups", which, stream}, kept_);
    check_place(groups_, std::string(which) + "groups", device());
    // To the library an empty span means no groups. So an empty array must not pass for a mesh with faces; for no
    // groups, the caller passes None.
    if (groups_.shape[0] != view_.triangles.rows)
        refuse(std::string(which) + "groups must be one for each of the " + std::to_string(view_.triangles.rows) +
               " faces, not " + std::to_string(groups_.shape[0]));
    view_.groups = {static_cast<const std::int32_t*>(groups_.data), static_cast<std::size_t>(groups_.shape[0])};
}

BorrowedEnd::BorrowedEnd(nb::handle end, const BorrowedMesh& mesh, const char* which, When when)
    : kept_{nb::borrow(end)} {
    const bool at_rest = when == When::rest;
    const BorrowedArray array =
        borrow_array(end, are_vertices, {at_rest ? "rest_vertices" : "end_vertices", which, mesh.view().stream}, kept_);
    check_place(array, std::string(which) + (at_rest ? "rest vertices" : "end vertices"), mesh.device());
    view_ = rows_of_three(array, scalar_type(array));
    const std::int64_t wanted = mesh.view().vertices.rows;
    if (view_.rows != wanted)
        refuse(std::string(which) + (at_rest ? "rest" : "end") + " vertices must be as many as those " +
               (at_rest ? "of the mesh, " : "at the start, ") + std::to_string(wanted) + ", not " +
               std::to_string(view_.rows));
}

BorrowedRadii::BorrowedRadii(nb::handle radii, const BorrowedMesh& mesh, const char* which) : kept_{nb::borrow(radii)} {
    const BorrowedArray array = borrow_array(radii, are_radii, {"radii", which, mesh.view().stream}, kept_);
    check_place(array, std::string(which) + "radii", mesh.device());
    const std::int64_t wanted = mesh.view().vertices.rows;
    if (array.shape[0] != wanted)
        refuse(std::string(which) + "radii must be one for each of the " + std::to_string(wanted) + " vertices, not " +
               std::to_string(array.shape[0]));
    view_ = {static_cast<const double*>(array.data), static_cast<std::size_t>(wanted)};
}

BorrowedLists::BorrowedLists(const nb::tuple& lists, int device, const char* which, void* stream) : kept_{lists} {
    if (!lists[0].is_none()) {
        const BorrowedArray edges = borrow_array(lists[0], are_edges, {"edges", which, stream}, kept_);
        check_place(edges, std::string(which) + "edges", device);
        edges_ = std::span(static_cast<const Edge*>(edges.data), static_cast<std::size_t>(edges.shape[0]));
    }
    if (!lists[1].is_none()) {
        const BorrowedArray points = borrow_array(lists[1], are_points, {"points", which, stream}, kept_);
        check_place(points, std::string(which) + "points", device);
        points_ = std::span(static_cast<const std::int32_t*>(points.data), static_cast<std::size_t>(points.shape[0]));
    }
}

BorrowedIds::BorrowedIds(nb::handle ids, const char* what, std::int64_t wanted) {
    if (ids.is_none()) return;
    kept_.push_back(nb::borrow(ids));
    const std::string name = std::string(what) + "_ids";
    const BorrowedArray array = borrow_array(ids, are_ids, {name.c_str(), ""}, kept_);
    if (array.shape[0] != wanted)
        refuse(name + " must be one for each of the " + std::to_string(wanted) +
               (name == "vertex_ids" ? " vertices, not "
                : name == "body_ids" ? " bodies, not "
                                     : " faces, not ") +
               std::to_string(array.shape[0]));
    view_ = {static_cast<const std::int64_t*>(array.data), static_cast<std::size_t>(wanted)};
}

BorrowedMeshes::BorrowedMeshes(const nb::tuple& one, const std::optional<nb::tuple>& other, void* stream)
    : first(one, other ? "first mesh: " : "", stream) {
    if (other) second.emplace(*other, "second mesh: ", stream);
}

BorrowedArray borrow_poses(nb::handle poses, const char* which, void* stream, Kept& kept) {
    kept.push_back(nb::borrow(poses));
    return borrow_array(poses, are_poses, {"poses", which, stream}, kept);
}

bool is_contiguous(const BorrowedArray& array) {
    const auto begin = array.shape.begin(), end = begin + array.dimensions;
    if (std::find(begin, end, 0) != end) return true;  // without elements, strides do not matter
    std::int64_t size = array.number == Number::float64 || array.number == Number::int64 ? 8 : 4;
    for (auto i = static_cast<std::size_t>(array.dimensions); i-- > 0; size *= array.shape[i])
        if (array.shape[i] != 1 && array.strides[i] != size) return false;
    return true;
}

std::vector<GroupPair> group_pairs(nb::handle pairs) {
    if (pairs.is_none()) return {};
    Kept kept;
    const BorrowedArray array = borrow_array(pairs, are_group_pairs, {"group_pairs", ""}, kept);
    std::vector<GroupPair> result;
    for (std::int64_t i = 0; i < array.shape[0]; ++i) {
        const auto* row = static_cast<const std::byte*>(array.data) + i * array.strides[0];
        const auto id = [&](std::int64_t k) {
            return *reinterpret_cast<const std::int32_t*>(row + k * array.strides[1]);
        };
        result.push_back({id(0), id(1)});
    }
    return result;
}

}  // namespace crumple::python
