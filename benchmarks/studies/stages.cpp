// Study of the time of each stage and of the pairs left by each filter. It uses one thread, so that the stages' times
// add up to the time of the call, except for a few per cent that are spent between stages.

#include <fmt/format.h>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {

nlohmann::json study_stages(const StudySettings& settings) {
    const std::vector<std::string> scenes = choose_scenes(
        settings, {"cloth_ball92", "balls16_18", "227", "Generic_Twin_right", "ember_016", "ember_260", "ember_406"},
        {"cloth", "bodies", "needles", "five_decades", "ground", "fans", "between:bodies"});
    std::vector<std::string> time_header{"scene"};
    for (int s = 0; s < stage_count; ++s) time_header.emplace_back(stage_name(static_cast<Stage>(s)));
    time_header.emplace_back("total");
    Table times("stages, ms on one thread", time_header);
    Table counts("counts", {"scene", "clusters", "leaves", "members", "interval tests", "box overlaps", "edge tests",
                            "double tests", "exact tests", "rational tests", "pairs"});
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene : scenes) {
        const Workload workload = load(scene);
        const MeshView a = workload.a.view(), b = workload.b.view();
        Options options;
        options.threads = 1;
        Detector detector(options);
        std::array<std::vector<double>, stage_count> stages;
        std::vector<double> totals;
        Statistics last;
        for (int call = 0; call < 3 * settings.effort.rounds; ++call) {
            last = workload.query == Query::between ? detector.find({a, b}).statistics : detector.find(a).statistics;
            if (call == 0) continue;  // warm-up
            for (std::size_t s = 0; s < stages.size(); ++s) stages[s].push_back(last.stage_milliseconds[s]);
            totals.push_back(last.milliseconds);
        }
        std::vector<std::string> cells{scene};
        nlohmann::json row{{"workload", scene}};
        for (std::size_t s = 0; s < stages.size(); ++s) {
            const double median = summarise(stages[s]).median;
            cells.push_back(number(median));
            row["milliseconds"][stage_name(static_cast<Stage>(s))] = median;
        }
        const double total = summarise(totals).median;
        cells.push_back(number(total));
        row["milliseconds"]["total"] = total;
        times.row(cells);

        const std::pair<const char*, std::int64_t> counted[]{{"clusters", last.clusters},
                                                             {"leaves", last.leaves},
                                                             {"members", last.members},
                                                             {"interval_tests", last.interval_tests},
                                                             {"box_overlaps", last.box_overlaps},
                                                             {"edge_tests", last.edge_tests},
                                                             {"double_tests", last.double_tests},
                                                             {"exact_tests", last.exact_tests},
                                                             {"rational_tests", last.rational_tests},
                                                             {"pairs", last.pairs}};
        cells = {scene};
        for (const auto& [name, count] : counted) {
            cells.push_back(std::to_string(count));
            row[name] = count;
        }
        counts.row(cells);
        rows.push_back(std::move(row));
    }
    times.print();
    counts.print();
    return rows;
}

}  // namespace crumple::benchmark
