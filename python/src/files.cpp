#include "files.h"

#include <array>
#include <cstring>
#include <optional>
#include <system_error>
#include <type_traits>
#include <utility>
#include <variant>

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "arguments.h"
#include "arrays.h"
#include "crumple/io.h"
#include "crumple/open_edges.h"
#include "detector.h"
#include "gil.h"
#include "io/meshes/triangulate.h"
#include "names.h"
#include "results.h"
#include "scenes/scenes.h"
#include "signals.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {

using Path = std::filesystem::path;

nb::tuple to_numpy(io::TriangleMesh&& mesh) {
    import_numpy();
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
    nb::object polygons = nb::none();
    if (!shared->polygons.empty()) {
        auto& [of_triangle, offsets, corners] = shared->polygons;
        polygons = nb::make_tuple(nb::ndarray<nb::numpy, std::int32_t>(of_triangle.data(), {triangle_count}, owner),
                                  nb::ndarray<nb::numpy, std::int64_t>(offsets.data(), {offsets.size()}, owner),
                                  nb::ndarray<nb::numpy, std::int32_t>(corners.data(), {corners.size()}, owner));
    }
    return nb::make_tuple(vertices,
                          nb::ndarray<nb::numpy, std::int32_t>(shared->triangles.data(), {triangle_count, 3}, owner),
                          groups, polygons);
}

namespace {

template <class To, class From, class Type>
std::vector<To> rows(const ArrayView<Type>& view) {
    std::vector<To> values;
    values.reserve(static_cast<std::size_t>(3 * view.rows));
    for (std::int64_t i = 0; i < view.rows; ++i) {
        const std::byte* row = static_cast<const std::byte*>(view.data) + i * view.row_stride;
        for (int k = 0; k < 3; ++k) {
            From value;
            std::memcpy(&value, row + k * view.column_stride, sizeof value);
            // An index that does not fit in int32 becomes -1, so that it remains out of range.
            if constexpr (std::is_integral_v<To>) value = std::in_range<To>(value) ? value : static_cast<From>(-1);
            values.push_back(static_cast<To>(value));
        }
    }
    return values;
}

}  // namespace

io::Unit unit_of(nb::handle unit) { return unit.is_none() ? io::Unit::unknown : named(unit_names, "unit", unit); }

io::ReadOptions read_options(nb::handle precision, nb::handle weld, nb::handle triangulation, nb::handle strict,
                             nb::handle unit) {
    io::ReadOptions options;
    options.precision = named(precision_names, "precision", precision);
    options.weld = named(weld_names, "weld", weld);
    options.triangulation = named(triangulation_names, "triangulation", triangulation);
    options.strict = flag("strict", strict);
    options.unit = unit_of(unit);
    return options;
}

nb::object name_of_unit(io::Unit unit) {
    return unit == io::Unit::unknown ? nb::none() : nb::object(nb::str(io::name_of(unit)));
}

io::TriangleMesh copy_of(const MeshView& view) {
    if (view.memory != MemorySpace::host)
        refuse(std::string("vertices lie in CUDA memory, but must be in host memory: ") + copy_to_host);
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

namespace {

// Returns the units of one or two meshes; Unit::unknown if a mesh has no unit, as only meshes from files have one.
std::pair<io::Unit, io::Unit> units_of(const nb::tuple& first, const std::optional<nb::tuple>& second) {
    const auto unit = [](nb::handle mesh) { return unit_of(nb::getattr(mesh, "unit", nb::none())); };
    return {unit(first), second ? unit(*second) : io::Unit::unknown};
}

// Copies of the meshes of a result, for writers of pictures.
struct CopiedMeshes {
    CopiedMeshes(const BorrowedMeshes& borrowed, std::pair<io::Unit, io::Unit> units)
        : first(copy_of(borrowed.first.view())) {
        first.unit = units.first;
        if (!borrowed.second) return;
        second = copy_of(borrowed.second->view());
        second->unit = units.second;
    }
    const io::TriangleMesh* second_or_null() const { return second ? &*second : nullptr; }
    io::TriangleMesh first;
    std::optional<io::TriangleMesh> second;
};

}  // namespace

nb::object to_str(const std::string& text) {
    return nb::steal(PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "backslashreplace"));
}

WithoutGil::AtExit at_exit(const Path& written) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(written, ignored);
    const bool special = std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
    return special ? WithoutGil::AtExit::given_up : WithoutGil::AtExit::finished;
}

namespace {

// Returns the number of the last frame of a scene; 0 for a name that is no scene, about which scenes::make throws.
int last_frame(std::string_view scene) {
    for (const scenes::Description& d : scenes::descriptions())
        if (d.name == scene) return d.frames - 1;
    return 0;
}

}  // namespace

// Cuts quadrilaterals (k, 4) into triangles (2k, 3), in the same way as the readers of files. A quadrilateral becomes a
// fan if it crosses itself, or if a corner is not finite or not a vertex; a search then reports the bad corner.
nb::object cut_quadrilaterals(
    const nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>& points,
    const nb::ndarray<const std::int64_t, nb::shape<-1, 4>, nb::c_contig, nb::device::cpu>& quads) {
    import_numpy();
    const auto triangles = new std::vector<std::int64_t>;
    const nb::capsule owner(triangles, [](void* p) noexcept { delete static_cast<std::vector<std::int64_t>*>(p); });
    triangles->reserve(6 * quads.shape(0));
    io::Triangulator triangulator;
    std::vector<std::int32_t> ears;
    for (std::size_t q = 0; q < quads.shape(0); ++q) {
        std::array<Vec3d, 4> corners;
        bool sound = true;
        for (std::size_t k = 0; k < 4; ++k) {
            const auto v = static_cast<std::size_t>(quads(q, k));
            sound = sound && v < points.shape(0);
            if (sound) corners[k] = {points(v, 0), points(v, 1), points(v, 2)};
            sound = sound && all_finite(corners[k]);
        }
        ears.clear();
        if (sound) triangulator.cut(corners, ears);
        if (ears.empty()) ears = {0, 1, 2, 0, 2, 3};
        for (const std::int32_t k : ears) triangles->push_back(quads(q, static_cast<std::size_t>(k)));
    }
    return nb::cast(nb::ndarray<nb::numpy, std::int64_t>(triangles->data(), {triangles->size() / 3, 3}, owner));
}

namespace {

// Returns the open edges of a mesh as two arrays: (k, 2) vertices and (k,) triangles.
nb::tuple open_edges_of(const nb::tuple& mesh, nb::handle weld) {
    const bool welds = flag("weld", weld);
    const BorrowedMesh borrowed(mesh);
    Array<OpenEdge> open;
    {
        const WithoutGil released;
        open = open_edges(borrowed.view(), welds);
    }
    import_numpy();
    struct Columns {
        std::vector<std::int32_t> vertices, triangles;
    };
    const auto columns = new Columns;
    const nb::capsule owner(columns, [](void* p) noexcept { delete static_cast<Columns*>(p); });
    for (const auto& [edge, triangle] : open) {
        columns->vertices.insert(columns->vertices.end(), {edge.a, edge.b});
        columns->triangles.push_back(triangle);
    }
    return nb::make_tuple(nb::ndarray<nb::numpy, std::int32_t>(columns->vertices.data(), {open.size(), 2}, owner),
                          nb::ndarray<nb::numpy, std::int32_t>(columns->triangles.data(), {open.size()}, owner));
}

}  // namespace

void bind_files(nb::module_& module) {
    module.def("cut_quadrilaterals", cut_quadrilaterals, "points"_a, "quads"_a);
    module.def("open_edges", open_edges_of, "mesh"_a, "weld"_a.none());
    module.def(
        "read_mesh",
        [](nb::handle path, nb::handle precision, nb::handle weld, nb::handle group_property, nb::handle triangulation,
           nb::handle strict, nb::handle unit) {
            const Path from = python::path("path", path);
            io::ReadOptions options = read_options(precision, weld, triangulation, strict, unit);
            options.group_property = text("group_property", group_property);
            io::TriangleMesh mesh;
            {
                const WithoutGil released;
                mesh = io::read_mesh(from, options);
            }
            nb::list warnings;
            for (const std::string& warning : mesh.warnings) warnings.append(to_str(warning));
            const nb::object of = name_of_unit(mesh.unit);
            return nb::make_tuple(to_numpy(std::move(mesh)), warnings, of);
        },
        "path"_a.none(), "precision"_a.none(), "weld"_a.none(), "group_property"_a.none(), "triangulation"_a.none(),
        "strict"_a.none(), "unit"_a.none());
    module.def(
        "write_mesh",
        [](nb::handle path, const nb::tuple& mesh) {
            const Path to = python::path("path", path);
            const BorrowedMesh borrowed(mesh);
            const io::Unit unit = units_of(mesh, {}).first;
            const WithoutGil released(at_exit(to));
            io::TriangleMesh copy = copy_of(borrowed.view());
            copy.unit = unit;
            io::write_mesh(to, copy);
        },
        "path"_a.none(), "mesh"_a);
    module.def(
        "write_coloured",
        [](nb::handle path, const nb::tuple& first, const std::optional<nb::tuple>& second,
           const Shown<Intersections>& result) {
            const Path to = python::path("path", path);
            const BorrowedMeshes meshes(first, second);
            const auto units = units_of(first, second);
            const WithoutGil released(at_exit(to));
            const CopiedMeshes copies(meshes, units);
            io::write_coloured(to, copies.first, copies.second_or_null(), result.found());
        },
        "path"_a.none(), "first"_a, "second"_a.none(), "result"_a);
    module.def(
        "to_html",
        [](const nb::tuple& first, const std::optional<nb::tuple>& second, const Shown<Intersections>& result,
           nb::handle height) {
            const int pixels = integer<int>("height", height);
            const BorrowedMeshes meshes(first, second);
            const auto units = units_of(first, second);
            const WithoutGil released;
            const CopiedMeshes copies(meshes, units);
            return io::to_html(copies.first, copies.second_or_null(), result.found(), pixels);
        },
        "first"_a, "second"_a.none(), "result"_a, "height"_a.none());
    module.def(
        "write_bytes",
        [](nb::handle path, nb::bytes bytes) {
            const Path to = python::path("path", path);
            const WithoutGil released(at_exit(to));
            io::write_bytes(to, {bytes.c_str(), bytes.size()});
        },
        "path"_a.none(), "bytes"_a);
    module.def(
        "write_pairs",
        [](nb::handle path, const Shown<Intersections>& result) {
            const Path to = python::path("path", path);
            const WithoutGil released(at_exit(to));
            io::write_pairs(to, result.found());
        },
        "path"_a.none(), "result"_a);
    module.def(
        "read_pairs",
        [](nb::handle path) {
            const Path from = python::path("path", path);
            import_numpy();
            const auto pairs = new std::vector<Pair>;
            const nb::capsule owner(pairs, [](void* p) noexcept { delete static_cast<std::vector<Pair>*>(p); });
            {
                const WithoutGil released;
                *pairs = io::read_pairs(from);
            }
            return nb::ndarray<nb::numpy, std::int32_t>(pairs->data(), {pairs->size(), 2}, owner);
        },
        "path"_a.none());
    module.def(
        "make_scene",
        [](nb::handle name, nb::handle triangles, nb::handle frame, nb::handle seed) {
            const std::string scene(text("name", name));
            const scenes::Parameters parameters{integer<std::int64_t>("triangles", triangles),
                                                frame.is_none() ? last_frame(scene) : integer<int>("frame", frame),
                                                integer<std::uint64_t>("seed", seed)};
            io::TriangleMesh mesh;
            {
                const WithoutGil released(WithoutGil::AtExit::finished);
                mesh = scenes::make(scene, parameters, [&](int, int) {
                    if (!released.wanted()) throw Error(ErrorCode::cancelled, "the interpreter has ended");
                    handle_signals();
                });
            }
            return to_numpy(std::move(mesh));
        },
        "name"_a.none(), "triangles"_a.none(), "frame"_a.none(), "seed"_a.none());
    module.def("scenes", [] {
        nb::list list;
        for (const scenes::Description& d : scenes::descriptions())
            list.append(nb::make_tuple(d.name, d.summary, d.triangles, d.frames));
        return list;
    });
}

}  // namespace crumple::python
