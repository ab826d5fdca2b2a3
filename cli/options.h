#pragma once

// Options that several subcommands have, declared once.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "crumple/io.h"
#include "crumple/options.h"

namespace crumple::cli {

/// Part `index` of `count`, counted from 1.
struct PartOfMany {
    int index, count;
};

/// How a file is read.
struct ReadingOptions {
    std::optional<bool> weld;  ///< absent: STL files are welded, others are not
    io::Precision precision = io::Precision::automatic;
};

/// What changes the answer.
struct AnswerOptions : ReadingOptions {
    Neighbours neighbours = Neighbours::geometric;
    Intersections intersections = Intersections::all;
    std::string groups;            ///< "components", a file, a PLY property; empty: none
    std::optional<Wanted> wanted;  ///< absent: both
    std::optional<PartOfMany> part;
    bool contacts = false;

    /// Throws Error (invalid_argument) for options that change nothing without another one.
    void check() const;
};

void add_reading_options(CLI::App& app, ReadingOptions& options);
void add_answer_options(CLI::App& app, AnswerOptions& options);
/// What changes only the cost.
void add_cost_options(CLI::App& app, Options& options);

/// Throws Error (invalid_argument) for options that the backend has no use for.
void check_cost_options(const Options& options);

/// Throws Error (invalid_argument) if what is to be written is one of the files that are read, under whatever name.
void check_outputs(const std::vector<std::string>& outputs, std::vector<std::string> inputs,
                   const AnswerOptions& options);

/// Lower case, with its dot; empty if there is none.
std::string extension_of(const std::string& path);

}  // namespace crumple::cli
