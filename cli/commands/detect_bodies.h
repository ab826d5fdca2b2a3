#pragma once

// crumple detect --groups bodies: which bodies of a world collide, in one configuration or in many.

#include <string>
#include <vector>

#include "cli/command_options.h"

namespace crumple::cli {

/// Options that only worlds of bodies have.
struct BodyOptions {
    std::vector<std::string> excluded;  ///< "A,B"
    std::string exclude_from;           ///< a file of pairs; empty: none
    std::string poses;                  ///< a file of poses; empty: those of the files
    bool any = false;                   ///< with poses: only which configurations collide

    /// Throws Error (invalid_argument) for options that change nothing without another one.
    void check(const QueryOptions& query_options) const;
};

void add_body_options(CLI::App& app, BodyOptions& options);

/// Request to crumple detect.
struct BodyTask {
    const std::vector<std::string>&files, &outputs;
    const std::string& format;  ///< of `-o -`
    const QueryOptions& query_options;
    const BodyOptions& bodies;
    const Options& options;
    bool check;     ///< by exit status
    bool progress;  ///< its steps are told
};

/// Returns the exit status. Throws Error.
int detect_bodies(const BodyTask& task);

}  // namespace crumple::cli
