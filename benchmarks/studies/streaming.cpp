// Study of Detector::stream, which delivers the result in blocks of rows, compared with Detector::find, which returns
// all rows at once: time, and the detector's peak memory.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

struct Way {
    std::string name;
    std::int64_t rows;
    Detector detector{};
    Statistics last{};
    std::int64_t blocks = 0;
};

nlohmann::json stream(const Workload& workload, const Effort& effort) {
    const MeshView a = workload.a.view(), b = workload.b.view();
    const bool between = workload.query == Query::between;
    Detector whole;
    const auto find = [&]() -> const Intersections& { return between ? whole.find({a, b}) : whole.find(a); };
    const std::int64_t pairs = find().statistics.pairs, at_once = find().statistics.peak_memory_bytes;
    std::vector<Way> ways;
    for (const int share : {1, 4, 16, 64})
        ways.push_back({fmt::format("blocks of 1/{}", share), std::max<std::int64_t>(1, pairs / share)});
    std::vector<Contestant> contestants{{"find", "", "", [&] { find(); }, {}}};
    for (Way& way : ways)
        contestants.push_back({way.name,
                               "",
                               "",
                               [&] {
                                   way.blocks = 0;
                                   const auto take = [&](const Intersections&) { ++way.blocks; };
                                   way.last = between ? way.detector.stream({a, b}, {}, take, way.rows)
                                                      : way.detector.stream(a, {}, take, way.rows);
                               },
                               {}});
    const std::vector<Times> times = race(contestants, effort);
    Table table(fmt::format("results in blocks: {}, {} pairs", workload.name, pairs),
                {"way", "blocks", "ms", "quartiles", "over find", "quartiles", "MiB"});
    nlohmann::json rows = nlohmann::json::array();
    const auto add = [&](const std::string& name, std::int64_t blocks, const Times& time, std::int64_t bytes) {
        const Summary all = time.summary(), over = ratio(time, times.front());
        table.row({name, std::to_string(blocks), number(all.median), range(all), number(over.median), range(over),
                   number(static_cast<double>(bytes) / (1 << 20))});
        rows.push_back({{"way", name},
                        {"blocks", blocks},
                        {"milliseconds", to_json(all)},
                        {"over_find", to_json(over)},
                        {"peak_memory_bytes", bytes}});
    };
    add("find", 1, times.front(), at_once);
    for (std::size_t i = 0; i < ways.size(); ++i)
        add(ways[i].name, ways[i].blocks, times[i + 1], ways[i].last.peak_memory_bytes);
    table.print();
    return {{"workload", workload.name}, {"pairs", pairs}, {"ways", std::move(rows)}};
}

}  // namespace

nlohmann::json study_streaming(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene :
         choose_scenes(settings, {"cloth_ball92", "balls16_18", "cloth:1000000"}, {"cloth", "bodies", "cloth:1000000"}))
        rows.push_back(stream(load(scene), settings.effort));
    return rows;
}

}  // namespace crumple::benchmark
