// crumple_benchmark: crumple against its peers (default), or one of the studies of crumple alone.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <nlohmann/json.hpp>

#include "contest.h"
#include "report.h"
#include "requests.h"
#include "sequence.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

struct Settings {
    std::vector<std::string> scenes, peers, study_names;
    std::string json;
    int rounds = 0;
    bool quick = false, serving = false, first = false, list = false, compiler = false;

    Effort effort() const {
        Effort effort = quick ? Effort{.rounds = 5, .slice = 0.02, .budget = 3} : Effort{};
        if (rounds > 0) effort.rounds = rounds;
        return effort;
    }
};

void print_lists() {
    fmt::print("scenes from files:");
    for (const auto& name : real_scenes()) fmt::print(" {}", name);
    fmt::print("\nprocedural:");
    for (const auto& name : every_procedural_scene()) fmt::print(" {}", name);
    fmt::print("\nsequences:");
    for (const auto& name : sequences()) fmt::print(" {}", name);
    fmt::print("\npeers:");
    for (const auto& name : built_peers()) fmt::print(" {}", name);
    fmt::print("\nstudies:\n");
    for (const Study& study : studies()) fmt::print("  {:<21} {}\n", study.name, study.summary);
}

nlohmann::json contests(const Settings& settings) {
    std::vector<std::string> scenes = settings.scenes;
    if (scenes.empty() && settings.quick) scenes = quick_scenes();
    if (scenes.empty()) scenes = real_scenes();
    if (scenes.empty()) scenes = procedural_scenes();
    const std::vector<std::string> peers = settings.peers.empty() ? built_peers() : settings.peers;
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene : scenes) rows.push_back(contest(load(scene), peers, settings.effort()));
    return rows;
}

nlohmann::json run_studies(const Settings& settings) {
    nlohmann::json rows;
    for (const Study& study : studies()) {
        const auto& names = settings.study_names;
        if (std::ranges::find(names, study.name) == names.end() && std::ranges::find(names, "all") == names.end())
            continue;
        const double before = processors_at_hand();
        nlohmann::json& row = rows[study.name];
        row["figures"] = study.run({settings.scenes, settings.effort(), settings.quick});
        const double processors = std::min(before, processors_at_hand());
        row["processors_at_hand"] = processors;
        fmt::print("  {}\n", describe_processors(processors));
    }
    return rows;
}

int run(const Settings& settings) {
    if (settings.list) {
        print_lists();
    } else if (settings.compiler) {
        fmt::print("{}\n", CRUMPLE_COMPILER);
    } else if (settings.serving) {
        serve(load(settings.scenes.at(0)));
    } else if (settings.first) {
        const FirstCall time = first_call(load(settings.scenes.at(0)));
        fmt::print("{} {}\n", time.detector, time.call);
    } else {
        nlohmann::json result;
        if (settings.study_names.empty())
            result = {{"peers", describe_peers()}, {"contests", contests(settings)}};
        else
            result["studies"] = run_studies(settings);
        if (!settings.json.empty()) write_json(settings.json, result);
    }
    return 0;
}

}  // namespace
}  // namespace crumple::benchmark

int main(int argc, char** argv) {
    using namespace crumple::benchmark;
    Settings settings;
    std::vector<std::string> study_names{"all"};
    for (const Study& study : studies()) study_names.emplace_back(study.name);

    CLI::App app("Times crumple and its peers alternately; or, with --study, crumple alone.");
    app.add_option("--scene", settings.scenes,
                   "workload [any:|between:]SCENE[:TRIANGLES], [any:]FILE or between:FILE,FILE; may be repeated");
    app.add_option("--peer", settings.peers, "peer; may be repeated")->check(CLI::IsMember(built_peers()));
    app.add_option("--study", settings.study_names, "study, or all; may be repeated")
        ->check(CLI::IsMember(study_names));
    app.add_option("--repetitions", settings.rounds, "number of rounds of a race")->check(CLI::Range(1, 10'000));
    app.add_option("--json", settings.json, "file for the figures");
    app.add_flag("--quick", settings.quick, "few and short rounds, to check that everything works");
    app.add_flag("--list", settings.list, "list scenes, peers and studies");
    app.add_flag("--compiler", settings.compiler, "print what compiled this program");
    app.add_flag("--serve", settings.serving, "serve requests of another process (requests.h)")->needs("--scene");
    app.add_flag("--first-call", settings.first,
                 "print the milliseconds to make this process's first detector, and of its first call")
        ->needs("--scene");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(settings);
    } catch (const std::exception& error) {
        fmt::print(stderr, "crumple_benchmark: {}\n", error.what());
        return 1;
    }
}
