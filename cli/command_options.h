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

/// Part `index` of `count` parts of a scene, counted from 1 (`--part 2/5`).
struct PartOfMany {
    int index, count;
};

/// Options that change how files are read.
struct ReadingOptions {
    std::optional<bool> weld;  ///< absent: vertices at equal positions are merged in STL files and glTF scenes only
    io::Precision precision = io::Precision::automatic;
    io::Triangulation triangulation = io::Triangulation::ears;
    bool strict = false;
    io::Unit unit = io::Unit::unknown;
    bool lines_and_points = false;  ///< set by commands about features, without an option of its own
};

/// Options that change the result.
struct QueryOptions : ReadingOptions {
    Neighbours neighbours = Neighbours::geometric;
    IntersectionKind kind = IntersectionKind::all;
    std::string groups;  ///< "components", "bodies", or the name of a file or of a PLY property; empty: no groups
    std::optional<PairScope> filter;  ///< absent: the option is not given
    std::optional<PartOfMany> part;
    bool contacts = false;
    bool polygons = false;  ///< results contain ids of polygons instead of triangles

    /// True if the files are searched as a world of bodies, so that the result lists pairs of bodies.
    bool of_bodies() const { return groups == "bodies"; }

    /// Throws Error (invalid_argument) if options conflict, or if an option has no effect without another one that is
    /// not given.
    void check() const;
};

/// Returns a validator for integers from `low` to `high`. The range does not appear in the help.
CLI::Validator integer(std::int64_t low, std::int64_t high);

/// Range of a number: from 0 to less than `end`.
struct NumberRange {
    double end;
    const char* words;  ///< describes the range in messages: "distance of 0 or more"
};
inline constexpr NumberRange any_distance{std::numeric_limits<double>::infinity(), "distance of 0 or more"};
/// Adds an option with a number in `range`. Passes the number, rounded to the nearest float64, to `set`.
CLI::Option* add_number_option(CLI::App& app, const char* name, const std::function<void(double)>& set,
                               NumberRange range, const char* help);

void add_reading_options(CLI::App& app, ReadingOptions& options);
/// Adds `--groups` and `--filter`.
void add_group_options(CLI::App& app, QueryOptions& options);
void add_query_options(CLI::App& app, QueryOptions& options);
/// Adds the options of the detector: all that change only the cost of a search, not its result, and `--membership`.
void add_cost_options(CLI::App& app, Options& options);

/// Throws Error (invalid_argument) if an option was given that the chosen backend does not use.
void check_cost_options(const Options& options);

/// Adds `--polygons`, for commands whose pairs have ids.
void add_polygons_option(CLI::App& app, QueryOptions& options);
/// Adds `--format`, the format of output to standard output (`-o -`).
void add_format_option(CLI::App& app, std::string& format, const std::string& words);

/// Throws Error (invalid_argument) if an output, or the .mtl file written beside an .obj output, is one of the files
/// that are read. Recognises a file under any of its names. `is_writer`: true if this process writes the outputs;
/// throws Error (file) if one of them cannot be written, before any other is.
void check_outputs(const std::vector<std::string>& outputs, std::vector<std::string> inputs,
                   const QueryOptions& options, bool is_writer = true);

/// True for `-`, which stands for standard input or output.
inline bool is_standard(const std::string& path) { return path == "-"; }

/// Returns the extension in lower case, with its dot; empty if there is none. For `-`, returns a dot and `format`, the
/// value of `--format`.
std::string extension_of(const std::string& path, const std::string& format = {});

/// Throws Error (invalid_argument) if standard input is named twice.
void check_standard_input(const std::vector<std::string>& inputs);

/// Throws Error (invalid_argument) if `--format` is given without the output `-`, if the output `-` is given without
/// `--format`, or if `-` is named twice.
void check_format(const std::vector<std::string>& outputs, const std::string& format);

}  // namespace crumple::cli
