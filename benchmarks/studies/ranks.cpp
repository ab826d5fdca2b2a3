// Study of ranks that are threads of this process, timed by the CPU time of each thread, as if each had a machine of
// its own: balance of the work, total work divided by that of one process, and traffic. The scene does not move. During
// the first frames, parts are assigned to other ranks by measured work until the assignment is stable. Balance and work
// are medians of the last four frames.

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <thread>

#include <time.h>

#include "distributed/rank_detector.h"
#include "distributed/transport/in_process.h"
#include "rank_block.h"
#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

constexpr int frames = 8, counted = 4;

double median_of(std::vector<double> values) { return summarise(std::move(values)).median; }

double time_of_thread() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

nlohmann::json share_scene(const Workload& workload, int ranks, int parts, double alone) {
    const auto hub = std::make_shared<distribute::Hub>(ranks);
    std::vector<std::vector<DistributedStatistics>> told(static_cast<std::size_t>(ranks));
    std::vector<std::thread> threads;
    for (int r = 0; r < ranks; ++r)
        threads.emplace_back([&, r] {
            distribute::InProcess transport(hub, r);
            DistributedOptions options;
            options.detector.backend = Backend::cpu;
            options.detector.threads = 1;
            options.parts = parts;
            const RankBlock block(workload.a, r, ranks);
            distribute::RankDetector detector(transport, options);
            detector.set_clock(time_of_thread);
            for (int frame = 0; frame < frames; ++frame) {
                detector.find(block.local_mesh());
                told[static_cast<std::size_t>(r)].push_back(detector.statistics());
            }
        });
    for (std::thread& thread : threads) thread.join();

    std::vector<double> balance, work;
    std::int64_t members = 0, bytes = 0, first_bytes = 0, messages = 0, searched = 0;
    for (int frame = frames - counted; frame < frames; ++frame) {
        const DistributedStatistics& s = told[0][static_cast<std::size_t>(frame)];
        balance.push_back(s.largest_work / s.mean_work);
        work.push_back(s.mean_work * ranks);
    }
    for (const auto& of_rank : told) {
        members += of_rank.back().members;
        bytes += of_rank.back().bytes_sent;
        first_bytes += of_rank.front().bytes_sent;
        messages += of_rank.back().messages;
        searched += of_rank.back().parts;
    }
    return {{"ranks", ranks},
            {"parts", searched},
            {"balance", median_of(balance)},
            {"work", median_of(work)},
            {"work_over_one", median_of(work) / alone},
            {"members", members},
            {"first_bytes", first_bytes},
            {"bytes", bytes},
            {"messages", messages}};
}

}  // namespace

nlohmann::json study_ranks(const StudySettings& settings) {
    nlohmann::json rows = nlohmann::json::array();
    std::vector<std::string> scenes =
        choose_scenes(settings, {"cloth_ball92", "bodies", "cloth:1000000"}, {"cloth", "bodies", "cloth:1000000"});
    if (settings.quick && settings.scenes.empty()) scenes = {"cloth:20000"};
    for (const std::string& name : scenes) {
        const Workload workload = load(name);
        const std::int64_t n = workload.triangle_count();
        Detector one({.backend = Backend::cpu, .threads = 1});
        std::vector<double> times;  // milliseconds of CPU time, as for the ranks
        for (int frame = 0; frame < frames; ++frame) {
            const double begin = time_of_thread();
            one.find(workload.a.view());
            times.push_back(time_of_thread() - begin);
        }
        const double alone = median_of(times);
        Table table(fmt::format("ranks: {}, {} triangles, {} ms by one process on one thread", name, n, number(alone)),
                    {"ranks", "parts", "largest / mean work", "work / one process", "members / triangles",
                     "first MB sent", "MB sent a frame", "messages"});
        nlohmann::json counts = nlohmann::json::array();
        for (const int ranks : {2, 4, 8, 16, 32, 64})
            for (const int each : {1, 2, 4, 8}) {
                if (settings.quick && (ranks > 8 || each >= 4)) continue;
                const nlohmann::json& row = counts.emplace_back(share_scene(workload, ranks, each * ranks, alone));
                const auto megabytes = [&](const char* what) { return number(1e-6 * row[what].get<double>()); };
                table.row({std::to_string(ranks), std::to_string(each * ranks), number(row["balance"]),
                           number(row["work_over_one"]), number(row["members"].get<double>() / static_cast<double>(n)),
                           megabytes("first_bytes"), megabytes("bytes"),
                           std::to_string(row["messages"].get<std::int64_t>())});
            }
        table.print();
        rows.push_back({{"workload", name}, {"triangles", n}, {"one", alone}, {"counts", std::move(counts)}});
    }
    return rows;
}

}  // namespace crumple::benchmark
