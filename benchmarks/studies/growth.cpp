// Study of time and memory over the number of triangles, on the procedural cloth, whose number of colliding pairs grows
// in proportion. A time proportional to the number of triangles is therefore the best possible. Sizes are timed one
// after another; for each size, calls on one thread and on all threads alternate.

#include <fmt/format.h>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

std::int64_t output_bytes(const Intersections& c) {
    return static_cast<std::int64_t>(c.pairs.capacity() * sizeof(Pair) + c.offsets.capacity() * sizeof(std::int64_t) +
                                     c.hit.capacity() + c.hit_second.capacity());
}

}  // namespace

nlohmann::json study_growth(const StudySettings& settings) {
    std::vector<int> sizes{1'000, 2'000, 5'000, 10'000, 20'000, 50'000, 100'000, 200'000};
    if (!settings.quick) sizes.insert(sizes.end(), {500'000, 1'000'000, 2'000'000, 5'000'000, 10'000'000});
    const std::string scene = settings.scenes.empty() ? "cloth" : settings.scenes.front();

    Table table("growth: " + scene, {"triangles", "pairs", "1 thread, ms", "all threads, ms", "ns a triangle",
                                     "speed-up", "memory without output, bytes a triangle"});
    nlohmann::json rows = nlohmann::json::array();
    std::vector<double> triangles, one_thread, all_threads;
    for (const int size : sizes) {
        const Workload workload = load(fmt::format("{}:{}", scene, size));
        Options one;
        one.threads = 1;
        const Contestant contestants[]{crumple_with(one, workload, "1 thread"),
                                       crumple_with({}, workload, "all threads")};
        const std::vector<Times> times = race(contestants, settings.effort);
        const Summary slow = times[0].summary(), fast = times[1].summary();

        Detector detector;
        const Intersections& result = detector.find(workload.a.view());
        const auto n = static_cast<double>(workload.triangle_count());
        const double memory = static_cast<double>(result.statistics.peak_memory_bytes - output_bytes(result)) / n;
        triangles.push_back(n);
        one_thread.push_back(slow.median);
        all_threads.push_back(fast.median);
        table.row({fmt::format("{}", n), std::to_string(result.pairs.size()), number(slow.median), number(fast.median),
                   number(1e6 * fast.median / n), number(slow.median / fast.median), number(memory)});
        rows.push_back({{"triangles", n},
                        {"pairs", result.pairs.size()},
                        {"one_thread", to_json(slow)},
                        {"all_threads", to_json(fast)},
                        {"bytes_a_triangle", memory}});
    }
    table.print();
    const double one = exponent(triangles, one_thread), all = exponent(triangles, all_threads);
    fmt::print("  time ~ triangles^{:.3f} on one thread, triangles^{:.3f} on all\n", one, all);
    return {{"scene", scene}, {"sizes", rows}, {"exponent_one_thread", one}, {"exponent_all_threads", all}};
}

}  // namespace crumple::benchmark
