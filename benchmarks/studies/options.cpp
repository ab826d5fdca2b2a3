// Studies of the time for several values of one option, with all others at their defaults. They show what the option
// does and whether its default is a good one. On each scene, calls with different values alternate.

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <thread>

#include "crumple/error.h"
#include "report.h"
#include "scenes/scenes.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

/// Options with one value changed. The label names the value and marks the default.
struct Setting {
    std::string label;
    Options options;
};

/// Function that makes a contestant with these options and this label. It determines what the contestant searches.
using MakeContestant = std::function<Contestant(const Options&, std::string label)>;

/// Returns settings with each of the values. `member(options)` returns a reference to the varied option.
template <class T, class Member>
std::vector<Setting> settings_of(Member member, std::initializer_list<T> values) {
    std::vector<Setting> result;
    for (const T value : values) {
        Setting setting{fmt::format("{}", value), {}};
        if (value == member(setting.options)) setting.label += " (default)";
        member(setting.options) = value;
        result.push_back(std::move(setting));
    }
    return result;
}
template <class T>
std::vector<Setting> settings_of(T Options::*member, std::initializer_list<T> values) {
    return settings_of([member](Options& options) -> T& { return options.*member; }, values);
}
template <class T>
std::vector<Setting> settings_of(T FuzzyCMeans::*member, std::initializer_list<T> values) {
    return settings_of([member](Options& options) -> T& { return options.fuzzy_c_means.*member; }, values);
}

nlohmann::json compare(const std::string& option, const std::string& scene, const std::vector<Setting>& settings,
                       const MakeContestant& make, const Effort& effort) {
    std::vector<Contestant> contestants;
    for (const Setting& setting : settings) contestants.push_back(make(setting.options, setting.label));
    const std::vector<Times> times = race(contestants, effort);
    std::size_t usual = 0;
    for (std::size_t i = 0; i < settings.size(); ++i)
        if (settings[i].label.ends_with("(default)")) usual = i;

    Table table(option + ": " + scene, {"value", "ms", "quartiles", "times the default", "quartiles"});
    nlohmann::json rows = nlohmann::json::array();
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const Summary time = times[i].summary(), relative = ratio(times[i], times[usual]);
        table.row({settings[i].label, number(time.median), range(time), number(relative.median), range(relative)});
        rows.push_back(
            {{"value", settings[i].label}, {"milliseconds", to_json(time)}, {"relative", to_json(relative)}});
    }
    table.print();
    return {{"workload", scene}, {"values", std::move(rows)}};
}

std::vector<std::string> meshes_against_meshes() { return {"ember_016", "ember_260", "ember_406"}; }

/// Runs a study on scenes that do not move: all calls search the same frame.
nlohmann::json on_still_scenes(const StudySettings& study, const std::string& option,
                               const std::vector<Setting>& settings,
                               const std::vector<std::string>& further_scenes = {}) {
    std::vector<std::string> scenes{"cloth_ball92", "balls16_18", "227", "Generic_Twin_right"};
    scenes.insert(scenes.end(), further_scenes.begin(), further_scenes.end());
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene : choose_scenes(study, scenes, {"cloth", "bodies", "needles"})) {
        const Workload workload = load(scene);
        const auto make = [&](const Options& o, std::string label) {
            return crumple_with(o, workload, std::move(label));
        };
        rows.push_back(compare(option, scene, settings, make, study.effort));
    }
    return rows;
}

/// Returns a function that makes contestants on a moving scene. A contestant has one detector; its calls search the
/// last sixteen frames of a procedural animation, one frame each, forwards and backwards in turn.
MakeContestant moving(const std::string& scene) {
    constexpr int frames = 16;
    const auto sequence = std::make_shared<std::vector<io::TriangleMesh>>();
    for (const auto& description : scenes::descriptions()) {
        if (description.name != scene) continue;
        if (description.frames < frames) throw Error(ErrorCode::invalid_argument, scene + " does not move");
        for (int f = 0; f < frames; ++f) {
            sequence->push_back(scenes::make(scene, {.frame = description.frames - frames + f}));
            sequence->back().groups.clear();
        }
    }
    if (sequence->empty()) throw Error(ErrorCode::invalid_argument, "no such procedural scene: " + scene);
    return [=](const Options& options, std::string label) {
        const auto detector = std::make_shared<Detector>(options);
        const auto calls = std::make_shared<int>(0);
        const auto call = [=] {
            const int phase = (*calls)++ % (2 * frames - 2);
            const int frame = std::min(phase, 2 * frames - 2 - phase);
            detector->find((*sequence)[static_cast<std::size_t>(frame)].view());
        };
        return Contestant{std::move(label), "", "", call, {}};
    };
}

}  // namespace

nlohmann::json study_threads(const StudySettings& study) {
    std::vector<Setting> settings;
    const int all = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    for (int threads = 1; threads < 2 * all; threads *= 2) {
        Setting setting{std::to_string(std::min(threads, all)), {}};
        setting.options.threads = std::min(threads, all);
        if (threads >= all) setting.label += " (default)";
        settings.push_back(std::move(setting));
    }
    return on_still_scenes(study, "threads", settings, meshes_against_meshes());
}

nlohmann::json study_simd(const StudySettings& study) {
    constexpr std::pair<Simd, const char*> sets[]{{Simd::scalar, "scalar"},
                                                  {Simd::sse4, "sse4"},
                                                  {Simd::avx2, "avx2"},
                                                  {Simd::avx512, "avx512"},
                                                  {Simd::neon, "neon"}};
    std::vector<Setting> settings{{"automatic (default)", {}}};
    for (const auto& [simd, name] : sets) {
        Setting setting{name, {}};
        setting.options.simd = simd;
        try {
            Detector{setting.options};
        } catch (const Error&) {
            continue;  // this machine lacks the instruction set
        }
        settings.push_back(std::move(setting));
    }
    return on_still_scenes(study, "simd", settings, meshes_against_meshes());
}

nlohmann::json study_clusters(const StudySettings& study) {
    return on_still_scenes(study, "clusters", settings_of(&Options::clusters, {0, 1, 2, 4, 8, 16, 32, 64}));
}

nlohmann::json study_leaf_size(const StudySettings& study) {
    return on_still_scenes(study, "leaf_size",
                           settings_of(&Options::leaf_size, {300, 1000, 2000, 3000, 5000, 10'000, 20'000}));
}

nlohmann::json study_fuzziness(const StudySettings& study) {
    return on_still_scenes(study, "fuzziness", settings_of(&FuzzyCMeans::fuzziness, {1.2, 1.5, 2.0, 2.5, 3.0}));
}

nlohmann::json study_iterations(const StudySettings& study) {
    const std::vector<std::string> scenes = choose_scenes(study, {"cloth", "bodies"}, {"cloth", "bodies"});
    const std::vector<Setting> settings = settings_of(&FuzzyCMeans::max_iterations, {0, 1, 2, 3, 5, 10});
    nlohmann::json rows = nlohmann::json::array();
    for (const std::string& scene : scenes)
        rows.push_back(compare("max_iterations", scene + ", moving", settings, moving(scene), study.effort));
    return rows;
}

nlohmann::json study_first_iterations(const StudySettings& study) {
    nlohmann::json rows = nlohmann::json::array();
    const std::vector<Setting> settings = settings_of(&FuzzyCMeans::first_iterations, {0, 1, 2, 5, 10, 20, 40});
    for (const std::string& scene : choose_scenes(study, {"cloth_ball92", "balls16_18", "227"}, {"cloth", "bodies"})) {
        const Workload workload = load(scene);
        const auto make = [&](const Options& options, std::string label) {
            return Contestant{
                std::move(label), "", "", [=, &workload] { crumple_with(options, workload, "").call(); }, {}};
        };
        rows.push_back(compare("first_iterations", scene + ", new detector", settings, make, study.effort));
    }
    return rows;
}

}  // namespace crumple::benchmark
