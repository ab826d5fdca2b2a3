// Study of the number of clusters. [MZ] (the paper that the library follows: ARCHITECTURE.md) sec. 6.1 splits a scene
// into two clusters, or four if objects are far apart, and sweeps each of them as a whole. The library splits clusters
// further, down to leaves that fit into a cache. Both ways run the same code, with different options. The study also
// compares the size of a list of all overlapping intervals, which [MZ] fig. 2 allocates, with the detector's peak
// memory.

#include <fmt/format.h>

#include <limits>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

nlohmann::json compare_cuts(const Workload& workload, const Effort& effort) {
    struct Cut {
        std::string name;
        Options options;
    };
    std::vector<Cut> cuts{{"leaves (default)", {}}};
    for (const int clusters : {1, 2, 4})
        cuts.push_back({fmt::format("{} whole", clusters),
                        {.clusters = clusters, .leaf_size = std::numeric_limits<int>::max() / 4}});

    std::vector<Contestant> contestants;
    for (const Cut& cut : cuts) {
        for (const int threads : {1, 0}) {
            Options options = cut.options;
            options.threads = threads;
            contestants.push_back(crumple_with(options, workload, cut.name + (threads ? ", 1 thread" : ", all")));
        }
    }
    const std::vector<Times> times = race(contestants, effort);
    Table table(fmt::format("[MZ]'s cut: {}", workload.name), {"cut", "1 thread, ms", "all, ms", "interval overlaps",
                                                               "candidates", "list of intervals, MiB", "peak, MiB"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        Detector detector(cuts[i].options);
        const Statistics s = detector.find(workload.a.view()).statistics;
        const Summary one = times[2 * i].summary(), all = times[2 * i + 1].summary();
        const double predicted = static_cast<double>(s.interval_tests) * sizeof(Pair);
        table.row({cuts[i].name, number(one.median), number(all.median), std::to_string(s.interval_tests),
                   std::to_string(s.box_overlaps), number(predicted / 1048576),
                   number(static_cast<double>(s.peak_memory_bytes) / 1048576)});
        rows.push_back({{"cut", cuts[i].name},
                        {"one_thread", to_json(one)},
                        {"all_threads", to_json(all)},
                        {"clusters", s.clusters},
                        {"leaves", s.leaves},
                        {"members", s.members},
                        {"interval_overlaps", s.interval_tests},
                        {"candidates", s.box_overlaps},
                        {"pairs", s.pairs},
                        {"predicted_bytes", predicted},
                        {"peak_bytes", s.peak_memory_bytes}});
    }
    table.print();
    return {{"workload", workload.name}, {"triangles", workload.triangle_count()}, {"cuts", std::move(rows)}};
}

}  // namespace

nlohmann::json study_two_clusters(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes = choose_scenes(
        settings, {"cloth_ball92", "227", "balls16_18", "Generic_Twin_right"}, {"cloth", "bodies", "needles"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000"};
    for (const std::string& name : scenes) rows.push_back(compare_cuts(load(name), settings.effort));
    return rows;
}

}  // namespace crumple::benchmark
