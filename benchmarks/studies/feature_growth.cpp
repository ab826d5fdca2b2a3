// Study of motion and nearness: time and memory over the number of triangles, on the procedural cloth. Motions and
// radii are in proportion to the mean edge length (step.h), so that the number of candidates is about proportional to
// the number of triangles. A time proportional to the number of triangles is therefore the best possible.

#include <fmt/format.h>

#include "report.h"
#include "studies/feature_queries.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

nlohmann::json grow(const std::string& scene, FeatureQueryKind query, const std::vector<int>& sizes,
                    const Effort& effort) {
    const std::vector<FeatureWay> ways = feature_ways();
    std::vector<std::string> header{"triangles", "box overlaps", "found"};
    for (const FeatureWay& way : ways) header.push_back(way.name + ", ms");
    for (const char* name : {"ns a triangle", "speed-up", "peak, MiB", "without result, bytes a triangle"})
        header.emplace_back(name);
    Table table(fmt::format("growth of {}: {}", name_of(query), scene), header);
    nlohmann::json rows = nlohmann::json::array();
    std::vector<double> triangles;
    std::vector<std::vector<double>> medians(ways.size());
    for (const int size : sizes) {
        const Step step = load_step(fmt::format("{}:{}", scene, size));
        const FeatureMemory memory = memory_of(step, query);
        std::vector<Contestant> contestants;
        for (const FeatureWay& way : ways) contestants.push_back(asks(way.options, step, query, way.name));
        const std::vector<Times> times = race(contestants, effort);
        Detector detector;
        const Statistics counts = ask(detector, step, query);
        const auto n = static_cast<double>(step.start.triangle_count());
        const double bytes = static_cast<double>(memory.peak - memory.answer) / n;
        triangles.push_back(n);
        std::vector<std::string> cells{fmt::format("{}", n), std::to_string(counts.box_overlaps),
                                       std::to_string(counts.pairs)};
        nlohmann::json row{{"triangles", n},
                           {"box_overlaps", counts.box_overlaps},
                           {"found", counts.pairs},
                           {"peak_bytes", memory.peak},
                           {"answer_bytes", memory.answer}};
        for (std::size_t w = 0; w < ways.size(); ++w) {
            const Summary time = times[w].summary();
            medians[w].push_back(time.median);
            cells.push_back(number(time.median));
            row[ways[w].name] = to_json(time);
        }
        const double one = medians[0].back(), all = medians[1].back();
        for (const double value : {1e6 * one / n, one / all, static_cast<double>(memory.peak) / 1048576, bytes})
            cells.push_back(number(value));
        table.row(cells);
        rows.push_back(std::move(row));
    }
    table.print();
    nlohmann::json exponents;
    for (std::size_t w = 0; w < ways.size(); ++w) {
        exponents[ways[w].name] = exponent(triangles, medians[w]);
        fmt::print("  time ~ triangles^{:.3f}, {}\n", exponents[ways[w].name].get<double>(), ways[w].name);
    }
    return {{"question", name_of(query)}, {"scene", scene}, {"sizes", rows}, {"exponents", exponents}};
}

}  // namespace

nlohmann::json study_feature_growth(const StudySettings& settings) {
    std::vector<int> sizes{10'000, 30'000, 100'000};
    if (!settings.quick) sizes.insert(sizes.end(), {300'000, 1'000'000, 2'000'000});
    const std::string scene = settings.scenes.empty() ? "cloth" : settings.scenes.front();
    nlohmann::json rows = nlohmann::json::array();
    for (const FeatureQueryKind query : feature_queries) rows.push_back(grow(scene, query, sizes, settings.effort));
    return rows;
}

}  // namespace crumple::benchmark
