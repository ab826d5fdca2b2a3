#include "fuzz/bodies.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include "crumple/error.h"
#include "fuzz/containers.h"
#include "fuzz/fail.h"
#include "fuzz/file.h"
#include "fuzz/written.h"

namespace crumple::fuzz {
namespace {

using io::NamedBody;
using io::TriangleMesh;
using io::WorldMesh;

const TriangleMesh& shape_of(const WorldMesh& world, const NamedBody& body) {
    return world.shapes[static_cast<std::size_t>(body.shape)];
}

/// Returns the result of a search that found no collision.
Intersections free_of(const WorldMesh& world) {
    Intersections free;
    free.first_triangle.push_back(0);
    for (const NamedBody& body : world.bodies)
        free.first_triangle.push_back(free.first_triangle[free.first_triangle.size() - 1] +
                                      shape_of(world, body).triangle_count());
    free.hit.assign(static_cast<std::size_t>(world.triangle_count()), 0);
    return free;
}

bool same_numbers(const Pose& a, const Pose& b) { return a == b; }

void require_same(const std::vector<Pose>& found, const std::vector<Pose>& expected, const char* what) {
    require(found.size() == expected.size() && std::equal(found.begin(), found.end(), expected.begin(), same_numbers),
            what);
}

std::string as_text(const std::vector<Pose>& poses) {
    std::string text;
    char number[32];
    for (const Pose& pose : poses)
        for (std::size_t i = 0; i < pose.rows.size(); ++i) {
            const auto end = std::to_chars(number, number + sizeof number, pose.rows[i]).ptr;
            text.append(number, end) += i + 1 < pose.rows.size() ? ',' : '\n';
        }
    return text;
}

std::string as_array(const std::vector<Pose>& poses) {
    std::string bytes =
        npy_header("{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(poses.size()) + ", 3, 4), }");
    for (const Pose& pose : poses)
        for (const double x : pose.rows) bytes += bytes_of(x);
    return bytes;
}

}  // namespace

void require_sound(const WorldMesh& world) {
    for (const TriangleMesh& shape : world.shapes) require_sound(shape);
    std::set<std::string> names;
    for (const NamedBody& body : world.bodies) {
        require(body.shape >= 0 && static_cast<std::size_t>(body.shape) < world.shapes.size(), "a body has no shape");
        require(!body.name.empty() && names.insert(body.name).second, "a body's name is empty or another one's");
        for (const double x : body.pose.rows) require(std::isfinite(x), "a pose is not finite");
    }
}

void require_welded(const WorldMesh& world, const WorldMesh& before) {
    require(world.bodies.size() == before.bodies.size() && world.shapes.size() == before.shapes.size(),
            "welding changes bodies");
    for (std::size_t b = 0; b < world.bodies.size(); ++b)
        require(world.bodies[b].name == before.bodies[b].name && world.bodies[b].shape == before.bodies[b].shape &&
                    same_numbers(world.bodies[b].pose, before.bodies[b].pose),
                "welding changes a body");
    for (std::size_t s = 0; s < world.shapes.size(); ++s) require_welded(world.shapes[s], before.shapes[s]);
}

void require_kept_by_writer(const WorldMesh& given) {
    WorldMesh world = given;
    world.unit = io::Unit::metre;  // worlds in other units would be converted
    std::ostringstream out;
    try {
        io::write_coloured(out, world, free_of(world), io::MeshFormat::glb);
    } catch (const Error& error) {
        require(error.code == ErrorCode::invalid_argument, "writing .glb fails otherwise than by what it is given");
        return;
    }
    const bool single = std::all_of(world.shapes.begin(), world.shapes.end(),
                                    [](const TriangleMesh& shape) { return shape.precision() == ScalarType::float32; });
    io::ReadOptions options;
    options.weld = io::Weld::no;
    const WorldMesh again = read_world(out.str(), "again.glb", options);
    std::size_t next = 0;
    for (const NamedBody& body : world.bodies) {
        const TriangleMesh& shape = shape_of(world, body);
        if (shape.triangles.empty()) continue;
        require(next < again.bodies.size(), "writing .glb loses a body");
        const NamedBody& found = again.bodies[next++];
        require(found.name == body.name, "writing .glb changes a name");
        require(shape_of(again, found).triangle_count() == shape.triangle_count(), "writing .glb changes a shape");
        if (!single) continue;  // .glb holds float32, relative to an origin
        require(same_numbers(found.pose, body.pose), "writing .glb changes a pose");
        require_same_corners(shape_of(again, found), shape, "written as .glb and read");
    }
    require(next == again.bodies.size(), "writing .glb adds a body");
}

void require_kept(const std::vector<Pose>& poses, std::span<const std::string> bodies) {
    require(bodies.empty() || poses.size() % bodies.size() == 0, "a configuration is not whole");
    for (const Pose& pose : poses)
        for (const double x : pose.rows) require(std::isfinite(x), "a pose is not finite");
    require_same(read_poses(as_text(poses), "again.csv", bodies), poses, "poses written as text and read differ");
    require_same(read_poses(as_array(poses), "again.npy", bodies), poses, "poses written as .npy and read differ");
}

}  // namespace crumple::fuzz
