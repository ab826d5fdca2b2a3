#pragma once

// crumple detect --groups bodies: finds the bodies of a world that collide, in one configuration or in many.

#include <optional>
#include <string>
#include <vector>

#include "cli/bodies/body_scene.h"

namespace crumple::cli {

struct DetectBodyOptions : BodyOptions {
    bool containment = false;          ///< a body inside another one counts
    std::optional<OpenSurfaces> open;  ///< absent: error
};
/// Adds the options about bodies, with the help of crumple detect.
void add_detect_body_options(CLI::App& app, DetectBodyOptions& options);
/// Throws Error (invalid_argument) for options about bodies that have no effect without another one.
void check_detect_body_options(const DetectBodyOptions& options, const QueryOptions& query_options);

/// Request to crumple detect --groups bodies.
struct BodyTask {
    const std::vector<std::string>&files, &outputs;
    const std::string& format;  ///< format of the output `-o -`
    const QueryOptions& query_options;
    const DetectBodyOptions& bodies;
    const Options& options;
    bool check;     ///< report by exit status
    bool progress;  ///< print steps
};

/// Returns the exit status. Throws Error.
int detect_bodies(const BodyTask& task);

}  // namespace crumple::cli
