#include "checks/body_report.h"

#include <algorithm>
#include <future>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace crumple::checks {
namespace {

std::int64_t count_unused_vertices(const io::TriangleMesh& mesh) {
    std::vector<bool> used(static_cast<std::size_t>(mesh.vertex_count()));
    for (const std::int32_t corner : mesh.triangles) used[static_cast<std::size_t>(corner)] = true;
    return std::count(used.begin(), used.end(), false);
}

}  // namespace

Point point_of(const io::TriangleMesh& mesh, std::int32_t vertex) {
    const auto at = 3 * static_cast<std::size_t>(vertex);
    return std::visit(
        [at](const auto& xyz) {
            return Point{double{xyz[at]}, double{xyz[at + 1]}, double{xyz[at + 2]}};
        },
        mesh.vertices);
}

std::string text_of_point(const io::TriangleMesh& mesh, const Point& p) {
    if (mesh.precision() == ScalarType::float64) return fmt::format("{}", fmt::join(p, " "));
    return fmt::format("{} {} {}", static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
}

std::string describe(const io::TriangleMesh& mesh, const Edge& edge) {
    return fmt::format("{}-{}, from ({}) to ({})", edge.a, edge.b, text_of_point(mesh, point_of(mesh, edge.a)),
                       text_of_point(mesh, point_of(mesh, edge.b)));
}

std::optional<BoundingBox> box_of(const io::TriangleMesh& mesh) {
    if (mesh.vertex_count() == 0) return std::nullopt;
    BoundingBox box{point_of(mesh, 0), point_of(mesh, 0)};
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t i = 0; i < xyz.size(); i += 3)
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    box.low[axis] = std::min(box.low[axis], double{xyz[i + axis]});
                    box.high[axis] = std::max(box.high[axis], double{xyz[i + axis]});
                }
        },
        mesh.vertices);
    return box;
}

io::TriangleMesh posed_body(const io::WorldMesh& world, std::size_t body) {
    const io::NamedBody& posed = world.bodies[body];
    const io::TriangleMesh& shape = world.shapes[static_cast<std::size_t>(posed.shape)];
    if (posed.pose == Pose{}) return shape;
    io::WorldMesh alone;
    alone.bodies.push_back(posed);
    alone.shapes.push_back(shape);
    alone.bodies[0].shape = 0;
    alone.unit = world.unit;
    return io::posed_mesh(alone);
}

BodyReport::BodyReport(const io::TriangleMesh& mesh, bool lists_open_edges)
    : vertices(mesh.vertex_count()),
      unused(count_unused_vertices(mesh)),
      triangles(mesh.triangle_count()),
      precision(mesh.precision() == ScalarType::float32 ? "float32" : "float64"),
      box(box_of(mesh)) {
    // Runs the slowest reports in two threads of their own.
    auto finds_duplicated = std::async(std::launch::async, [&] { return duplicated_triangles(mesh); });
    auto reports_edges = std::async(std::launch::async, [&] {
        edges = report_edges(mesh);
        if (has_inside()) volume = signed_volume(mesh);
    });
    degenerate = degenerate_triangles(mesh);
    components = label_components(mesh, labels);
    reports_edges.get();
    duplicated = finds_duplicated.get();
    if (lists_open_edges) listed = open_edges(mesh.view());
}

nlohmann::json json_of(const io::TriangleMesh& mesh, const Edge& edge) {
    return {{"vertices", {edge.a, edge.b}}, {"points", {point_of(mesh, edge.a), point_of(mesh, edge.b)}}};
}

nlohmann::json json_of(const std::string& name, const io::TriangleMesh& mesh, const BodyReport& report) {
    using Json = nlohmann::json;
    Json open = Json::array();
    for (std::size_t i = 0; i < std::min(BodyReport::most_edges, report.edges.open.size()); ++i)
        open.push_back(json_of(mesh, report.edges.open[i]));
    Json listed = Json::array();
    for (const OpenEdge& edge : report.listed ? report.listed->span() : std::span<const OpenEdge>()) {
        listed.push_back(json_of(mesh, edge.edge));
        listed.back()["triangle"] = edge.triangle;
    }
    Json flipped;
    if (const auto& found = report.edges.flipped) {
        flipped = json_of(mesh, found->edge);
        flipped["triangles"] = {found->first, found->second};
    }
    Json result{{"name", name},
                {"vertices", report.vertices},
                {"unused_vertices", report.unused},
                {"triangles", report.triangles},
                {"precision", report.precision},
                {"box", report.box ? Json{{"low", report.box->low}, {"high", report.box->high}} : Json()},
                {"degenerate_triangles", report.degenerate},
                {"duplicated_triangles", report.duplicated},
                {"open_edges", {{"count", report.edges.open.size()}, {"first", open}}},
                {"holes", report.edges.holes},
                {"non_manifold_edges", report.edges.non_manifold},
                {"consistently_oriented", !report.edges.flipped},
                {"first_flipped_edge", flipped},
                {"connected_components", report.components},
                {"closed", report.triangles > 0 && report.edges.closed},
                {"volume", report.volume ? Json(*report.volume) : Json()},
                {"inside_out", report.is_inside_out()},
                {"sound", report.is_sound()}};
    if (report.listed) result["list_of_open_edges"] = std::move(listed);
    return result;
}

}  // namespace crumple::checks
