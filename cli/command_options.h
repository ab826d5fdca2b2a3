#pragma once

// Options that several subcommands have, declared once.

#include <cstdint>
#include <functional>
#include <limits>
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
    io::Triangulation triangulation = io::Triangulation::ears;
    bool strict = false;
    io::Unit unit = io::Unit::unknown;
    bool lines_and_points = false;  ///< no option: queries of features read them
};

/// Options that change the result.
struct QueryOptions : ReadingOptions {
    Neighbours neighbours = Neighbours::geometric;
    IntersectionKind kind = IntersectionKind::all;
    std::string groups;               ///< "components", "bodies", a file, a PLY property; empty: none
    std::optional<PairScope> filter;  ///< absent: both
    std::optional<PartOfMany> part;
    bool contacts = false;
    bool polygons = false;  ///< ids are those of polygons

    /// The files are a world of bodies, and what collides is told of these.
    bool of_bodies() const { return groups == "bodies"; }

    /// Throws Error (invalid_argument) for options that change nothing without another one.
    void check() const;
};

/// Lets an integer from `low` to `high` pass; help does not show it.
CLI::Validator integer(std::int64_t low, std::int64_t high);

/// Numbers from 0 to below `end`.
struct NumberRange {
    double end;
    const char* words;  ///< "distance of 0 or more"
};
inline constexpr NumberRange any_distance{std::numeric_limits<double>::infinity(), "distance of 0 or more"};
/// An option whose value is rounded once, to the nearest float64, and given to `set`.
CLI::Option* add_number_option(CLI::App& app, const char* name, const std::function<void(double)>& set,
                               NumberRange range, const char* help);

void add_reading_options(CLI::App& app, ReadingOptions& options);
/// `--groups` and `--filter`.
void add_group_options(CLI::App& app, QueryOptions& options);
void add_query_options(CLI::App& app, QueryOptions& options);
/// Adds options that change only the cost.
void add_cost_options(CLI::App& app, Options& options);

/// Throws Error (invalid_argument) for options that the backend does not use.
void check_cost_options(const Options& options);

/// `--polygons`, for commands whose pairs have ids.
void add_polygons_option(CLI::App& app, QueryOptions& options);
/// `--format`, which tells what `-o -` writes.
void add_format_option(CLI::App& app, std::string& format, const std::string& words);

/// Throws Error (invalid_argument) if what is to be written is one of the files that are read, under whatever name, or
/// a file that comes with it is.
void check_outputs(const std::vector<std::string>& outputs, std::vector<std::string> inputs,
                   const QueryOptions& options);

/// Standard input or output.
inline bool is_standard(const std::string& path) { return path == "-"; }

/// Lower case, with its dot; empty if there is none. That of `-` is what `--format` says.
std::string extension_of(const std::string& path, const std::string& format = {});

/// Throws Error (invalid_argument) if standard input is named twice.
void check_standard_input(const std::vector<std::string>& inputs);

/// Throws Error (invalid_argument) unless `--format` is there where one of the outputs is `-`, and only there.
void check_format(const std::vector<std::string>& outputs, const std::string& format);

}  // namespace crumple::cli
