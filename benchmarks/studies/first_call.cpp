// Study of the cost of a first call: in a new process, whose threads have to start and whose code has to be paged in;
// with a new detector in a process that has run calls before; and with a warm detector, for comparison. In all three
// cases the pages of the caller's arrays are already in memory. The time to make the detector of a new process, which
// starts the threads, is in a column of its own.

#include <fmt/format.h>
#include <stdio.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>

#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

double milliseconds(std::chrono::steady_clock::duration time) {
    return std::chrono::duration<double, std::milli>(time).count();
}

FirstCall in_new_process(const std::string& scene) {
    const std::string program = std::filesystem::read_symlink("/proc/self/exe");
    const std::string command = fmt::format("exec '{}' --first-call --scene '{}'", program, scene);
    FILE* pipe = popen(command.c_str(), "r");
    FirstCall time;
    const bool read = pipe && fscanf(pipe, "%lf %lf", &time.detector, &time.call) == 2;
    if (!pipe || pclose(pipe) != 0 || !read) throw std::runtime_error("cannot run " + command);
    return time;
}

}  // namespace

FirstCall first_call(const Workload& workload) {
    const auto begin = std::chrono::steady_clock::now();
    const Contestant contestant = crumple_with({}, workload, "");
    const auto made = std::chrono::steady_clock::now();
    contestant.call();
    return {milliseconds(made - begin), milliseconds(std::chrono::steady_clock::now() - made)};
}

nlohmann::json study_first_call(const StudySettings& settings) {
    Table table("first call, ms",
                {"scene", "new process: detector", "quartiles", "first call", "quartiles", "new detector's first call",
                 "quartiles", "warm", "quartiles", "new process / warm", "new detector / warm"});
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene :
         choose_scenes(settings, {"cloth_ball92", "balls16_18", "227"}, {"cloth", "bodies"})) {
        const Workload workload = load(scene);
        const Contestant warm = crumple_with({}, workload, "warm");
        time_slice(warm, settings.effort.slice);
        std::vector<double> making, process, detector, kept;
        for (int r = 0; r < settings.effort.rounds; ++r) {
            const FirstCall first = in_new_process(scene);
            making.push_back(first.detector);
            process.push_back(first.call);
            detector.push_back(first_call(workload).call);
            for (const double time : time_slice(warm, settings.effort.slice)) kept.push_back(time);
        }
        const Summary m = summarise(making), p = summarise(process), d = summarise(detector), w = summarise(kept);
        table.row({scene, number(m.median), range(m), number(p.median), range(p), number(d.median), range(d),
                   number(w.median), range(w), number(p.median / w.median), number(d.median / w.median)});
        rows.push_back({{"workload", scene},
                        {"making", to_json(m)},
                        {"new_process", to_json(p)},
                        {"new_detector", to_json(d)},
                        {"warm", to_json(w)}});
    }
    table.print();
    return rows;
}

}  // namespace crumple::benchmark
