// Study of the membership of triangles in clusters: rules of [MZ] (the paper that the library follows: ARCHITECTURE.md)
// against two local rules, around the same centres.
//
// A triangle belongs to the cluster of its nearest centre. A rule defines to which other clusters it also belongs, so
// that pairs of triangles of different clusters are found. Let d_k be the distance of the triangle's centroid from
// centre k, d_min the least d_k, s_k the distance of the centroid from the plane that bisects the nearest centre and
// centre k, r the distance from the centroid to the farthest corner, R the largest r of the scene and r' the mean r. A
// triangle also belongs to cluster k under these rules:
//   nearest only         never
//   exactly two          [MZ] 5.1 literally: of the triangles of each other cluster, the one with the least s_k
//   two across           s_k <= 2 r': [MZ] 5.1 as a width, a band around the plane that is about two triangles wide
//   eq. 5, R in all      s_k <= R / 2: the band has the least width that [MZ] eq. 5 demands
//   eq. 5, R each side   s_k <= R: finds all pairs according to eq. 5
//   local 2r             d_k <= d_min + 2 r
//   bisector             s_k <= r: the rule of the library
// Each cluster is then searched as a scene of its own, on one thread, and the results are united. Their number shows
// how many pairs a rule loses. The time shows the cost of a rule, and includes pairs that are found in several
// clusters.

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>

#include "partition/part_centres.h"
#include "report.h"
#include "studies/primitives.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

using Masks = std::vector<std::uint64_t>;  // bit k: member of cluster k

/// Distances of one triangle's centroid from every centre (d_k) and from every bisecting plane (s_k), by cluster k.
struct Place {
    std::size_t nearest = 0;
    std::array<double, 64> distance, from_plane;
};

struct Scene {
    std::vector<Primitive> primitives;
    std::vector<Place> places;
    std::size_t clusters = 0;
    double largest_radius = 0, mean_radius = 0;
};

double length(Vec3d v) { return std::sqrt(dot(v, v)); }

/// Returns the centres that the library computes for `parts` parts, in the mesh's coordinates.
std::vector<Vec3d> centres_of(const io::TriangleMesh& mesh, int parts) {
    ParallelFor serial;
    SceneBuffers buffers;
    const crumple::PreparedScene scene = prepare_scene(mesh.view(), nullptr, false, serial, buffers);
    const PartCentres placed = place_parts(scene, parts, serial);
    const PartTree tree = placed.tree();
    std::vector<Vec3d> centres;
    for (int k = 0; k < parts; ++k) centres.push_back(tree.normalise.inverse(tree.level[0].centres[0].centre(k)));
    return centres;
}

Scene place(const io::TriangleMesh& mesh, const std::vector<Vec3d>& v) {
    Scene scene{primitives_of(mesh), {}, v.size(), 0, 0};
    for (const Primitive& p : scene.primitives) {
        Place& place = scene.places.emplace_back();
        for (std::size_t k = 0; k < v.size(); ++k) {
            place.distance[k] = length(p.centroid - v[k]);
            if (place.distance[k] < place.distance[place.nearest]) place.nearest = k;
        }
        const double d = place.distance[place.nearest];
        for (std::size_t k = 0; k < v.size(); ++k) {
            const double between = length(v[k] - v[place.nearest]);
            place.from_plane[k] =
                between > 0 ? (place.distance[k] * place.distance[k] - d * d) / (2 * between) : 0;  // s_k
        }
        scene.largest_radius = std::max(scene.largest_radius, p.radius);
        scene.mean_radius += p.radius / static_cast<double>(scene.primitives.size());
    }
    return scene;
}

using Joins = std::function<bool(const Primitive&, const Place&, std::size_t k)>;

Masks masks_by(const Scene& scene, const Joins& joins) {
    Masks masks(scene.places.size());
    for (std::size_t t = 0; t < masks.size(); ++t)
        for (std::size_t k = 0; k < scene.clusters; ++k)
            if (k == scene.places[t].nearest || joins(scene.primitives[t], scene.places[t], k))
                masks[t] |= std::uint64_t{1} << k;
    return masks;
}

Masks exactly_two(const Scene& scene) {
    Masks masks = masks_by(scene, [](auto&&...) { return false; });
    for (std::size_t m = 0; m < scene.clusters; ++m) {
        for (std::size_t k = 0; k < scene.clusters; ++k) {
            std::size_t closest = masks.size();
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t t = 0; t < masks.size(); ++t)
                if (k != m && scene.places[t].nearest == m && scene.places[t].from_plane[k] < least)
                    closest = t, least = scene.places[t].from_plane[k];
            if (closest < masks.size()) masks[closest] |= std::uint64_t{1} << k;
        }
    }
    return masks;
}

std::vector<std::pair<std::string, Masks>> rules(const Scene& scene) {
    const auto band = [&](double width) {
        return masks_by(scene,
                        [=](const Primitive&, const Place& p, std::size_t k) { return p.from_plane[k] <= width; });
    };
    return {{"nearest only", masks_by(scene, [](auto&&...) { return false; })},
            {"exactly two", exactly_two(scene)},
            {"two across", band(2 * scene.mean_radius)},
            {"eq. 5, R in all", band(scene.largest_radius / 2)},
            {"eq. 5, R each side", band(scene.largest_radius)},
            {"local 2r",
             masks_by(scene, [](const Primitive& t, const Place& p,
                                std::size_t k) { return p.distance[k] <= p.distance[p.nearest] + 2 * t.radius; })},
            {"bisector", masks_by(scene, [](const Primitive& t, const Place& p, std::size_t k) {
                 return p.from_plane[k] <= t.radius;
             })}};
}

/// Clusters as defined by masks, each with a mesh of its triangles and a detector of its own, which stays warm.
struct Parts {
    struct Part {
        std::vector<std::int32_t> triangles;
        io::TriangleMesh mesh;
        Detector detector{Options{.threads = 1}};
    };
    std::vector<Part> parts;
    std::int64_t members = 0;

    Parts(const io::TriangleMesh& mesh, const Masks& masks, std::size_t clusters) : parts(clusters) {
        for (std::size_t k = 0; k < clusters; ++k) {
            for (std::size_t t = 0; t < masks.size(); ++t)
                if (masks[t] >> k & 1) parts[k].triangles.push_back(static_cast<std::int32_t>(t));
            members += static_cast<std::int64_t>(parts[k].triangles.size());
            parts[k].mesh = extract(mesh, parts[k].triangles);
        }
    }
    void answer() {
        for (Part& part : parts) part.detector.find(part.mesh.view());
    }
    std::vector<Pair> pairs() {
        std::vector<Pair> all;
        for (Part& part : parts) {
            const auto id = [&](std::int32_t t) { return part.triangles[static_cast<std::size_t>(t)]; };
            for (const Pair& pair : part.detector.find(part.mesh.view()).pairs) all.push_back({id(pair.a), id(pair.b)});
        }
        normalise(all, Query::self);
        return all;
    }
};

nlohmann::json compare_rules(const Workload& workload, int clusters, const Effort& effort) {
    Detector detector;
    const Scene scene = place(workload.a, centres_of(workload.a, clusters));
    const Array<Pair> whole = detector.find(workload.a.view()).pairs;

    std::vector<std::unique_ptr<Parts>> answers;
    std::vector<Contestant> contestants;
    for (const auto& [rule, masks] : rules(scene)) {
        answers.push_back(std::make_unique<Parts>(workload.a, masks, scene.clusters));
        contestants.push_back({rule, "", "", [parts = answers.back().get()] { parts->answer(); }, {}});
    }
    const std::vector<Times> times = race(contestants, effort);

    Table table(fmt::format("membership: {}, {} clusters, {} pairs, one thread", workload.name, clusters, whole.size()),
                {"rule", "members added, %", "all parts, ms", "times bisector", "quartiles", "pairs lost"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        const std::vector<Pair> found = answers[i]->pairs();
        std::vector<Pair> lost;
        std::set_difference(whole.begin(), whole.end(), found.begin(), found.end(), std::back_inserter(lost));
        const Summary time = times[i].summary(), relative = ratio(times[i], times.back());
        const std::int64_t added = answers[i]->members - workload.triangle_count();
        table.row({contestants[i].name,
                   number(100.0 * static_cast<double>(added) / static_cast<double>(workload.triangle_count())),
                   number(time.median), number(relative.median), range(relative), std::to_string(lost.size())});
        rows.push_back({{"rule", contestants[i].name},
                        {"members_added", added},
                        {"milliseconds", to_json(time)},
                        {"relative", to_json(relative)},
                        {"pairs_lost", lost.size()}});
    }
    table.print();
    return {{"workload", workload.name},
            {"clusters", clusters},
            {"triangles", workload.triangle_count()},
            {"pairs", whole.size()},
            {"radius_largest_over_mean", scene.largest_radius / scene.mean_radius},
            {"rules", std::move(rows)}};
}

}  // namespace

nlohmann::json study_membership(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes = choose_scenes(settings, {"cloth_ball92", "227", "balls16_18", "five_decades"},
                                                    {"cloth", "bodies", "five_decades"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000", "five_decades:5000"};
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        for (const int clusters : {2, 16}) rows.push_back(compare_rules(workload, clusters, settings.effort));
    }
    return rows;
}

}  // namespace crumple::benchmark
