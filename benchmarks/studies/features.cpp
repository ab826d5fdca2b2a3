// Study of motion and nearness: time of each stage on one thread, pairs and tests left by each filter, and the gain
// from threads and instruction sets. A test is a pair of features (a vertex and a face, or two edges) of a pair of
// triangles.

#include <fmt/format.h>

#include "report.h"
#include "studies/feature_queries.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

/// Measures the median milliseconds of each stage and of the whole call over `calls` warm calls, and the counts. Adds a
/// row to both tables, and returns the figures.
nlohmann::json stages(const Step& step, FeatureQueryKind query, int calls, Table& times, Table& counts) {
    Detector detector({.threads = 1});
    std::array<std::vector<double>, stage_count> stage;
    std::vector<double> totals;
    Statistics last;
    for (int call = 0; call <= calls; ++call) {
        last = ask(detector, step, query);
        if (call == 0) continue;  // warm-up
        for (std::size_t s = 0; s < stage.size(); ++s) stage[s].push_back(last.stage_milliseconds[s]);
        totals.push_back(last.milliseconds);
    }
    const std::string label = fmt::format("{}: {}", step.name, name_of(query));
    nlohmann::json row{{"step", step.name}, {"question", name_of(query)}, {"simd", last.simd}};
    std::vector<std::string> cells{label};
    for (std::size_t s = 0; s < stage.size(); ++s) {
        const double median = summarise(stage[s]).median;
        cells.push_back(number(median));
        row["milliseconds"][stage_name(static_cast<Stage>(s))] = median;
    }
    const double total = summarise(totals).median;
    cells.push_back(number(total));
    row["milliseconds"]["total"] = total;
    times.row(cells);

    const std::pair<const char*, std::int64_t> counted[]{
        {"triangles", last.triangles},     {"box_overlaps", last.box_overlaps}, {"tests", last.edge_tests},
        {"tests_left", last.double_tests}, {"rational", last.rational_tests},   {"found", last.pairs},
    };
    cells = {label};
    for (const auto& [name, count] : counted) {
        cells.push_back(std::to_string(count));
        row[name] = count;
    }
    counts.row(cells);
    return row;
}

nlohmann::json ways(const Step& step, FeatureQueryKind query, const Effort& effort) {
    const std::vector<FeatureWay> all = feature_ways();
    std::vector<Contestant> contestants;
    for (const FeatureWay& way : all) contestants.push_back(asks(way.options, step, query, way.name));
    const std::vector<Times> times = race(contestants, effort);
    Table table(fmt::format("{}: {}", step.name, name_of(query)), {"way", "ms", "quartiles", "times 1 thread"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Summary time = times[i].summary(), relative = ratio(times[i], times[0]);
        table.row({all[i].name, number(time.median), range(time), number(relative.median)});
        rows.push_back({{"way", all[i].name}, {"milliseconds", to_json(time)}, {"relative", to_json(relative)}});
    }
    table.print();
    return rows;
}

}  // namespace

nlohmann::json study_features(const StudySettings& settings) {
    std::vector<std::string> names = settings.scenes.empty() ? steps() : settings.scenes;
    if (settings.quick && names.size() > 2) names.resize(2);
    std::vector<std::string> header{"step"};
    for (int s = 0; s < stage_count; ++s) header.emplace_back(stage_name(static_cast<Stage>(s)));
    header.emplace_back("total");
    Table times("stages, ms on one thread", header);
    Table counts("counts", {"step", "triangles", "box overlaps", "tests", "left by filters", "by rationals", "found"});
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& name : names) {
        const Step step = load_step(name);
        for (const FeatureQueryKind query : feature_queries) {
            rows.push_back(stages(step, query, settings.effort.rounds, times, counts));
            rows.back()["ways"] = ways(step, query, settings.effort);
        }
    }
    times.print();
    counts.print();
    return rows;
}

}  // namespace crumple::benchmark
