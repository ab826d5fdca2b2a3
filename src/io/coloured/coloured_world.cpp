// Writes worlds with colliding triangles coloured: .glb and .3mf body by body, other formats as one mesh.

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/formats.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {

namespace {

using Writer = void (*)(std::ostream&, const WorldMesh&, std::span<const std::uint8_t>, std::span<const Material>);

/// Returns the writer of a format that keeps bodies apart, or null.
Writer writer_of_bodies(MeshFormat format) {
    if (format == MeshFormat::glb) return write_coloured_glb;
    if (format == MeshFormat::threemf) return write_coloured_3mf;
    return nullptr;
}

void check(const WorldMesh& world, const Intersections& collisions) {
    validate(world);
    if (static_cast<std::int64_t>(collisions.hit.size()) != world.triangle_count() ||
        collisions.first_triangle.size() != world.bodies.size() + 1 ||
        collisions.pairs.size() != collisions.bodies.size())
        throw Error(ErrorCode::invalid_argument,
                    "the collisions are not those of this world, or have no hit flags; set IntersectionQuery::index");
}

/// Converts collisions of a world to collisions of the mesh that posed_mesh() returns.
Intersections of_posed_mesh(const Intersections& collisions) {
    Intersections result;
    result.hit = collisions.hit;
    result.contacts = collisions.contacts;
    const auto id = [&](std::int32_t body, std::int32_t triangle) {
        return static_cast<std::int32_t>(collisions.first_triangle[static_cast<std::size_t>(body)] + triangle);
    };
    for (std::size_t i = 0; i < collisions.pairs.size(); ++i)
        result.pairs.push_back({id(collisions.bodies[i].first, collisions.pairs[i].a),
                                id(collisions.bodies[i].second, collisions.pairs[i].b)});
    return result;
}

}  // namespace

void write_coloured(const std::filesystem::path& path, const WorldMesh& world, const Intersections& collisions) {
    const FloatEnvironment environment;
    check(world, collisions);
    const Writer write = writer_of_bodies(mesh_format_of(extension_of(path)));
    if (!write) return write_coloured(path, posed_mesh(world), nullptr, of_posed_mesh(collisions));
    AtomicFile file(path);
    write(file.stream(), world, collisions.hit.span(), collision_materials);
    file.commit();
}

void write_coloured(std::ostream& out, const WorldMesh& world, const Intersections& collisions, MeshFormat format) {
    const FloatEnvironment environment;
    check(world, collisions);
    const Writer write = writer_of_bodies(format);
    if (!write) return write_coloured(out, posed_mesh(world), nullptr, of_posed_mesh(collisions), format);
    write(out, world, collisions.hit.span(), collision_materials);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a coloured mesh to the stream");
}

}  // namespace crumple::io
