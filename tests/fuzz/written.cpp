#include "fuzz/written.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <sstream>

#include "crumple/error.h"
#include "fuzz/fail.h"
#include "fuzz/file.h"
#include "io/formats.h"

namespace crumple::fuzz {
namespace {

using io::Precision;
using io::TriangleMesh;
using io::Weld;

template <class F>
auto with_coordinates(const TriangleMesh& mesh, F&& f) {
    return std::visit(std::forward<F>(f), mesh.vertices);
}

template <class Scalar>
std::array<Scalar, 3> position(const std::vector<Scalar>& of, std::int64_t v) {
    const auto i = 3 * static_cast<std::size_t>(v);
    return {of[i], of[i + 1], of[i + 2]};
}

Precision precision_of(const TriangleMesh& mesh) {
    return mesh.precision() == ScalarType::float32 ? Precision::float32 : Precision::float64;
}

TriangleMesh read_again(const std::string& bytes, const std::string& name, Precision precision,
                        const std::string& group_property = {},
                        io::Triangulation triangulation = io::Triangulation::ears) {
    io::ReadOptions options;
    options.precision = precision;
    options.weld = Weld::no;
    options.group_property = group_property;
    options.triangulation = triangulation;
    return read_mesh(bytes, name, options);
}

template <class Write>
std::string written(Write&& write) {
    std::ostringstream out;
    write(out);
    return std::move(out).str();
}

/// Sets `stl` to the mesh as STL stores it, with three float32 vertices per triangle. Returns true if all are finite.
bool as_stl(const TriangleMesh& mesh, TriangleMesh& stl) {
    std::vector<float> xyz;
    with_coordinates(mesh, [&](const auto& from) {
        for (const std::int32_t corner : mesh.triangles)
            for (std::size_t axis = 0; axis < 3; ++axis)
                xyz.push_back(static_cast<float>(from[3 * static_cast<std::size_t>(corner) + axis]));
    });
    stl.triangles.resize(mesh.triangles.size());
    std::iota(stl.triangles.begin(), stl.triangles.end(), 0);
    const bool finite = std::all_of(xyz.begin(), xyz.end(), [](float x) { return std::isfinite(x); });
    stl.vertices = std::move(xyz);
    return finite;
}

void require_kept_by_stl(const TriangleMesh& mesh) {
    TriangleMesh expected;
    const bool finite = as_stl(mesh, expected);
    std::string bytes;
    try {
        bytes = written([&](std::ostream& out) { io::write_stl(out, mesh, false); });
    } catch (const Error& error) {
        require(!finite && error.code == ErrorCode::invalid_argument && error.element == Element::vertex,
                "STL refuses what it can hold");
        return;
    }
    require(finite, "STL holds coordinates beyond float32");
    require_same(read_again(bytes, "again.stl", Precision::automatic), expected, "written as STL and read");
}

/// Returns the mesh without its groups, which most formats do not store.
TriangleMesh as_triangles(const TriangleMesh& mesh) { return {mesh.vertices, mesh.triangles}; }

/// Writes coloured triangles or, if the mesh has them, polygons, which the reader cuts again. Requires PLY and OBJ to
/// keep the mesh, and 3MF its vertices and triangles.
void require_kept_by_coloured(const TriangleMesh& mesh, io::Triangulation triangulation) {
    io::ColouredMesh coloured{mesh, std::vector<std::uint8_t>(mesh.triangles.size() / 3)};
    for (std::size_t t = 0; t < coloured.hit.size(); t += 2) coloured.hit[t] = 1;
    const Precision precision = precision_of(mesh);
    const std::string ply = written([&](std::ostream& out) { io::write_coloured_ply(out, coloured); });
    require_same(read_again(ply, "again.ply", precision, "", triangulation), mesh, "written as coloured PLY and read");
    const std::string obj = written([&](std::ostream& out) { io::write_coloured_obj(out, coloured, "again.mtl"); });
    require_same(read_again(obj, "again.obj", precision, "", triangulation), mesh, "written as coloured OBJ and read");
    const std::string package = written([&](std::ostream& out) { io::write_coloured_3mf(out, coloured); });
    require_same(read_again(package, "again.3mf", precision), as_triangles(mesh), "written as coloured 3MF and read");
    try {
        written([&](std::ostream& out) { io::write_coloured_glb(out, coloured); });
    } catch (const Error& error) {
        require(error.code == ErrorCode::invalid_argument, "writing .glb fails otherwise than by what it is given");
    }
}

}  // namespace

void require_same(const TriangleMesh& a, const TriangleMesh& b, const char* what) {
    const auto same = [&](bool holds, const char* of) {
        if (!holds) fail(std::string(what) + ": " + of + " differ");
    };
    same(a.precision() == b.precision(), "precisions");
    same(a.triangles == b.triangles, "triangles");
    same(a.groups == b.groups, "groups");
    with_coordinates(a, [&](const auto& p) {
        const auto& q = std::get<std::decay_t<decltype(p)>>(b.vertices);
        same(p.size() == q.size(), "numbers of vertices");
        same(p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof p[0]) == 0, "coordinates");
    });
}

void require_same_corners(const TriangleMesh& a, const TriangleMesh& b, const char* what) {
    const auto same = [&](bool holds, const char* of) {
        if (!holds) fail(std::string(what) + ": " + of + " differ");
    };
    same(a.precision() == b.precision(), "precisions");
    same(a.triangles.size() == b.triangles.size(), "numbers of triangles");
    with_coordinates(a, [&](const auto& p) {
        const auto& q = std::get<std::decay_t<decltype(p)>>(b.vertices);
        for (std::size_t i = 0; i < a.triangles.size(); ++i)
            same(position(p, a.triangles[i]) == position(q, b.triangles[i]), "corners");
    });
}

void require_sound(const TriangleMesh& mesh) {
    with_coordinates(mesh, [](const auto& xyz) {
        require(xyz.size() % 3 == 0, "a vertex is not whole");
        for (const auto x : xyz) require(std::isfinite(x), "a coordinate is not finite");
    });
    require(mesh.triangles.size() % 3 == 0, "a triangle is not whole");
    for (const std::int32_t corner : mesh.triangles)
        require(corner >= 0 && corner < mesh.vertex_count(), "a corner names no vertex");
    require(mesh.groups.empty() || mesh.groups.size() == mesh.triangles.size() / 3, "groups are not one a triangle");
}

void require_welded(const TriangleMesh& mesh, const TriangleMesh& before) {
    require(mesh.triangles.size() == before.triangles.size(), "welding changes the number of triangles");
    require(mesh.groups == before.groups, "welding changes groups");
    with_coordinates(mesh, [&](const auto& xyz) {
        using Scalar = typename std::decay_t<decltype(xyz)>::value_type;
        std::vector<std::array<Scalar, 3>> all;
        for (std::int64_t v = 0; v < mesh.vertex_count(); ++v) all.push_back(position(xyz, v));
        std::sort(all.begin(), all.end());
        require(std::adjacent_find(all.begin(), all.end()) == all.end(), "welding leaves two vertices at one position");
        const auto& old = std::get<std::vector<Scalar>>(before.vertices);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            require(position(xyz, mesh.triangles[i]) == position(old, before.triangles[i]), "welding moves a corner");
    });
}

void require_kept_by_writers(const TriangleMesh& mesh, io::Triangulation triangulation) {
    TriangleMesh without_groups = mesh;
    without_groups.groups.clear();
    const std::string ply = written([&](std::ostream& out) { io::write_ply(out, mesh, false); });
    require_same(read_again(ply, "again.ply", Precision::automatic, mesh.groups.empty() ? "" : "group"), mesh,
                 "written as PLY and read");
    if (mesh.vertex_count() > 0) {  // without vertices the file is empty, which is refused
        const std::string obj = written([&](std::ostream& out) { io::write_obj(out, mesh, false); });
        require_same(read_again(obj, "again.obj", precision_of(mesh)), without_groups, "written as OBJ and read");
    }
    const std::string off = written([&](std::ostream& out) { io::write_off(out, mesh, false); });
    require_same(read_again(off, "again", precision_of(mesh)), without_groups, "written as OFF and read");
    require_kept_by_stl(mesh);
    require_kept_by_coloured(without_groups, triangulation);
    if (without_groups.polygons.empty()) return;
    without_groups.polygons = {};
    require_kept_by_coloured(without_groups, triangulation);
}

void require_kept_by_writers(const std::vector<Pair>& pairs) {
    Intersections collisions;
    for (const Pair& pair : pairs) collisions.pairs.push_back(pair);
    constexpr std::pair<io::PairFormat, const char*> formats[] = {{io::PairFormat::txt, "again.txt"},
                                                                  {io::PairFormat::csv, "again.csv"},
                                                                  {io::PairFormat::json, "again.json"},
                                                                  {io::PairFormat::npz, "again.npz"}};
    for (const auto& [format, name] : formats) {
        const std::string bytes =
            written([&, format = format](std::ostream& out) { io::write_pairs(out, collisions, format); });
        if (read_pairs(bytes, name) != pairs) fail(std::string("pairs written and read differ: ") + name);
    }
}

}  // namespace crumple::fuzz
