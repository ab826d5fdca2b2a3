// Tests of coloured meshes of overlaps: the area of the coloured surface, and what the formats hold.

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "crumple/detector.h"
#include "files.h"
#include "io/coloured/cut_triangle.h"
#include "io/coloured/picture_windings.h"

namespace crumple::io::test {
namespace {

constexpr std::array<std::int32_t, 36> box_triangles{0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1,
                                                     2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3};

TriangleMesh box(const std::array<double, 3>& low, const std::array<double, 3>& high) {
    std::vector<double> xyz;
    for (const double x : {low[0], high[0]})
        for (const double y : {low[1], high[1]})
            for (const double z : {low[2], high[2]}) xyz.insert(xyz.end(), {x, y, z});
    return {xyz, {box_triangles.begin(), box_triangles.end()}};
}

/// World of these bodies, unposed, and its overlaps.
struct OverlappingBodies {
    WorldMesh world;
    Overlaps overlaps;

    explicit OverlappingBodies(std::vector<TriangleMesh> shapes, bool self = false) {
        for (std::size_t s = 0; s < shapes.size(); ++s)
            world.bodies.push_back({"body " + std::to_string(s), static_cast<std::int32_t>(s), {}});
        world.shapes = std::move(shapes);
        search(self);
    }
    void search(bool self) {
        const WorldView view = world.view();
        OverlapQuery query;
        query.output = Output::body_pairs;
        query.self_overlaps = self;
        overlaps = Detector().find(view.world(), query);
    }
    TriangleMesh ply(bool coloured = true) const {
        std::ostringstream out;
        write_coloured(out, world, overlaps, MeshFormat::ply);
        return read_bytes(out.str(), "a.ply", {.group_property = coloured ? "group" : ""});
    }
};

Vec3d corner_of(const TriangleMesh& mesh, std::size_t i) {
    const auto v = 3 * static_cast<std::size_t>(mesh.triangles[i]);
    return std::visit(
        [&](const auto& xyz) {
            return Vec3d{double{xyz[v]}, double{xyz[v + 1]}, double{xyz[v + 2]}};
        },
        mesh.vertices);
}

double area_of(const TriangleMesh& mesh) {
    double area = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
        const Vec3d n = cross(corner_of(mesh, i + 1) - corner_of(mesh, i), corner_of(mesh, i + 2) - corner_of(mesh, i));
        area += std::sqrt(dot(n, n)) / 2;
    }
    return area;
}

TEST(ColouredOverlaps, ply_holds_only_the_surface_of_the_overlap) {
    const OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5})});
    const TriangleMesh ply = bodies.ply();  // surface of the box (1, 1.25, 0.5) to (2, 2, 1.5)
    EXPECT_NEAR(area_of(ply), 2 * (1 * 0.75 + 1 * 1 + 0.75 * 1), 1e-12);
    for (std::size_t i = 0; i < ply.triangles.size(); ++i) {
        const Vec3d p = corner_of(ply, i), middle{1.5, 1.625, 1}, half{0.5, 0.375, 0.5};
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(p[axis] - middle[axis]), half[axis] + 1e-12) << i;
    }
    for (const int body : {0, 1}) EXPECT_GT(std::count(ply.groups.begin(), ply.groups.end(), body), 0) << body;
}

TEST(ColouredOverlaps, body_inside_another_is_coloured_entirely) {
    const OverlappingBodies bodies({box({0, 0, 0}, {4, 4, 4}), box({1, 1, 1}, {2, 3, 2})});
    EXPECT_NEAR(area_of(bodies.ply()), 10, 1e-12);
}

TEST(ColouredOverlaps, touching_faces_are_coloured_where_they_touch) {
    const OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({0.5, 1, 2}, {1.5, 3, 3})});
    const TriangleMesh ply = bodies.ply();  // the square (0.5, 1, 2) to (1.5, 2, 2) of each body
    EXPECT_NEAR(area_of(ply), 2 * 1, 1e-12);
    for (std::size_t i = 0; i < ply.triangles.size(); ++i) {
        const Vec3d p = corner_of(ply, i), middle{1, 1.5, 2}, half{0.5, 0.5, 0};
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(p[axis] - middle[axis]), half[axis] + 1e-12) << i;
    }
}

TEST(ColouredOverlaps, self_overlap_of_a_body_is_coloured) {
    TriangleMesh both = box({0, 0, 0}, {2, 2, 2});
    const TriangleMesh second = box({1, 1.25, 0.5}, {3, 3, 1.5});
    auto& xyz = std::get<std::vector<double>>(both.vertices);
    const auto& more = std::get<std::vector<double>>(second.vertices);
    xyz.insert(xyz.end(), more.begin(), more.end());
    for (const std::int32_t corner : second.triangles) both.triangles.push_back(corner + 8);
    const OverlappingBodies bodies({both}, true);
    EXPECT_NEAR(area_of(bodies.ply()), 5, 1e-12);
}

TEST(ColouredOverlaps, coloured_overlap_follows_a_pose_that_moves_and_mirrors) {
    OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2})});
    bodies.world.bodies.push_back({"mirrored", 0, {}});
    bodies.world.bodies[1].pose.rows = {-1, 0, 0, 3, 0, 1, 0, 0.5, 0, 0, 1, 0.5};  // (1, 0.5, 0.5) to (3, 2.5, 2.5)
    bodies.search(false);
    const TriangleMesh ply = bodies.ply();  // surface of the box (1, 0.5, 0.5) to (2, 2, 2)
    EXPECT_NEAR(area_of(ply), 2 * (1 * 1.5 + 1 * 1.5 + 1.5 * 1.5), 1e-12);
    for (std::size_t i = 0; i < ply.triangles.size(); ++i) {
        const Vec3d p = corner_of(ply, i), middle{1.5, 1.25, 1.25}, half{0.5, 0.75, 0.75};
        for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(p[axis] - middle[axis]), half[axis] + 1e-12) << i;
    }
}

TEST(ColouredOverlaps, overlap_with_an_open_body_is_not_coloured) {
    OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5})});
    bodies.world.shapes[1].triangles.resize(33);
    bodies.overlaps.relation[0] = OverlapRelation::undefined;
    EXPECT_EQ(bodies.ply(false).triangle_count(), 0);
    bodies.overlaps.relation.push_back(OverlapRelation::undefined);
    EXPECT_EQ(error_of([&] { bodies.ply(false); }).code, ErrorCode::invalid_argument);
}

TEST(ColouredOverlaps, without_overlaps_nothing_is_coloured) {
    const OverlappingBodies bodies({box({0, 0, 0}, {1, 1, 1}), box({5, 5, 5}, {6, 6, 6})});
    EXPECT_EQ(bodies.ply(false).triangle_count(), 0);
    std::ostringstream out;
    write_coloured(out, bodies.world, bodies.overlaps, MeshFormat::glb);
    std::istringstream in(out.str());
    EXPECT_EQ(read_world(in, "a.glb").triangle_count(), 24);
}

TEST(ColouredOverlaps, glb_shows_overlaps_opaque_in_translucent_bodies) {
    const Folder folder;
    const OverlappingBodies bodies(
        {box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5}), box({7, 7, 7}, {8, 8, 8})});
    write_coloured(folder / "a.glb", bodies.world, bodies.overlaps);
    tinygltf::Model model;
    std::string error, warning;
    ASSERT_TRUE(tinygltf::TinyGLTF().LoadBinaryFromFile(&model, &error, &warning, (folder / "a.glb").string()));
    ASSERT_EQ(model.materials.size(), 2u);
    EXPECT_EQ(model.materials[0].alphaMode, "BLEND");
    EXPECT_LT(model.materials[0].pbrMetallicRoughness.baseColorFactor[3], 0.5);
    EXPECT_EQ(model.materials[1].name, "inside");
    EXPECT_EQ(model.materials[1].alphaMode, "OPAQUE");
    ASSERT_EQ(model.nodes.size(), 3u);
    EXPECT_EQ(model.nodes[1].name, "body 1");
    EXPECT_EQ(model.meshes[1].primitives.size(), 2u);
    EXPECT_EQ(model.meshes[2].primitives.size(), 1u) << "it overlaps nothing";
    EXPECT_NEAR(area_of(read_mesh(folder / "a.glb")), 24 + 2 * (2 * 1.75 + 2 + 1.75) + 6, 1e-5) << "nothing is lost";
}

TEST(ColouredOverlaps, obj_marks_translucency_and_3mf_keeps_bodies) {
    const Folder folder;
    const OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5})});
    write_coloured(folder / "a.obj", bodies.world, bodies.overlaps);
    EXPECT_TRUE(contains(bytes_of(folder / "a.obj"), "usemtl inside\n"));
    EXPECT_TRUE(contains(bytes_of(folder / "a.mtl"), "newmtl outside\nKd 0.69803923 0.69803923 0.69803923\nd 0.2\n"));
    write_coloured(folder / "a.3mf", bodies.world, bodies.overlaps);
    const WorldMesh again = read_world(folder / "a.3mf");
    ASSERT_EQ(again.bodies.size(), 2u);
    EXPECT_EQ(again.bodies[0].name, "body 0");
}

TEST(ColouredOverlaps, html_page_has_title_legend_and_number_of_opaque_corners) {
    const OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5})});
    std::ostringstream out;
    write_coloured(out, bodies.world, bodies.overlaps, MeshFormat::html);
    const std::string page = out.str();
    EXPECT_TRUE(contains(page, "1 overlap of 2 bodies"));
    for (const char* const entry : {"inside another body", "outside", "crossing of surfaces"})
        EXPECT_TRUE(contains(page, entry)) << entry;
    const std::int64_t opaque = 3 * bodies.ply().triangle_count();
    EXPECT_TRUE(contains(page, "\"opaque\": " + std::to_string(opaque) + ", \"opacity\": 0.2}"));
}

TEST(ColouredOverlaps, unsuitable_formats_and_results_are_refused) {
    const Folder folder;
    OverlappingBodies bodies({box({0, 0, 0}, {2, 2, 2}), box({1, 1.25, 0.5}, {3, 3, 1.5})});
    const auto refused = [&](const std::string& name) {
        const Error error = error_of([&] { write_coloured(folder / name, bodies.world, bodies.overlaps); });
        EXPECT_EQ(error.code, ErrorCode::invalid_argument) << name;
        EXPECT_FALSE(fs::exists(folder / name));
        return std::string(error.what());
    };
    EXPECT_TRUE(contains(refused("a.stl"), "coloured meshes are written as .ply, .obj, .glb, .3mf or .html"));
    std::ostringstream out;
    const auto to_stream = [&] { write_coloured(out, bodies.world, bodies.overlaps, MeshFormat::obj); };
    EXPECT_EQ(error_of(to_stream).code, ErrorCode::invalid_argument);
    bodies.overlaps.bodies[0].second = 2;
    EXPECT_TRUE(contains(refused("a.glb"), "the overlaps are not those of this world"));
    bodies.overlaps = {};
    bodies.overlaps.any = true;
    EXPECT_TRUE(contains(refused("a.glb"), "have no rows"));
}

TEST(TrianglePieces, areas_of_pieces_sum_to_the_triangle_and_pieces_do_not_cross_segments) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    for (int round = 0; round < 200; ++round) {
        std::vector<Vec3d> points{{0, 0, 0}, {3, 1, 2}, {1, 4, -1}};
        const std::vector<Vec3d> corners = points;
        const auto inside = [&] {
            const double u = share(random), v = share(random) * (1 - u);
            return corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
        };
        std::vector<CutSegment> segments;
        for (int s = 0; s < round % 7; ++s) segments.push_back({inside(), inside()});
        const std::vector<CutPiece> pieces = cut_triangle(points, {0, 1, 2}, segments);
        const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
        const auto point = [&](std::int32_t i) { return points[static_cast<std::size_t>(i)]; };
        double area = 0;
        for (const CutPiece& piece : pieces) {
            for (std::size_t k = 2; k < piece.size(); ++k)
                area += dot(normal, cross(point(piece[k - 1]) - point(piece[0]), point(piece[k]) - point(piece[0])));
            for (const auto& [p, q] : segments) {
                const Vec3d across = cross(normal, q - p);
                for (int tenth = 1; tenth < 10; ++tenth) {
                    const Vec3d on_segment = p + 0.1 * tenth * (q - p);
                    bool is_left = false, is_right = false, is_inside = true;
                    for (std::size_t k = 0; k < piece.size(); ++k) {
                        const Vec3d a = point(piece[k]), b = point(piece[(k + 1) % piece.size()]);
                        is_left |= dot(across, a - p) > 1e-9;
                        is_right |= dot(across, a - p) < -1e-9;
                        is_inside &= dot(normal, cross(b - a, on_segment - a)) > 1e-9;
                    }
                    EXPECT_FALSE(is_left && is_right && is_inside) << round;
                }
            }
        }
        EXPECT_NEAR(area, dot(normal, normal), 1e-9 * dot(normal, normal)) << round;
    }
}

TEST(PictureWindings, winding_counts_how_often_a_surface_encloses_a_point) {
    std::vector<Vec3d> points;
    std::vector<std::int32_t> corners;
    const auto add = [&](double low, double high, bool inside_out) {
        const auto first = static_cast<std::int32_t>(points.size());
        for (const double x : {low, high})
            for (const double y : {low, high})
                for (const double z : {low, high}) points.push_back({x, y, z});
        for (std::size_t i = 0; i < box_triangles.size(); i += 3)
            for (const std::size_t k : {i, inside_out ? i + 2 : i + 1, inside_out ? i + 1 : i + 2})
                corners.push_back(first + box_triangles[k]);
    };
    add(0, 8, false), add(1, 4, false), add(2, 3, true), add(5, 6, true);
    const PictureWindings rays(points, corners);
    const auto at = [&](double x) { return rays.at({x, x, x}); };  // on diagonals: rays meet edges and corners
    EXPECT_EQ(at(-1), 0);
    EXPECT_EQ(at(0.5), 1);
    EXPECT_EQ(at(1.5), 2);
    EXPECT_EQ(at(2.5), 1) << "a cavity in one of two";
    EXPECT_EQ(at(5.5), 0);
    EXPECT_EQ(at(9), 0);
    EXPECT_EQ(PictureWindings({}, {}).at({0, 0, 0}), 0);
}

}  // namespace
}  // namespace crumple::io::test
