#pragma once

// Options, outputs and words shared by the commands that search one mesh or two.

#include <array>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "cli/terminal.h"
#include "crumple/io_features.h"
#include "io/formats.h"

namespace crumple::cli {

struct MotionOptions {
    double min_distance = 0, share = 0;
    bool approaching_only = false;

    bool any() const { return min_distance > 0 || share > 0 || approaching_only; }
    ImpactQuery query(const QueryOptions& query_options, Output output) const;
};
void add_motion_options(CLI::App& app, MotionOptions& options);

struct NearOptions {
    std::optional<double> radius;
    bool below = false;  ///< true: only distances less than the radius; false: also distances equal to it

    ProximityQuery query(const QueryOptions& query_options, Output output) const;
};
/// Adds and returns `--below`.
CLI::Option* add_below_option(CLI::App& app, NearOptions& options);

/// Throws Error (invalid_argument) if an option is given that applies to colliding triangles only.
/// `option_of_features`: the option with which it conflicts, such as "--impacts", for the message.
void refuse_beside_features(const std::string& option_of_features, const QueryOptions& query_options);

/// Returns the options for a query about features: replaces Backend::automatic by the cpu backend.
Options feature_options(Options options);

/// Outputs of a command (the values of `-o`): lists and coloured meshes. `format`: value of `--format`.
struct ListOutputs {
    std::vector<std::string> paths;
    std::string format;

    /// Throws Error (invalid_argument) if the extension of an output is neither that of a list nor one of `coloured`,
    /// the extensions of coloured meshes. `what`: names the results in the message, such as "impacts".
    void check(const std::string& what, const std::vector<std::string>& coloured = {".glb"}) const;
    /// True if one of the outputs is a file.
    bool have_files() const;

    /// Writes all outputs. list(to, format) writes a list, picture(to) a coloured mesh; `to` is a path or a stream.
    /// Without outputs, prints the list as text.
    template <class List, class Picture>
    void write(List list, Picture picture) const {
        const auto write_to = [&](const auto& path, auto&& to) {
            const io::PairFormat list_format = io::pair_format_of(extension_of(path, format));
            list_format == io::PairFormat::automatic ? picture(to) : list(to, list_format);
        };
        for (const std::string& path : paths) {
            if (!is_standard(path)) {
                write_to(path, path);
                continue;
            }
            to_standard_output([&](std::ostream& out) { write_to(path, out); });
        }
        if (paths.empty()) to_standard_output([&](std::ostream& out) { list(out, io::PairFormat::txt); });
    }
    /// Throws Error (invalid_argument) unless there is at most one output, and it is a .txt or .csv list, which can be
    /// written during the search.
    void check_stream() const;
    /// Writes the only output, a list: calls stream(writer), which adds the blocks.
    template <class Stream>
    void write_blocks(io::ListKind of, Stream stream) const {
        const auto write_to = [&](io::FeatureWriter writer) {
            stream(writer);
            writer.commit();
        };
        if (!paths.empty() && !is_standard(paths.front())) return write_to(io::FeatureWriter(paths.front(), of));
        const io::PairFormat list_format =
            paths.empty() ? io::PairFormat::txt : io::pair_format_of(extension_of(paths.front(), format));
        to_standard_output([&](std::ostream& out) { write_to(io::FeatureWriter(out, of, list_format)); });
    }
    /// Writes the outputs of a result for which there are no coloured meshes.
    template <class List>
    void write(List list) const {
        write(list, [](auto&) { throw std::logic_error("no mesh is coloured by this result"); });
    }
};
/// Adds `-o` and `--format`. For their help, `what` names the results ("Impacts") and `coloured` the mesh that can be
/// written ("the start, coloured by time").
void add_output_options(CLI::App& app, ListOutputs& outputs, const std::string& what, const std::string& coloured);

/// Words for messages about one kind of result.
struct ListWords {
    const char* one;   ///< one row of the result: "impact"
    const char* some;  ///< line of --check if there are rows: "something touches"
    const char* none;  ///< line of --check if there are none: "nothing touches"
};
inline constexpr ListWords words_of_pairs{"pair", "something collides", "nothing collides"},
    words_of_impacts{"impact", "something touches", "nothing touches"},
    words_of_near{"near pair", "something is near", "nothing is near"},
    words_of_candidates{"candidate", "some candidates", "no candidates"};

/// Options that the commands detect, impacts, near and overlap have in common. The struct of each command derives from
/// this one, and adds its files and the options of its kind of query.
struct SearchCommand {
    ListOutputs outputs;
    QueryOptions query_options;
    Options options;
    bool check = false, stats = false, stream = false, progress = false;

    /// Throws Error (invalid_argument) if `--stream` is given with an option that conflicts with it.
    void check_stream() const;
    /// Writes a result during the search. find(take) runs the search, delivers each block to `take`, and returns the
    /// statistics. Returns the exit status.
    template <class Block, class Find>
    int write_stream(io::ListKind of, const ListWords& words, Find find, std::int64_t triangles) const {
        Statistics statistics;
        outputs.write_blocks(
            of, [&](io::FeatureWriter& writer) { statistics = find([&](const Block& block) { writer.add(block); }); });
        return finish_stream(statistics, words, triangles);
    }
    int finish_stream(const Statistics& statistics, const ListWords& words, std::int64_t triangles) const;

    /// True if only the exit status is requested (`--check` without outputs).
    bool only_status() const { return check && outputs.paths.empty(); }
    /// Prints the line of `--check`, and returns the exit status.
    static int report(bool any, const ListWords& words);
    /// Returns the exit status; call it after the result is written. Prints the summary, unless --stats is given, if
    /// nothing was found or the result was written to files.
    int finish(bool any, const std::string& summary) const;
};
/// Adds `--check`, `--stream`, `--stats`, `--progress`, and the options about reading, groups and cost. `check`: help
/// of `--check`.
void add_search_command_options(CLI::App& app, SearchCommand& command, const std::string& check);

/// Size of a result in rows, and duration of its search, for the summary.
struct ResultSize {
    std::int64_t count = 0;
    std::array<std::int64_t, feature_kinds> by_kind{};  ///< number of rows by FeatureKind
    double milliseconds = 0;
};
template <class Result>
ResultSize tally_of(const Result& result) {
    ResultSize tally{result.count, {}, result.statistics.milliseconds};
    for (std::size_t k = 0; k < tally.by_kind.size(); ++k)
        tally.by_kind[k] = static_cast<std::int64_t>(result.lists[k].pairs.size());
    return tally;
}

/// Returns "27 vertex-face, 107 edge-edge", followed by the numbers of vertex-edge and vertex-vertex pairs unless they
/// are 0.
std::string kinds_of(const ResultSize& tally);
/// Returns the number of candidates of each kind that the result lists, in the same form.
std::string kinds_of(const Candidates& candidates);

/// Returns "134 impacts (27 vertex-face, 107 edge-edge), 3.1 ms", or "nothing touches: 28 triangles, 3.1 ms". `kinds`:
/// text in the parentheses, from kinds_of(); `more`: text after the parentheses.
std::string summary_of(const ResultSize& tally, const std::string& kinds, const ListWords& words,
                       std::int64_t triangles, const std::string& more = {});
/// Returns "134 impacts (27 vertex-face, 107 edge-edge), the first at 0.045, 3.1 ms". `earliest`: true if only the
/// first impact was searched for; then returns "the first impact is at 0.045, 3.1 ms".
std::string summary_of_impacts(const ResultSize& tally, const FirstImpact& first, bool earliest,
                               std::int64_t triangles);
inline std::string summary_of_near(const ResultSize& tally, std::int64_t triangles) {
    return summary_of(tally, kinds_of(tally), words_of_near, triangles);
}

/// Returns a result whose lists contain only the first impact.
Impacts only_first(const Impacts& impacts);
/// Remark in the table of --stats if only the first impact is searched for.
inline constexpr const char* only_first_remark = "only the first was looked for";

/// Return a row in the form of .txt lists, without flags: "vf 8481 17305 0.25" for impacts and near pairs, "vf 8481
/// 17305" for candidates.
std::string text_of(const io::FeatureRow& row, bool has_bodies);
std::string text_of(const io::CandidateRow& row, bool has_bodies);

}  // namespace crumple::cli
