#pragma once

// Options shared by several subcommands.

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

/// Options that change how files are read.
struct ReadingOptions {
    std::optional<bool> weld;  ///< absent: STL files and glTF scenes are welded, others are not
    io::Precision precision = io::Precision::automatic;
    io::Triangulation triangulation = io::Triangulation::ears;
    bool strict = false;
    io::Unit unit = io::Unit::unknown;
    bool lines_and_points = false;  ///< not an option: set for queries about features
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

    /// True if the files are a world of bodies, and the result lists pairs of bodies.
    bool of_bodies() const { return groups == "bodies"; }

    /// Throws Error (invalid_argument) for options that do not go together, or have no effect without another one.
    void check() const;
};

/// Returns a validator for integers from `low` to `high`, which help does not show.
CLI::Validator integer(std::int64_t low, std::int64_t high);

/// Numbers from 0 to below `end`.
struct NumberRange {
    double end;
    const char* words;  ///< "distance of 0 or more"
};
inline constexpr NumberRange any_distance{std::numeric_limits<double>::infinity(), "distance of 0 or more"};
/// Adds an option whose value is rounded once, to the nearest float64, and passed to `set`.
CLI::Option* add_number_option(CLI::App& app, const char* name, const std::function<void(double)>& set,
                               NumberRange range, const char* help);

void add_reading_options(CLI::App& app, ReadingOptions& options);
/// Adds `--groups` and `--filter`.
void add_group_options(CLI::App& app, QueryOptions& options);
void add_query_options(CLI::App& app, QueryOptions& options);
/// Adds options that change only the cost.
void add_cost_options(CLI::App& app, Options& options);

/// Throws Error (invalid_argument) for options that the backend does not use.
void check_cost_options(const Options& options);

/// Adds `--polygons`, for commands whose pairs have ids.
void add_polygons_option(CLI::App& app, QueryOptions& options);
/// Adds `--format`, the format of `-o -`.
void add_format_option(CLI::App& app, std::string& format, const std::string& words);

/// Throws Error (invalid_argument) if an output, or a file that is written along with it, is one of the files that are
/// read, under any name.
void check_outputs(const std::vector<std::string>& outputs, std::vector<std::string> inputs,
                   const QueryOptions& options);

/// True for standard input or output.
inline bool is_standard(const std::string& path) { return path == "-"; }

/// Returns the extension in lower case, with its dot; empty if there is none. For `-` it is that of `--format`.
std::string extension_of(const std::string& path, const std::string& format = {});

/// Throws Error (invalid_argument) if standard input is named twice.
void check_standard_input(const std::vector<std::string>& inputs);

/// Throws Error (invalid_argument) if `--format` is given without the output `-` or the other way round, or if `-` is
/// named twice.
void check_format(const std::vector<std::string>& outputs, const std::string& format);

}  // namespace crumple::cli
