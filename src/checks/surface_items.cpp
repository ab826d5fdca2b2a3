#include "checks/surface_items.h"

namespace crumple::checks {
namespace {

/// Sets box and centre of an item to those of some vertices of a mesh.
template <class Vertices>
void locate(const io::TriangleMesh& mesh, const Vertices& vertices, CheckItem& item) {
    for (const std::int32_t vertex : vertices) {
        const Point p = point_of(mesh, vertex);
        if (!item.box) item.box = BoundingBox{p, p};
        for (std::size_t k = 0; k < 3; ++k) {
            item.box->low[k] = std::min(item.box->low[k], p[k]);
            item.box->high[k] = std::max(item.box->high[k], p[k]);
        }
    }
    if (!item.box) return;
    item.centre = middle_of(*item.box);
}

void add_triangles(ItemKind kind, std::int32_t number, const io::TriangleMesh& mesh,
                   const std::vector<std::int32_t>& triangles, std::vector<CheckItem>& items) {
    if (triangles.empty()) return;
    CheckItem& item = items.emplace_back(CheckItem{kind, {number}});
    item.count = std::ssize(triangles);
    item.triangles = triangles;
    std::vector<std::int32_t> corners;
    for (const std::int32_t t : triangles)
        for (std::size_t k = 0; k < 3; ++k) corners.push_back(mesh.triangles[3 * static_cast<std::size_t>(t) + k]);
    locate(mesh, corners, item);
}

}  // namespace

void add_surface_items(std::int32_t number, const CheckedBody& body, std::vector<CheckItem>& items) {
    const BodyReport& report = body.report;
    if (report.triangles == 0) items.push_back({ItemKind::no_triangles, {number}});
    for (const BoundaryLoop& loop : body.loops) {
        CheckItem& item = items.emplace_back(CheckItem{ItemKind::hole, {number}});
        item.centre = loop.centre;
        item.box = loop.box;
        item.count = std::ssize(loop.edges);
        item.length = loop.length;
        item.edges = loop.edges;
    }
    if (report.edges.odd > 0)
        items.emplace_back(CheckItem{ItemKind::non_manifold_edges, {number}}).count = report.edges.odd;
    if (const auto& flipped = report.edges.flipped) {
        CheckItem& item = items.emplace_back(CheckItem{ItemKind::inconsistent_orientation, {number}});
        item.triangles = {flipped->first, flipped->second};
        locate(body.mesh, std::array{flipped->edge.a, flipped->edge.b}, item);
    }
    add_triangles(ItemKind::degenerate_triangles, number, body.mesh, report.degenerate, items);
    add_triangles(ItemKind::duplicated_triangles, number, body.mesh, report.duplicated, items);
}

}  // namespace crumple::checks
