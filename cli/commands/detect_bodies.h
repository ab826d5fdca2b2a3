#pragma once

// crumple detect --groups bodies: finds the bodies of a world that collide, in one configuration or in many.

#include <optional>
#include <string>
#include <vector>

#include "cli/bodies/body_scene.h"

namespace crumple::cli {

struct DetectBodyOptions : BodyOptions {
    bool containment = false;          ///< a body inside another one counts as a collision
    std::optional<OpenSurfaces> open;  ///< absent: not given, which means error
};
/// Adds the options about bodies, with the help of crumple detect.
void add_detect_body_options(CLI::App& app, DetectBodyOptions& options);
/// Throws Error (invalid_argument) if an option about bodies has no effect because another option is missing.
void check_detect_body_options(const DetectBodyOptions& options, const QueryOptions& query_options);

/// Input and options of one run of crumple detect --groups bodies.
struct BodyTask {
    const std::vector<std::string>&files, &outputs;
    const std::string& format;  ///< format of the output `-o -`
    const QueryOptions& query_options;
    const DetectBodyOptions& bodies;
    const Options& options;
    bool check;     ///< --check: exit with status 1 if something collides
    bool progress;  ///< --progress: print each step as it begins
};

/// Runs the search, writes its outputs and returns the exit status. Throws Error.
int detect_bodies(const BodyTask& task);

}  // namespace crumple::cli
