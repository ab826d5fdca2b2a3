// Study of a ground: two triangles of twenty times the scene's size beneath a cloth. They belong to every cluster,
// their intervals overlap all others, and they make any bound useless that is derived from the largest triangle. The
// cloth is compared with the scene `ground`, whose ground cuts through the cloth's hem. To any other scene the study
// adds a ground that touches nothing.

#include <fmt/format.h>

#include <algorithm>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

constexpr double limit = 1.3;  // aim for the largest time with a ground, as a multiple of the time without it

/// Returns the workload with two triangles added just below its mesh.
Workload with_ground(Workload workload) {
    std::visit(
        [&](auto& xyz) {
            using Scalar = typename std::decay_t<decltype(xyz)>::value_type;
            Scalar low = xyz[2], reach = 0;
            for (std::size_t i = 0; i < xyz.size(); ++i) {
                if (i % 3 == 2) low = std::min(low, xyz[i]);
                reach = std::max(reach, std::abs(xyz[i]));
            }
            const auto first = static_cast<std::int32_t>(xyz.size() / 3);
            const Scalar far = 20 * reach, height = low - reach / 1000;
            xyz.insert(xyz.end(), {-far, -far, height, far, -far, height, far, far, height, -far, far, height});
            auto& triangles = workload.a.triangles;
            triangles.insert(triangles.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
        },
        workload.a.vertices);
    workload.name += " with ground";
    return workload;
}

}  // namespace

nlohmann::json study_ground(const StudySettings& settings) {
    Table table(fmt::format("ground, limit {} times the scene without", limit),
                {"scene", "without, ms", "with", "ms", "ratio", "quartiles"});
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene : choose_scenes(settings, {"cloth", "cloth_ball92"}, {"cloth"})) {
        const Workload bare = load(scene), grounded = scene == "cloth" ? load("ground") : with_ground(bare);
        const Contestant contestants[]{crumple_with({}, bare, bare.name), crumple_with({}, grounded, grounded.name)};
        const std::vector<Times> times = race(contestants, settings.effort);
        const Summary without = times[0].summary(), with = times[1].summary(), factor = ratio(times[1], times[0]);
        table.row({bare.name, number(without.median), grounded.name, number(with.median), number(factor.median),
                   range(factor)});
        rows.push_back({{"workload", bare.name},
                        {"without", to_json(without)},
                        {"with", to_json(with)},
                        {"ratio", to_json(factor)}});
    }
    table.print();
    return rows;
}

}  // namespace crumple::benchmark
