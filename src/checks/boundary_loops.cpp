#include "checks/boundary_loops.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/disjoint_sets.h"

namespace crumple::checks {
namespace {

void measure(const io::TriangleMesh& mesh, BoundaryLoop& loop) {
    loop.centre = point_of(mesh, loop.edges[0].a);
    loop.box = {loop.centre, loop.centre};
    Point sum{};
    for (const Edge& edge : loop.edges) {
        const Point a = point_of(mesh, edge.a), b = point_of(mesh, edge.b);
        const double length = std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        loop.length += length;
        for (std::size_t k = 0; k < 3; ++k) {
            sum[k] += length * (a[k] / 2 + b[k] / 2);
            loop.box.low[k] = std::min({loop.box.low[k], a[k], b[k]});
            loop.box.high[k] = std::max({loop.box.high[k], a[k], b[k]});
        }
    }
    if (loop.length > 0)
        for (std::size_t k = 0; k < 3; ++k) loop.centre[k] = sum[k] / loop.length;
}

}  // namespace

std::vector<BoundaryLoop> find_boundary_loops(const io::TriangleMesh& mesh, std::span<const Edge> open) {
    DisjointSets sets(open.empty() ? 0 : static_cast<std::size_t>(mesh.vertex_count()));
    for (const Edge& edge : open) sets.join(edge.a, edge.b);
    std::map<std::int32_t, BoundaryLoop> loops;
    for (const Edge& edge : open) loops[sets.find(edge.a)].edges.push_back(edge);
    std::vector<BoundaryLoop> result;
    for (auto& [lowest, loop] : loops) {
        measure(mesh, loop);
        result.push_back(std::move(loop));
    }
    return result;
}

}  // namespace crumple::checks
