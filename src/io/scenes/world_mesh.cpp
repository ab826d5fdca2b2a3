// Views, validation and posed meshes of a WorldMesh.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/float_environment.h"
#include "crumple/error.h"
#include "crumple/io.h"
#include "io/formats.h"
#include "io/scenes/world_mesh.h"
#include "scene/placement.h"

namespace crumple::io {

std::int64_t WorldMesh::triangle_count() const {
    std::int64_t count = 0;
    for (const NamedBody& body : bodies) count += shapes.at(static_cast<std::size_t>(body.shape)).triangle_count();
    return count;
}

WorldView WorldMesh::view(std::uint64_t first_name) const {
    WorldView view;
    for (const TriangleMesh& shape : shapes)
        view.shapes.emplace_back(shape.view(), first_name ? first_name + view.shapes.size() : 0);
    for (const NamedBody& body : bodies) {
        view.bodies.push_back({.shape = body.shape});
        view.poses.push_back(body.pose);
    }
    return view;
}

void validate(const WorldMesh& world) {
    for (const TriangleMesh& shape : world.shapes) validate(shape);
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const NamedBody& body = world.bodies[b];
        const auto refuse = [&](const std::string& what) {
            throw Error(ErrorCode::invalid_argument, "body " + std::to_string(b) + ": " + what, Element::body,
                        static_cast<std::int64_t>(b));
        };
        if (body.shape < 0 || static_cast<std::size_t>(body.shape) >= world.shapes.size())
            refuse("there is no shape " + std::to_string(body.shape));
        for (const double value : body.pose.rows)
            if (!std::isfinite(value)) refuse("its pose is not finite");
    }
}

WorldMesh world_of(const TriangleMesh& mesh, std::string name) {
    WorldMesh world;
    world.shapes.push_back({mesh.vertices, mesh.triangles});
    world.bodies.push_back({std::move(name)});
    world.unit = mesh.unit;
    return world;
}

namespace {

Bounds bounds_of(const TriangleMesh& mesh) {
    Bounds box = no_bounds;
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3)
                box.widen(Vec3d{double{xyz[i]}, double{xyz[i + 1]}, double{xyz[i + 2]}});
        },
        mesh.vertices);
    return box;
}

}  // namespace

const NamedBody* find_far_body(const WorldMesh& world) {
    std::vector<Bounds> boxes;
    for (const TriangleMesh& shape : world.shapes) boxes.push_back(bounds_of(shape));
    for (const NamedBody& body : world.bodies) {
        const auto s = static_cast<std::size_t>(body.shape);
        const bool single = world.shapes[s].precision() == ScalarType::float32;
        const Placement place(&body.pose, single);
        if (!single || place.identity() || world.shapes[s].vertex_count() == 0) continue;
        const Bounds box = place(CentredBox(boxes[s]));
        const Vec3d size = box.high - box.low, far = max(abs(box.low), abs(box.high));
        if (max(max(far.x, far.y), far.z) > 1024 * max(max(size.x, size.y), size.z)) return &body;
    }
    return nullptr;
}

namespace {

template <class Scalar>
void add_posed(const TriangleMesh& shape, const Pose& pose, std::vector<Scalar>& xyz) {
    const Placement place(&pose, shape.precision() == ScalarType::float32);
    std::visit(
        [&](const auto& given) {
            for (std::size_t i = 0; i < given.size(); i += 3) {
                const Vec3d p = place(Vec3d{double{given[i]}, double{given[i + 1]}, double{given[i + 2]}});
                for (const double x : {p.x, p.y, p.z}) xyz.push_back(static_cast<Scalar>(x));
            }
        },
        shape.vertices);
}

/// True if the pose is a reflection, which reverses the orientation of triangles.
bool mirrors(const Pose& pose) {
    const Affine matrix{pose.rows};
    return dot(cross(matrix.column(0), matrix.column(1)), matrix.column(2)) < 0;
}

void check_size(const WorldMesh& world) {
    std::int64_t vertices = 0, triangles = 0;
    for (const NamedBody& body : world.bodies) {
        const TriangleMesh& shape = world.shapes[static_cast<std::size_t>(body.shape)];
        vertices += shape.vertex_count(), triangles += shape.triangle_count();
        if (vertices > INT32_MAX || triangles > INT32_MAX)
            throw Error(ErrorCode::invalid_argument,
                        "the world has more vertices or triangles than 32-bit ids can number");
    }
}

template <class Scalar>
TriangleMesh posed(const WorldMesh& world) {
    std::vector<Scalar> xyz;
    TriangleMesh mesh;
    std::int64_t first = 0;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const NamedBody& body = world.bodies[b];
        const TriangleMesh& shape = world.shapes[static_cast<std::size_t>(body.shape)];
        add_posed(shape, body.pose, xyz);
        const bool mirrored = mirrors(body.pose);
        for (std::size_t c = 0; c < shape.triangles.size(); c += 3)
            for (const std::size_t k : {c, mirrored ? c + 2 : c + 1, mirrored ? c + 1 : c + 2})
                mesh.triangles.push_back(static_cast<std::int32_t>(first + shape.triangles[k]));
        mesh.groups.resize(mesh.triangles.size() / 3, static_cast<std::int32_t>(b));
        first += shape.vertex_count();
    }
    mesh.vertices = std::move(xyz);
    return mesh;
}

}  // namespace

TriangleMesh posed_mesh(const WorldMesh& world) {
    const FloatEnvironment environment;
    validate(world);
    check_size(world);
    const bool single = std::all_of(world.shapes.begin(), world.shapes.end(),
                                    [](const TriangleMesh& shape) { return shape.precision() == ScalarType::float32; });
    TriangleMesh mesh = single ? posed<float>(world) : posed<double>(world);
    mesh.unit = world.unit;
    return mesh;
}

void append(WorldMesh&& more, WorldMesh& all) {
    if (all.unit == Unit::unknown) all.unit = more.unit;
    const auto first = static_cast<std::int32_t>(all.shapes.size());
    for (NamedBody& body : more.bodies) body.shape += first;
    std::move(more.shapes.begin(), more.shapes.end(), std::back_inserter(all.shapes));
    std::move(more.bodies.begin(), more.bodies.end(), std::back_inserter(all.bodies));
}

}  // namespace crumple::io
