// CGAL's Polygon_mesh_processing: self_intersections, or does_self_intersect for a yes or no, with the kernel that
// CGAL's manual recommends, Exact_predicates_inexact_constructions. CGAL's meshes must be manifold, so other meshes are
// repaired before the timed calls: vertices are duplicated, faces keep their order. For repaired meshes CGAL's pairs
// may differ from crumple's, because CGAL treats copies of a vertex as different vertices. It reports a degenerate face
// f only as (f, f).

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <memory>
#include <utility>

#include "peers/peers.h"

namespace crumple::benchmark {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using FacePair = std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>;

struct State {
    SurfaceMesh mesh;
    std::vector<FacePair> found;
};

SurfaceMesh surface_mesh(const io::TriangleMesh& mesh, bool& repaired) {
    const std::vector<double> xyz = coordinates<double>(mesh);
    std::vector<Point> points;
    for (std::size_t v = 0; v < xyz.size(); v += 3) points.emplace_back(xyz[v], xyz[v + 1], xyz[v + 2]);
    std::vector<std::array<std::size_t, 3>> faces;
    for (std::size_t c = 0; c < mesh.triangles.size(); c += 3) {
        faces.push_back({static_cast<std::size_t>(mesh.triangles[c]), static_cast<std::size_t>(mesh.triangles[c + 1]),
                         static_cast<std::size_t>(mesh.triangles[c + 2])});
    }
    repaired = !pmp::is_polygon_soup_a_polygon_mesh(faces);
    if (repaired) pmp::orient_polygon_soup(points, faces);
    SurfaceMesh result;
    pmp::polygon_soup_to_polygon_mesh(points, faces, result);
    return result;
}

template <class Concurrency>
void add(const Workload& workload, const std::shared_ptr<State>& state, std::string way,
         std::vector<Contestant>& contestants) {
    Contestant contestant{"CGAL", std::move(way), "exact pairs", {}, {}};
    if (workload.query == Query::any) {
        contestant.computes = "exact yes or no";
        contestant.call = [state] { pmp::does_self_intersect<Concurrency>(state->mesh); };
    } else {
        contestant.call = [state] {
            state->found.clear();
            pmp::self_intersections<Concurrency>(state->mesh, std::back_inserter(state->found));
        };
        contestant.pairs = [state] {
            std::vector<Pair> pairs;
            for (const auto& [a, b] : state->found)
                pairs.push_back({static_cast<std::int32_t>(a.idx()), static_cast<std::int32_t>(b.idx())});
            return pairs;
        };
    }
    contestants.push_back(std::move(contestant));
}

}  // namespace

std::vector<Contestant> cgal_contestants(const Workload& workload) {
    std::vector<Contestant> contestants;
    if (workload.query == Query::between) return contestants;
    const auto state = std::make_shared<State>();
    bool repaired = false;
    state->mesh = surface_mesh(workload.a, repaired);
    if (static_cast<std::int64_t>(state->mesh.number_of_faces()) != workload.a.triangle_count()) return contestants;
    const std::string note = repaired ? ", soup repaired" : "";
    add<CGAL::Sequential_tag>(workload, state, "sequential" + note, contestants);
    add<CGAL::Parallel_tag>(workload, state, "parallel" + note, contestants);
    return contestants;
}

}  // namespace crumple::benchmark
