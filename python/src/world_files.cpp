#include "world_files.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arguments.h"
#include "files.h"
#include "names.h"
#include "world.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

using Path = std::filesystem::path;
using IndexRows = nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
template <class Number>
using Column = nb::ndarray<const Number, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Points = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

// Returns a NumPy array (n, 3, 4) that owns the poses, which are moved, not copied.
nb::object to_numpy(std::vector<Pose>&& poses) {
    import_numpy();
    const auto shared = new std::vector<Pose>(std::move(poses));
    const nb::capsule owner(shared, [](void* p) noexcept { delete static_cast<std::vector<Pose>*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, double>(static_cast<void*>(shared->data()), {shared->size(), 3, 4}, owner));
}

// Reads a world from a file. Returns (shapes as meshes, shape index of each body, names, poses, warnings, unit).
nb::tuple read_world(nb::handle path, nb::handle precision, nb::handle weld, nb::handle triangulation,
                     nb::handle strict, nb::handle unit) {
    const Path from = python::path("path", path);
    const io::ReadOptions options = read_options(precision, weld, triangulation, strict, unit);
    io::WorldMesh world;
    {
        const WithoutGil released;
        world = io::read_world(from, options);
    }
    nb::list shapes, of, names, warnings;
    std::vector<Pose> poses;
    poses.reserve(world.bodies.size());
    for (const io::NamedBody& body : world.bodies) {
        of.append(body.shape);
        names.append(to_str(body.name));
        poses.push_back(body.pose);
    }
    for (io::TriangleMesh& shape : world.shapes) shapes.append(python::to_numpy(std::move(shape)));
    for (const std::string& warning : world.warnings) warnings.append(to_str(warning));
    return nb::make_tuple(shapes, of, names, to_numpy(std::move(poses)), warnings, name_of_unit(world.unit));
}

nb::object read_poses(nb::handle path, const std::vector<std::string>& names) {
    const Path from = python::path("path", path);
    std::vector<Pose> poses;
    {
        const WithoutGil released;
        poses = io::read_poses(from, names);
    }
    return to_numpy(std::move(poses));
}

}  // namespace

io::WorldMesh copy_of(nb::handle world, nb::handle poses, const std::vector<std::string>& names) {
    const BorrowedWorld& given = given_world(world);
    const std::shared_ptr<const Bodies> bodies = given.bodies;
    const BorrowedPoses at = poses.is_none() ? BorrowedPoses() : BorrowedPoses(poses, *bodies);
    std::vector<Pose> buffer;
    const std::span<const Pose> placed = at.read(*bodies, buffer);
    if (names.size() != bodies->bodies.size()) throw std::logic_error("crumple/_world.py gave too few names");
    io::WorldMesh result;
    result.shapes.reserve(bodies->shapes.size());
    for (const Shape& shape : bodies->shapes)
        result.shapes.push_back(python::copy_of(MeshView(shape.vertices, shape.triangles, shape.groups)));
    result.bodies.reserve(names.size());
    for (std::size_t b = 0; b < names.size(); ++b)
        result.bodies.push_back({names[b], bodies->bodies[b].shape, placed.empty() ? Pose() : placed[b]});
    result.unit = unit_of(nb::getattr(world, "unit", nb::none()));
    return result;
}

namespace {

[[noreturn]] void refuse_changed() {
    refuse("the world was changed after the search, so the result no longer fits it");
}

// Computes `first_triangle` and the hit flags of a result: those of the triangles in pairs or, if the result has only
// pairs of bodies, those of all triangles of these bodies; these pairs are then removed. Validates the indices, because
// results may come from pickles.
void fill_first_triangles_and_hits(const io::WorldMesh& world, Intersections& c) {
    c.first_triangle.push_back(0);
    for (const io::NamedBody& body : world.bodies) {
        if (body.shape < 0 || static_cast<std::size_t>(body.shape) >= world.shapes.size()) refuse_changed();
        c.first_triangle.push_back(c.first_triangle.back() +
                                   world.shapes[static_cast<std::size_t>(body.shape)].triangle_count());
    }
    c.hit.assign(static_cast<std::size_t>(c.first_triangle.back()), 0);
    const auto first = [&](std::int32_t body) {
        if (body < 0 || static_cast<std::size_t>(body) >= world.bodies.size()) refuse_changed();
        return c.first_triangle[body];
    };
    const auto hit = [&](std::int32_t body, std::int32_t triangle) {
        const std::int64_t place = first(body) + triangle;
        if (triangle < 0 || place >= c.first_triangle[body + 1]) refuse_changed();
        c.hit[place] = 1;
    };
    const bool whole_bodies = c.pairs.empty();
    for (std::size_t i = 0; i < c.bodies.size(); ++i) {
        const auto [a, b] = c.bodies[i];
        if (whole_bodies) {
            for (const std::int32_t body : {a, b})
                std::fill(c.hit.begin() + first(body), c.hit.begin() + c.first_triangle[body + 1], std::uint8_t{1});
        } else {
            hit(a, c.pairs[i].a);
            hit(b, c.pairs[i].b);
        }
    }
    if (whole_bodies) c.bodies.clear();
}

template <class Element, class Given>
void fill(Array<Element>& array, const Given& given) {
    array.resize_discard(given.shape(0));
    if (!array.empty()) std::memcpy(static_cast<void*>(array.data()), given.data(), array.size() * sizeof(Element));
}

void write_coloured(nb::handle path, nb::handle world, nb::handle poses, const std::vector<std::string>& names,
                    const IndexRows& bodies, const IndexRows& pairs, const Column<std::uint8_t>& kinds,
                    const Column<std::int64_t>& offsets, const Points& points) {
    const Path to = python::path("path", path);
    const io::WorldMesh mesh = copy_of(world, poses, names);
    Intersections collisions;
    fill(collisions.bodies, bodies);
    fill(collisions.pairs, pairs);
    if (!collisions.pairs.empty() && collisions.bodies.size() != collisions.pairs.size()) refuse_changed();
    fill_first_triangles_and_hits(mesh, collisions);
    fill(collisions.contacts.kinds, kinds);
    fill(collisions.contacts.offsets, offsets);
    fill(collisions.contacts.points, points);
    const WithoutGil released(at_exit(to));
    io::write_coloured(to, mesh, collisions);
}

void write_coloured_overlaps(nb::handle path, nb::handle world, nb::handle poses, const std::vector<std::string>& names,
                             const IndexRows& bodies, const Column<std::uint8_t>& relations) {
    const Path to = python::path("path", path);
    const io::WorldMesh mesh = copy_of(world, poses, names);
    Overlaps overlaps;
    fill(overlaps.bodies, bodies);
    fill(overlaps.relation, relations);
    const WithoutGil released(at_exit(to));
    io::write_coloured(to, mesh, overlaps);
}

nb::tuple posed_mesh(nb::handle world, nb::handle poses, const std::vector<std::string>& names) {
    const io::WorldMesh mesh = copy_of(world, poses, names);
    return python::to_numpy(io::posed_mesh(mesh));
}

}  // namespace

void bind_world_files(nb::module_& module) {
    module.def("read_world", read_world, "path"_a.none(), "precision"_a.none(), "weld"_a.none(),
               "triangulation"_a.none(), "strict"_a.none(), "unit"_a.none());
    module.def("read_poses", read_poses, "path"_a.none(), "names"_a);
    module.def("write_coloured_world", write_coloured, "path"_a.none(), "world"_a.none(), "poses"_a.none(), "names"_a,
               "bodies"_a, "pairs"_a, "contact_kinds"_a, "contact_offsets"_a, "contact_points"_a);
    module.def("write_coloured_overlaps", write_coloured_overlaps, "path"_a.none(), "world"_a.none(), "poses"_a.none(),
               "names"_a, "bodies"_a, "relations"_a);
    module.def("posed_mesh", posed_mesh, "world"_a.none(), "poses"_a.none(), "names"_a);
}

}  // namespace crumple::python
