// Study of the options of nearness: cost of a radius per vertex, of excluding rings of neighbours, and of a rest shape,
// compared with one radius for all, on one thread; also the cost of closest points, and of stencils. Radii of vertices
// are either all half of the one radius, so that the list of pairs is the same, or differ from vertex to vertex.

#include <fmt/format.h>

#include <memory>
#include <optional>

#include "crumple/stencils.h"
#include "report.h"
#include "studies/feature_queries.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

struct NamedQuery {
    std::string name;
    ProximityQuery query;
    std::optional<StencilOptions> stencils = {};  ///< also makes stencils
};

/// Returns pseudo-random multiples of most / 8, up to `most`: the same radii on every machine.
std::vector<double> uneven(std::size_t count, double most) {
    std::vector<double> radii(count);
    for (std::size_t i = 0; i < count; ++i) radii[i] = most * static_cast<double>(1 + (i * 2654435761u >> 16) % 8) / 8;
    return radii;
}

nlohmann::json study(const Step& step, const Effort& effort) {
    const MeshView mesh = step.start.view();
    const auto vertices = static_cast<std::size_t>(mesh.vertices.rows);
    const std::vector<double> equal(vertices, 0.5 * step.radius), different = uneven(vertices, 0.5 * step.radius);
    std::vector<NamedQuery> all{{"one radius", {.radius = step.radius}},
                                {"radii of half of it", {.radii = equal}},
                                {"radii of a sixteenth to a half", {.radii = different}}};
    for (const std::int32_t rings : {1, 2, 3})
        all.push_back({fmt::format("{} rings", rings), {.radius = step.radius, .rings = rings}});
    all.push_back(
        {"the end for a rest shape", {.radius = step.radius, .rest = step.end_view(), .rest_radius = step.radius}});
    all.push_back({"closest points", {.radius = step.radius, .closest = true}});
    for (const bool reduced : {false, true}) {
        const std::string name = reduced ? "closest points, reduced stencils" : "closest points, stencils";
        const StencilOptions stencils{.reduced = reduced, .threads = 1};
        all.push_back({name, {.radius = step.radius, .closest = true}, stencils});
    }

    std::vector<Contestant> contestants;
    std::vector<std::shared_ptr<Detector>> detectors;
    for (const NamedQuery& asked : all) {
        const auto detector = std::make_shared<Detector>(Options{.threads = 1});
        detectors.push_back(detector);
        const auto find = [=] {
            const Proximities& found = detector->find(mesh, asked.query);
            if (asked.stencils) stencils(mesh, found, *asked.stencils);
        };
        contestants.push_back({asked.name, "", "", find, {}});
    }
    const std::vector<Times> times = race(contestants, effort);
    Table table(step.name, {"query", "ms", "quartiles", "times one radius", "found"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Summary time = times[i].summary(), relative = ratio(times[i], times[0]);
        const std::int64_t found = detectors[i]->find(mesh, all[i].query).count;
        table.row({all[i].name, number(time.median), range(time), number(relative.median), std::to_string(found)});
        rows.push_back({{"asked", all[i].name},
                        {"milliseconds", to_json(time)},
                        {"relative", to_json(relative)},
                        {"found", found}});
    }
    table.print();
    return {{"step", step.name}, {"questions", rows}};
}

}  // namespace

nlohmann::json study_near_filters(const StudySettings& settings) {
    std::vector<std::string> names = settings.scenes.empty() ? steps() : settings.scenes;
    if (settings.quick && names.size() > 2) names.resize(2);
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& name : names) rows.push_back(study(load_step(name), settings.effort));
    return rows;
}

}  // namespace crumple::benchmark
