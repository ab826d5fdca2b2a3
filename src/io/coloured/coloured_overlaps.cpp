// Writes worlds with the surface of their overlaps in a strong colour, and everything else translucent.
//
// The surface is computed for the picture alone. A row of the overlaps names two bodies that overlap, or one body that
// overlaps itself. A search for intersections returns the segments in which the bodies of a row cross. Triangles are
// cut along these segments, and a piece is part of the surface if its middle lies inside the other body of a row, or in
// the common area of two triangles. So the triangles of the picture have other indices than those of the bodies.

#include <algorithm>
#include <map>
#include <optional>

#include "base/float_environment.h"
#include "crumple/detector.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/grouped.h"
#include "io/coloured/cut_triangle.h"
#include "io/coloured/picture_windings.h"
#include "io/formats.h"
#include "io/lists/pairs.h"
#include "io/scenes/world_mesh.h"

namespace crumple::io {
namespace {

/// Common area of two triangles: a convex polygon.
using CommonPolygon = std::vector<Vec3d>;

/// Contacts of one triangle with other bodies, or with other triangles of its own body.
struct TriangleContacts {
    std::vector<CutSegment> segments;
    std::vector<CommonPolygon> areas;
};

/// Second body of a row, as seen from one of the row's bodies; the same body if it overlaps itself.
struct OtherBody {
    std::int32_t body;
    bool both_closed;  ///< false if a body of the row is not closed (OverlapRelation::undefined)
};

/// Body of a row, posed, with its contacts.
struct CutBody {
    std::vector<Vec3d> points;
    std::vector<std::int32_t> corners;                  ///< corners of its triangles before these are cut
    std::map<std::int32_t, TriangleContacts> contacts;  ///< contacts of each triangle that has any
    std::vector<OtherBody> others;                      ///< one per row that names this body
    std::optional<PictureWindings> rays;
};

void check(const WorldMesh& world, const Overlaps& overlaps) {
    validate(world);
    const auto is_body = [&](std::int32_t body) {
        return body >= 0 && static_cast<std::size_t>(body) < world.bodies.size();
    };
    const bool fits = std::all_of(overlaps.bodies.begin(), overlaps.bodies.end(),
                                  [&](const BodyPair& pair) { return is_body(pair.first) && is_body(pair.second); });
    const bool has_relations = overlaps.relation.empty() || overlaps.relation.size() == overlaps.bodies.size();
    if (!fits || !has_relations || (overlaps.any && overlaps.bodies.empty()))
        throw Error(ErrorCode::invalid_argument,
                    "the overlaps are not those of this world, or have no rows; request Output::body_pairs or more");
}

TriangleMesh posed_shape(const WorldMesh& world, const NamedBody& body) {
    WorldMesh alone;
    alone.shapes = {world.shapes[static_cast<std::size_t>(body.shape)]};
    alone.bodies = {{body.name, 0, body.pose}};
    return posed_mesh(alone);
}

CutBody place(const WorldMesh& world, std::size_t b) {
    TriangleMesh posed = posed_shape(world, world.bodies[b]);
    CutBody body;
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3)
                body.points.push_back({double{xyz[i]}, double{xyz[i + 1]}, double{xyz[i + 2]}});
        },
        posed.vertices);
    body.corners = std::move(posed.triangles);
    return body;
}

/// Returns the bodies that rows name, posed and without contacts, by index.
std::map<std::int32_t, CutBody> place_bodies(const WorldMesh& world, const Overlaps& overlaps) {
    std::map<std::int32_t, CutBody> bodies;
    const auto body_of = [&](std::int32_t b) -> CutBody& {
        const auto found = bodies.find(b);
        return found != bodies.end() ? found->second
                                     : bodies.emplace(b, place(world, static_cast<std::size_t>(b))).first->second;
    };
    for (std::size_t i = 0; i < overlaps.bodies.size(); ++i) {
        const auto [first, second] = overlaps.bodies[i];
        const bool both_closed = overlaps.relation.empty() || overlaps.relation[i] != OverlapRelation::undefined;
        body_of(first).others.push_back({second, both_closed});
        if (second != first) body_of(second).others.push_back({first, both_closed});
    }
    for (auto& [b, body] : bodies) body.rays.emplace(body.points, body.corners);
    return bodies;
}

TriangleContacts contacts_of(std::span<const std::array<double, 3>> points) {
    TriangleContacts contacts;
    CommonPolygon area;
    for (const auto& [x, y, z] : points) area.push_back({x, y, z});
    const std::size_t sides = area.size() < 3 ? area.size() - 1 : area.size();
    for (std::size_t k = 0; k < sides; ++k) contacts.segments.push_back({area[k], area[(k + 1) % area.size()]});
    if (area.size() > 2) contacts.areas.push_back(std::move(area));
    return contacts;
}

void add(const TriangleContacts& more, TriangleContacts& contacts) {
    contacts.segments.insert(contacts.segments.end(), more.segments.begin(), more.segments.end());
    contacts.areas.insert(contacts.areas.end(), more.areas.begin(), more.areas.end());
}

/// Searches for intersections between all bodies, and within the bodies that overlap themselves. The result may include
/// pairs of bodies that no row names.
Intersections find_contacts(const WorldMesh& world, const Overlaps& overlaps, const Options& options) {
    const WorldView view = world.view();
    std::vector<Body> bodies = view.bodies;
    for (const auto& [first, second] : overlaps.bodies)
        if (first == second) bodies[static_cast<std::size_t>(first)].self = true;
    Detector detector(options);
    return detector.find(World{view.shapes, bodies, view.poses}, IntersectionQuery{.output = Output::contacts});
}

/// Adds contacts between bodies of one row to the triangles in contact, and ignores all other contacts. Returns the
/// segments of the added contacts, two end points each.
std::vector<std::array<double, 3>> add_contacts(const Intersections& found, std::map<std::int32_t, CutBody>& bodies) {
    std::vector<std::array<double, 3>> curves;
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
        const auto [first, second] = found.bodies[i];
        const auto body = bodies.find(first);
        if (body == bodies.end()) continue;
        const std::vector<OtherBody>& others = body->second.others;
        const auto is_second = [&, body = second](const OtherBody& other) { return other.body == body; };
        if (std::none_of(others.begin(), others.end(), is_second)) continue;
        const TriangleContacts contacts = contacts_of(points_of_pair(found.contacts, i));
        add(contacts, body->second.contacts[found.pairs[i].a]);
        add(contacts, bodies.at(second).contacts[found.pairs[i].b]);
        for (const CutSegment& segment : contacts.segments)
            for (const auto& [x, y, z] : segment) curves.push_back({x, y, z});
    }
    return curves;
}

bool is_within(const CommonPolygon& area, const Vec3d& p) {
    const Vec3d normal = cross(area[1] - area[0], area[2] - area[0]);
    for (std::size_t k = 0; k < area.size(); ++k)
        if (dot(normal, cross(area[(k + 1) % area.size()] - area[k], p - area[k])) < 0) return false;
    return true;
}

/// True if a piece of a triangle belongs to the surface of an overlap, or to an area common to two triangles. `middle`
/// is a point within the piece.
bool is_in_overlap(const std::map<std::int32_t, CutBody>& bodies, std::int32_t b, std::int32_t triangle,
                   const Vec3d& middle, const TriangleContacts* contacts) {
    const CutBody& body = bodies.at(b);
    for (const auto& [other, both_closed] : body.others) {
        if (!both_closed) continue;
        if (other != b && bodies.at(other).rays->at(middle) != 0) return true;
        if (other != b) continue;
        // The body overlaps itself. The ray starts at the piece and leaves on one side of it, so the winding number is
        // that of this side: without other parts of the body, 0 on the outer side (slope > 0) and 1 on the inner side.
        const std::int32_t* const c = &body.corners[3 * static_cast<std::size_t>(triangle)];
        const auto point = [&](std::size_t k) { return body.points[static_cast<std::size_t>(c[k])]; };
        const double slope = dot(cross(point(1) - point(0), point(2) - point(0)), PictureWindings::direction);
        if (slope != 0 && body.rays->at(middle, triangle) != (slope > 0 ? 0 : 1)) return true;
    }
    return contacts && std::any_of(contacts->areas.begin(), contacts->areas.end(),
                                   [&](const CommonPolygon& area) { return is_within(area, middle); });
}

/// Cuts a body's triangles into pieces, and triangulates each piece as a fan. Appends to `hit`, for each new triangle,
/// 1 if it belongs to the surface of an overlap, else 0.
TriangleMesh cut(const std::map<std::int32_t, CutBody>& bodies, std::int32_t b, std::vector<std::uint8_t>& hit) {
    const CutBody& body = bodies.at(b);
    std::vector<Vec3d> points = body.points;
    TriangleMesh mesh;
    for (std::int32_t t = 0; 3 * static_cast<std::size_t>(t) < body.corners.size(); ++t) {
        const std::int32_t* const c = &body.corners[3 * static_cast<std::size_t>(t)];
        const auto found = body.contacts.find(t);
        const TriangleContacts* const contacts = found == body.contacts.end() ? nullptr : &found->second;
        const std::span<const CutSegment> segments =
            contacts ? std::span(contacts->segments) : std::span<const CutSegment>();
        for (const CutPiece& piece : cut_triangle(points, {c[0], c[1], c[2]}, segments)) {
            Vec3d sum{};
            for (const std::int32_t corner : piece) sum = sum + points[static_cast<std::size_t>(corner)];
            const bool inside = is_in_overlap(bodies, b, t, (1 / static_cast<double>(piece.size())) * sum, contacts);
            for (std::size_t k = 2; k < piece.size(); ++k) {
                mesh.triangles.insert(mesh.triangles.end(), {piece[0], piece[k - 1], piece[k]});
                hit.push_back(inside);
            }
        }
    }
    std::vector<double> xyz;
    for (const Vec3d& p : points) xyz.insert(xyz.end(), {p.x, p.y, p.z});
    mesh.vertices = std::move(xyz);
    return mesh;
}

/// World in which the bodies that rows name are cut.
struct OverlapPicture {
    WorldMesh world;
    std::vector<std::uint8_t> hit;              ///< per triangle of each body: index of overlap_materials
    std::vector<std::array<double, 3>> curves;  ///< where bodies of rows cross: two end points per segment
    std::string caption;

    ColouredMesh mesh() const { return {posed_mesh(world), hit, overlap_materials}; }
};

std::string caption_of(std::size_t overlaps, std::size_t bodies) {
    const auto count = [](std::size_t number, const char* one, const char* many) {
        return grouped(static_cast<std::int64_t>(number)) + ' ' + (number == 1 ? one : many);
    };
    return count(overlaps, "overlap", "overlaps") + " of " + count(bodies, "body", "bodies");
}

OverlapPicture make_picture(const WorldMesh& world, const Overlaps& overlaps, const Options& options) {
    check(world, overlaps);
    OverlapPicture picture{world, {}, {}, caption_of(overlaps.bodies.size(), world.bodies.size())};
    std::map<std::int32_t, CutBody> bodies = place_bodies(world, overlaps);
    if (!bodies.empty()) picture.curves = add_contacts(find_contacts(world, overlaps, options), bodies);
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
        const auto shape = static_cast<std::size_t>(world.bodies[b].shape);
        if (const auto found = bodies.find(static_cast<std::int32_t>(b)); found != bodies.end()) {
            TriangleMesh mesh = cut(bodies, static_cast<std::int32_t>(b), picture.hit);
            picture.world.bodies[b].shape = static_cast<std::int32_t>(picture.world.shapes.size());
            picture.world.bodies[b].pose = {};
            picture.world.shapes.push_back(std::move(mesh));
        } else {
            picture.hit.resize(picture.hit.size() + static_cast<std::size_t>(world.shapes[shape].triangle_count()));
        }
    }
    return picture;
}

/// Returns the mesh without the triangles that do not belong to an overlap, for formats without translucency.
ColouredMesh without_rest(ColouredMesh coloured) {
    TriangleMesh rest = std::move(coloured.mesh);
    coloured.mesh.unit = rest.unit;
    std::vector<std::int32_t> new_index(static_cast<std::size_t>(rest.vertex_count()), -1);
    std::visit(
        [&](const auto& xyz) {
            std::remove_cvref_t<decltype(xyz)> kept;
            for (std::size_t i = 0; i < rest.triangles.size(); ++i) {
                if (!coloured.hit[i / 3]) continue;
                const auto vertex = static_cast<std::size_t>(rest.triangles[i]);
                if (new_index[vertex] < 0) {
                    new_index[vertex] = static_cast<std::int32_t>(kept.size() / 3);
                    kept.insert(kept.end(), &xyz[3 * vertex], &xyz[3 * vertex] + 3);
                }
                coloured.mesh.triangles.push_back(new_index[vertex]);
                if (i % 3 == 0) coloured.mesh.groups.push_back(rest.groups[i / 3]);
            }
            coloured.mesh.vertices = std::move(kept);
        },
        rest.vertices);
    coloured.hit.assign(coloured.mesh.triangles.size() / 3, 1);
    return coloured;
}

void write_picture(std::ostream& out, const OverlapPicture& picture, MeshFormat format) {
    if (format == MeshFormat::glb) return write_coloured_glb(out, picture.world, picture.hit, overlap_materials);
    if (format == MeshFormat::threemf) return write_coloured_3mf(out, picture.world, picture.hit, overlap_materials);
    if (format == MeshFormat::ply) return write_coloured_ply(out, without_rest(picture.mesh()));
    write_overlap_html(out, picture.mesh(), picture.curves, picture.caption);
}

}  // namespace

void write_coloured(const std::filesystem::path& path, const WorldMesh& world, const Overlaps& overlaps,
                    const Options& options) {
    const FloatEnvironment environment;
    const MeshFormat format = mesh_format_of(extension_of(path));
    check_has_colours(path, format);
    const OverlapPicture picture = make_picture(world, overlaps, options);
    if (format == MeshFormat::obj) return write_coloured_obj(path, picture.mesh());
    AtomicFile file(path);
    write_picture(file.stream(), picture, format);
    file.commit();
}

void write_coloured(std::ostream& out, const WorldMesh& world, const Overlaps& overlaps, MeshFormat format,
                    const Options& options) {
    const FloatEnvironment environment;
    check_has_colours(format);
    write_picture(out, make_picture(world, overlaps, options), format);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write a coloured mesh to the stream");
}

}  // namespace crumple::io
