// Study of Options::method in whole searches: sweep directions and rules of membership, on the same scene. The studies
// `axes` and `membership` compare more variants, in programs of their own. Times of rules of membership include the
// detector's comparison with the default rule.

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <memory>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

struct Variant {
    const char* name;
    Method method;
};

std::vector<Variant> variants() {
    const auto threshold = [](double u) { return Method{.membership = Membership::threshold, .threshold = u}; };
    return {{"default", {}},
            {"sweep x", {.sweep = SweepDirection::x}},
            {"sweep y", {.sweep = SweepDirection::y}},
            {"sweep z", {.sweep = SweepDirection::z}},
            {"equation 5", {.membership = Membership::equation_5}},
            {"threshold 0.1", threshold(0.1)},
            {"threshold 0.3", threshold(0.3)},
            {"nearest only", threshold(1)}};
}

/// Searches the workload. The result is valid until the detector's next call.
const Intersections& find(Detector& detector, const Workload& workload) {
    return workload.query == Query::between ? detector.find({workload.a.view(), workload.b.view()})
                                            : detector.find(workload.a.view());
}

nlohmann::json compare_methods(const Workload& workload, int clusters, const Effort& effort) {
    const std::vector<Variant> all = variants();
    std::vector<std::unique_ptr<Detector>> detectors;
    std::vector<Contestant> contestants;
    for (const Variant& variant : all) {
        detectors.push_back(std::make_unique<Detector>(
            Options{.backend = Backend::cpu, .threads = 1, .clusters = clusters, .method = variant.method}));
        contestants.push_back(
            {variant.name, "", "", [&, detector = detectors.back().get()] { find(*detector, workload); }, {}});
    }
    const std::vector<Times> times = race(contestants, effort);
    const Array<Pair> whole = find(*detectors.front(), workload).pairs;
    Table table(fmt::format("method: {}, {} clusters, {} pairs, one thread", workload.name, clusters, whole.size()),
                {"method", "members", "interval tests", "candidates", "pairs lost", "complete", "ms", "times default"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Intersections& found = find(*detectors[i], workload);
        std::vector<Pair> lost;
        std::set_difference(whole.begin(), whole.end(), found.pairs.begin(), found.pairs.end(),
                            std::back_inserter(lost));
        const Statistics& s = found.statistics;
        const Summary time = times[i].summary(), relative = ratio(times[i], times.front());
        table.row({all[i].name, std::to_string(s.members), std::to_string(s.interval_tests),
                   std::to_string(s.box_overlaps), std::to_string(lost.size()), s.complete ? "yes" : "no",
                   number(time.median), number(relative.median)});
        rows.push_back({{"method", all[i].name},
                        {"members", s.members},
                        {"interval_tests", s.interval_tests},
                        {"candidates", s.box_overlaps},
                        {"pairs_lost", lost.size()},
                        {"complete", s.complete},
                        {"milliseconds", to_json(time)},
                        {"relative", to_json(relative)}});
    }
    table.print();
    return {{"workload", workload.name},
            {"clusters", clusters},
            {"triangles", workload.triangle_count()},
            {"pairs", whole.size()},
            {"methods", std::move(rows)}};
}

}  // namespace

nlohmann::json study_method(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes = choose_scenes(settings, {"cloth_ball92", "227", "balls16_18", "five_decades"},
                                                    {"cloth", "bodies", "five_decades"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000", "five_decades:5000"};
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        for (const int clusters : {2, 16}) rows.push_back(compare_methods(workload, clusters, settings.effort));
    }
    return rows;
}

}  // namespace crumple::benchmark
