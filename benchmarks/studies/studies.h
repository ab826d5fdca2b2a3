#pragma once

// Studies: measurements of crumple alone. Each prints its tables and returns the same figures as JSON.

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "crumple/detector.h"
#include "race.h"
#include "workload.h"

namespace crumple::benchmark {

struct StudySettings {
    std::vector<std::string> scenes;  ///< scenes that the user named; empty for the default scenes of each study
    Effort effort;
    bool quick = false;
};

struct Study {
    const char* name;
    const char* summary;
    nlohmann::json (*run)(const StudySettings& settings);
};

/// Returns every study, in the order in which they run.
std::span<const Study> studies();

/// Returns the scenes that the user named. If there are none, returns the default scenes of a study: `real` if the
/// folder of the scenes' files exists, else `procedural`, and only the first two of them in a quick run.
std::vector<std::string> choose_scenes(const StudySettings& settings, std::vector<std::string> real,
                                       std::vector<std::string> procedural);

/// Returns a contestant with a detector of its own, which stays warm and runs the workload in each call.
Contestant crumple_with(const Options& options, const Workload& workload, std::string name);

nlohmann::json study_scenes(const StudySettings& settings);
nlohmann::json study_sequences(const StudySettings& settings);
nlohmann::json study_stages(const StudySettings& settings);
nlohmann::json study_growth(const StudySettings& settings);
nlohmann::json study_features(const StudySettings& settings);
nlohmann::json study_feature_growth(const StudySettings& settings);
nlohmann::json study_near_filters(const StudySettings& settings);
nlohmann::json study_first_call(const StudySettings& settings);
nlohmann::json study_reading(const StudySettings& settings);
nlohmann::json study_cost_per_box_overlap(const StudySettings& settings);
nlohmann::json study_ground(const StudySettings& settings);
nlohmann::json study_virtual_subdivision(const StudySettings& settings);
nlohmann::json study_membership(const StudySettings& settings);
nlohmann::json study_method(const StudySettings& settings);
nlohmann::json study_axes(const StudySettings& settings);
nlohmann::json study_parts(const StudySettings& settings);
nlohmann::json study_ranks(const StudySettings& settings);
nlohmann::json study_scaling(const StudySettings& settings);
nlohmann::json study_streaming(const StudySettings& settings);
nlohmann::json study_two_clusters(const StudySettings& settings);
nlohmann::json study_threads(const StudySettings& settings);
nlohmann::json study_simd(const StudySettings& settings);
nlohmann::json study_clusters(const StudySettings& settings);
nlohmann::json study_leaf_size(const StudySettings& settings);
nlohmann::json study_fuzziness(const StudySettings& settings);
nlohmann::json study_iterations(const StudySettings& settings);
nlohmann::json study_first_iterations(const StudySettings& settings);

/// Milliseconds of making a detector, which starts its threads, and of its first call. `crumple_benchmark --first-call`
/// prints them; study_first_call() runs that program to measure a new process.
struct FirstCall {
    double detector = 0, call = 0;
};
FirstCall first_call(const Workload& workload);

}  // namespace crumple::benchmark
