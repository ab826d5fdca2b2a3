// Study of the sweep direction and of the number of axes along which boxes are tested. [MZ] (the paper that the library
// follows: ARCHITECTURE.md) sec. 3 sweeps along the first principal component and tests boxes along the second one
// only. The library tests the third one, too, and rotates the second and the third one so that edges lie along them.
//
// The study has a simple sweep of its own, in float64 on one thread, so that only the axes differ. It sorts boxes by
// their start along the first axis, and tests pairs of boxes whose intervals overlap there along the other axes. For
// overlapping boxes it tests whether one triangle lies on one side of the other's plane, as triangle tests begin.
// Adjacent triangles are among the candidates.

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "geometry/edge_moment.h"
#include "report.h"
#include "studies/primitives.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

using Frame = std::array<Vec3d, 3>;

struct Way {
    const char* name;
    int fixed;  ///< coordinate axis (0, 1, 2) to sweep along, or one of the constants below
    bool third_axis;
};
constexpr int longest = -1;              ///< the coordinate axis along which centroids have the largest variance
constexpr int principal = -2;            ///< the principal components of the centroids
constexpr int principal_and_edges = -3;  ///< the same, rotated by turn_to_edges()
constexpr std::array ways{Way{"x", 0, true},
                          Way{"y", 1, true},
                          Way{"z", 2, true},
                          Way{"longest of x, y, z", longest, true},
                          Way{"PCA", principal, true},
                          Way{"PCA, turned to edges", principal_and_edges, true},
                          Way{"PCA, two axes", principal, false}};

struct Box {
    std::array<double, 3> low, high;
    const Primitive* primitive;
};

struct Counts {
    std::int64_t intervals = 0, boxes = 0, straddling = 0;
    void operator+=(const Counts& c) { intervals += c.intervals, boxes += c.boxes, straddling += c.straddling; }
};

Frame frame_of(const std::vector<const Primitive*>& members, int fixed) {
    const double share = 1.0 / static_cast<double>(std::max<std::size_t>(1, members.size()));
    Vec3d mean;
    for (const Primitive* p : members) mean = mean + share * p->centroid;
    SymmetricMatrix m;  // [MZ] eq. 1
    for (const Primitive* p : members) {
        const Vec3d d = p->centroid - mean;
        m.xx += share * d.x * d.x, m.xy += share * d.x * d.y, m.xz += share * d.x * d.z;
        m.yy += share * d.y * d.y, m.yz += share * d.y * d.z, m.zz += share * d.z * d.z;
    }
    if (fixed == principal || fixed == principal_and_edges) {
        PrincipalAxes axes = principal_axes(m);
        if (fixed == principal_and_edges) {
            EdgeMoment moment;
            for (const Primitive* p : members) moment.add_triangle(p->corner[0], p->corner[1], p->corner[2], axes);
            turn_to_edges(axes, moment);
        }
        return {axes.axis[0], axes.axis[1], axes.axis[2]};
    }
    if (fixed == longest) fixed = m.xx >= m.yy && m.xx >= m.zz ? 0 : m.yy >= m.zz ? 1 : 2;
    Frame frame;
    for (int i = 0; i < 3; ++i) frame[static_cast<std::size_t>(i)][(fixed + i) % 3] = 1;
    return frame;
}

bool one_side(const Primitive& of, const Primitive& p) {
    const Vec3d n = cross(of.corner[1] - of.corner[0], of.corner[2] - of.corner[0]);
    const double a = dot(n, p.corner[0] - of.corner[0]), b = dot(n, p.corner[1] - of.corner[0]),
                 c = dot(n, p.corner[2] - of.corner[0]);
    return (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
}

Counts sweep(const std::vector<const Primitive*>& members, const Way& way) {
    const Frame frame = frame_of(members, way.fixed);
    std::vector<Box> boxes;
    boxes.reserve(members.size());
    for (const Primitive* p : members) {
        Box& box = boxes.emplace_back(Box{{}, {}, p});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double a = dot(frame[axis], p->corner[0]), b = dot(frame[axis], p->corner[1]),
                         c = dot(frame[axis], p->corner[2]);
            box.low[axis] = std::min({a, b, c});
            box.high[axis] = std::max({a, b, c});
        }
    }
    std::ranges::sort(boxes, {}, [](const Box& box) { return box.low[0]; });
    Counts counts;
    for (auto a = boxes.begin(); a != boxes.end(); ++a) {
        for (auto b = a + 1; b != boxes.end() && b->low[0] <= a->high[0]; ++b) {
            ++counts.intervals;
            if (a->low[1] > b->high[1] || b->low[1] > a->high[1]) continue;
            if (way.third_axis && (a->low[2] > b->high[2] || b->low[2] > a->high[2])) continue;
            ++counts.boxes;
            if (!one_side(*a->primitive, *b->primitive) && !one_side(*b->primitive, *a->primitive)) ++counts.straddling;
        }
    }
    return counts;
}

/// Returns the mesh of a workload, or the union of both meshes of a workload of two.
io::TriangleMesh one_soup(const Workload& workload) {
    if (workload.query != Query::between) return workload.a;
    std::vector<double> vertices = coordinates<double>(workload.a);
    const auto offset = static_cast<std::int32_t>(vertices.size() / 3);
    const std::vector<double> others = coordinates<double>(workload.b);
    vertices.insert(vertices.end(), others.begin(), others.end());
    io::TriangleMesh soup{std::move(vertices), workload.a.triangles, {}};
    for (const std::int32_t corner : workload.b.triangles) soup.triangles.push_back(offset + corner);
    return soup;
}

nlohmann::json compare_axes(const Workload& workload, int parts, const Effort& effort) {
    Detector detector;
    const io::TriangleMesh mesh = one_soup(workload);
    const std::vector<Primitive> primitives = primitives_of(mesh);
    std::vector<std::vector<const Primitive*>> members;
    std::vector<std::uint64_t> masks(primitives.size());
    for (const Part& part : detector.partition(mesh.view(), {}, parts)) {
        std::vector<const Primitive*>& list = members.emplace_back();
        for (const std::int32_t t : part.mesh.ids) {
            list.push_back(&primitives[static_cast<std::size_t>(t)]);
            masks[static_cast<std::size_t>(t)] |= std::uint64_t{1} << part.index;
        }
    }
    std::int64_t colliding = 0;  // counted like candidates: once in each part that has both triangles
    for (const Pair& pair : detector.find(mesh.view()).pairs)
        colliding += std::popcount(masks[static_cast<std::size_t>(pair.a)] & masks[static_cast<std::size_t>(pair.b)]);

    std::array<Counts, ways.size()> counts;
    std::vector<Contestant> contestants;
    for (std::size_t i = 0; i < ways.size(); ++i) {
        contestants.push_back({ways[i].name,
                               "",
                               "",
                               [&, i] {
                                   counts[i] = {};
                                   for (const auto& list : members) counts[i] += sweep(list, ways[i]);
                               },
                               {}});
    }
    const std::vector<Times> times = race(contestants, effort);
    Table table(fmt::format("sweep direction: {}, {} parts, plain sweep, one thread", workload.name, parts),
                {"direction", "interval overlaps", "candidates", "false positives", "ms", "quartiles"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const Summary time = times[i].summary();
        table.row({ways[i].name, std::to_string(counts[i].intervals), std::to_string(counts[i].boxes),
                   std::to_string(counts[i].boxes - colliding), number(time.median), range(time)});
        rows.push_back({{"direction", ways[i].name},
                        {"interval_overlaps", counts[i].intervals},
                        {"candidates", counts[i].boxes},
                        {"false_positives", counts[i].boxes - colliding},
                        {"planes_straddled", counts[i].straddling},
                        {"milliseconds", to_json(time)}});
    }
    table.print();
    return {{"workload", workload.name}, {"parts", parts}, {"colliding", colliding}, {"ways", std::move(rows)}};
}

}  // namespace

nlohmann::json study_axes(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes =
        choose_scenes(settings, {"cloth_ball92", "227", "balls16_18", "Generic_Twin_right", "ember_016"},
                      {"cloth", "bodies", "needles:20000"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000"};
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        for (const int parts : {1, 2, 32}) rows.push_back(compare_axes(workload, parts, settings.effort));
    }
    return rows;
}

}  // namespace crumple::benchmark
