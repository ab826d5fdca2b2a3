// Study of every scene on every backend, device, instruction set and number of threads: warm (a detector that has run
// the scene before), cold (a new detector in a process that has run before), and the detector's peak memory.

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <thread>

#include "crumple/device.h"
#include "crumple/error.h"
#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

struct Way {
    std::string backend, simd;
    Options options;
};

/// Returns the configurations that are measured, as far as this machine supports them: the cpu backend with each
/// instruction set that users are likely to have, on 1, 2, 4, ... and all threads, and the cuda backend on each device.
std::vector<Way> ways_here() {
    std::set<int> threads;
    const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int t = 1; t < all; t *= 2) threads.insert(t);
    threads.insert(all);
    std::vector<Way> ways;
    for (const auto& [simd, name] :
         {std::pair{Simd::avx2, "AVX2"}, std::pair{Simd::avx512, "AVX-512"}, std::pair{Simd::neon, "NEON"}}) {
        for (const int t : threads) {
            const Options options{.backend = Backend::cpu, .threads = t, .simd = simd};
            try {
                Detector{options};
            } catch (const Error&) {
                continue;
            }
            ways.push_back({"cpu", name, options});
        }
    }
    if (ways.empty())
        for (const int t : threads) ways.push_back({"cpu", "automatic", {.backend = Backend::cpu, .threads = t}});
    // Calls of the cuda backend upload meshes and download pairs here. benchmarks/cuda.cpp measures arrays on the
    // device.
    for (const DeviceInfo& device : list_devices().devices)
        ways.push_back({"cuda", device.name, {.backend = Backend::cuda, .threads = 1, .device = device.number}});
    return ways;
}

std::int64_t peak_memory(const Options& options, const Workload& workload) {
    Detector detector(options);
    const MeshView a = workload.a.view(), b = workload.b.view();
    if (workload.query == Query::any) return 0;  // any() returns no statistics
    return (workload.query == Query::between ? detector.find({a, b}) : detector.find(a)).statistics.peak_memory_bytes;
}

}  // namespace

nlohmann::json study_scenes(const StudySettings& settings) {
    const std::vector<Way> ways = ways_here();
    std::vector<std::string> scenes = settings.scenes;
    if (scenes.empty() && settings.quick) scenes = quick_scenes();
    if (scenes.empty()) {
        scenes = real_scenes();
        for (const std::string& name : every_procedural_scene()) scenes.push_back(name);
    }
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        std::vector<Contestant> contestants;
        for (const Way& way : ways) {
            contestants.push_back(crumple_with(way.options, workload, fmt::format("{}", contestants.size())));
            contestants.push_back({fmt::format("{}", contestants.size()),
                                   "",
                                   "",
                                   [&] { crumple_with(way.options, workload, "").call(); },
                                   {}});
        }
        const std::vector<Times> times = race(contestants, settings.effort);
        Table table(fmt::format("{} ({}): {} triangles", name, name_of(workload.query), workload.triangle_count()),
                    {"backend", "instructions", "threads", "warm, ms", "quartiles", "99th percentile", "cold, ms",
                     "quartiles", "peak, MiB"});
        nlohmann::json values = nlohmann::json::array();
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const Summary warm = times[2 * i].summary(), cold = times[2 * i + 1].summary();
            const std::int64_t peak = peak_memory(ways[i].options, workload);
            table.row({ways[i].backend, ways[i].simd, std::to_string(ways[i].options.threads), number(warm.median),
                       range(warm), number(warm.percentile_99), number(cold.median), range(cold),
                       peak ? number(static_cast<double>(peak) / 1048576) : ""});
            values.push_back({{"backend", ways[i].backend},
                              {"simd", ways[i].simd},
                              {"threads", ways[i].options.threads},
                              {"warm", with_percentile_99(warm)},
                              {"cold", to_json(cold)},
                              {"peak_bytes", peak}});
        }
        table.print();
        rows.push_back({{"workload", name},
                        {"question", name_of(workload.query)},
                        {"scalar", workload.scalar()},
                        {"triangles", workload.triangle_count()},
                        {"ways", std::move(values)}});
    }
    return rows;
}

}  // namespace crumple::benchmark
