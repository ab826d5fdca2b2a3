#include "files.h"

#include <cstring>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "arrays.h"
#include "crumple/io.h"
#include "names.h"
#include "result.h"
#include "scenes/scenes.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using Path = std::filesystem::path;

// (vertices, faces, groups or None): NumPy arrays over the mesh's own memory, which they share.
nb::tuple give(io::TriangleMesh&& mesh) {
    const auto shared = new io::TriangleMesh(std::move(mesh));
    const nb::capsule owner(shared, [](void* p) noexcept { delete static_cast<io::TriangleMesh*>(p); });
    const auto vertex_count = static_cast<std::size_t>(shared->vertex_count());
    const auto triangle_count = static_cast<std::size_t>(shared->triangle_count());
    const nb::object vertices = std::visit(
        [&](auto& values) {
            using Scalar = typename std::decay_t<decltype(values)>::value_type;
            return nb::cast(nb::ndarray<nb::numpy, Scalar>(values.data(), {vertex_count, 3}, owner));
        },
        shared->vertices);
    nb::object groups = nb::none();
    if (!shared->groups.empty())
        groups = nb::cast(nb::ndarray<nb::numpy, std::int32_t>(shared->groups.data(), {triangle_count}, owner));
    return nb::make_tuple(
        vertices, nb::ndarray<nb::numpy, std::int32_t>(shared->triangles.data(), {triangle_count, 3}, owner), groups);
}

template <class To, class From, class Type>
std::vector<To> rows(const ArrayView<Type>& view) {
    std::vector<To> values;
    values.reserve(static_cast<std::size_t>(3 * view.rows));
    for (std::int64_t i = 0; i < view.rows; ++i) {
        const std::byte* row = static_cast<const std::byte*>(view.data) + i * view.row_stride;
        for (int k = 0; k < 3; ++k) {
            From value;
            std::memcpy(&value, row + k * view.column_stride, sizeof value);
            // An index that does not fit is out of range, and stays so.
            if constexpr (std::is_integral_v<To>) value = std::in_range<To>(value) ? value : static_cast<From>(-1);
            values.push_back(static_cast<To>(value));
        }
    }
    return values;
}

// What the writers take: a copy, once a file.
io::TriangleMesh copy_of(const MeshView& view) {
    io::TriangleMesh mesh;
    if (view.vertices.type == ScalarType::float32) {
        mesh.vertices = rows<float, float>(view.vertices);
    } else {
        mesh.vertices = rows<double, double>(view.vertices);
    }
    switch (view.triangles.type) {
        case IndexType::int32:
            mesh.triangles = rows<std::int32_t, std::int32_t>(view.triangles);
            break;
        case IndexType::uint32:
            mesh.triangles = rows<std::int32_t, std::uint32_t>(view.triangles);
            break;
        case IndexType::int64:
            mesh.triangles = rows<std::int32_t, std::int64_t>(view.triangles);
            break;
    }
    mesh.groups.assign(view.groups.begin(), view.groups.end());
    return mesh;
}

}  // namespace

void bind_files(nb::module_& module) {
    module.def(
        "read_mesh",
        [](const Path& path, std::string_view precision, std::string_view weld, const std::string& group_property) {
            const io::ReadOptions options{named(precision_names, "precision", precision),
                                          named(weld_names, "weld", weld), group_property};
            io::TriangleMesh mesh;
            {
                const nb::gil_scoped_release released;
                mesh = io::read_mesh(path, options);
            }
            return give(std::move(mesh));
        },
        "path"_a, "precision"_a, "weld"_a, "group_property"_a);
    module.def(
        "write_mesh",
        [](const Path& path, nb::handle mesh) {
            const BorrowedMesh borrowed(mesh, "");
            const nb::gil_scoped_release released;
            io::write_mesh(path, copy_of(borrowed.view()));
        },
        "path"_a, "mesh"_a);
    module.def(
        "write_coloured",
        [](const Path& path, nb::handle first, nb::handle second, const Result& result) {
            const BorrowedMesh a(first, "");
            std::optional<BorrowedMesh> b;
            if (!second.is_none()) b.emplace(second, "");
            const nb::gil_scoped_release released;
            std::optional<io::TriangleMesh> copy;
            if (b) copy = copy_of(b->view());
            io::write_coloured(path, copy_of(a.view()), copy ? &*copy : nullptr, result.collisions);
        },
        "path"_a, "first"_a, "second"_a.none(), "result"_a);
    module.def(
        "write_pairs",
        [](const Path& path, const Result& result) {
            const nb::gil_scoped_release released;
            io::write_pairs(path, result.collisions);
        },
        "path"_a, "result"_a);
    module.def(
        "read_pairs",
        [](const Path& path) {
            const auto pairs = new std::vector<Pair>;
            const nb::capsule owner(pairs, [](void* p) noexcept { delete static_cast<std::vector<Pair>*>(p); });
            {
                const nb::gil_scoped_release released;
                *pairs = io::read_pairs(path);
            }
            return nb::ndarray<nb::numpy, std::int32_t>(pairs->data(), {pairs->size(), 2}, owner);
        },
        "path"_a);
    module.def(
        "make_scene",
        [](const std::string& name, std::int64_t triangles, int frame, std::uint64_t seed) {
            io::TriangleMesh mesh;
            {
                const nb::gil_scoped_release released;
                mesh = scenes::make(name, {triangles, frame, seed});
            }
            return give(std::move(mesh));
        },
        "name"_a, "triangles"_a, "frame"_a, "seed"_a);
    module.def("scenes", [] {
        nb::list list;
        for (const scenes::Description& d : scenes::descriptions())
            list.append(nb::make_tuple(d.name, d.summary, d.triangles, d.frames));
        return list;
    });
}

}  // namespace crumple::python
