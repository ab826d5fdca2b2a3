#pragma once

// Options, outputs and words that the commands share which search one mesh or two.

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
    bool below = false;  ///< the radius itself is too far

    ProximityQuery query(const QueryOptions& query_options, Output output) const;
};
/// `--below`.
void add_below_option(CLI::App& app, NearOptions& options);

/// Throws Error (invalid_argument) for options of colliding triangles. `option_of_features`:
/// "--impacts".
void refuse_beside_features(const char* option_of_features, const QueryOptions& query_options);

/// `--backend auto` is the cpu backend here: no other one that is fast has these queries.
Options feature_options(Options options);

/// Outputs of a result: lists, and one mesh coloured.
struct ListOutputs {
    std::vector<std::string> paths;
    std::string format;

    /// Throws Error (invalid_argument) where a file is none of these. `what`: "impacts"; `coloured`: extensions of
    /// coloured meshes.
    void check(const std::string& what, const std::vector<std::string>& coloured = {".glb"}) const;
    /// True if one of them is a file.
    bool have_files() const;

    /// list(to, format) and picture(to) write to a path or to a stream. Without outputs the list is printed.
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
    /// Throws Error (invalid_argument) unless there is one list, of a format that can be written while it is found.
    void check_stream() const;
    /// Writes that list: stream(writer) adds the blocks.
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
    /// The same where check() has let no picture pass.
    template <class List>
    void write(List list) const {
        write(list, [](auto&) { throw std::logic_error("no mesh is coloured by this result"); });
    }
};
/// `-o` and `--format`. `what`: "Impacts", `coloured`: "the start, coloured by time".
void add_output_options(CLI::App& app, ListOutputs& outputs, const std::string& what, const std::string& coloured);

/// Words for what is listed.
struct ListWords {
    const char* one;   ///< "impact"
    const char* some;  ///< line of --check: "something touches"
    const char* none;  ///< "nothing touches"
};
inline constexpr ListWords words_of_pairs{"pair", "something collides", "nothing collides"},
    words_of_impacts{"impact", "something touches", "nothing touches"},
    words_of_near{"near pair", "something is near", "nothing is near"},
    words_of_candidates{"candidate", "some candidates", "no candidates"};

/// Options that these commands share, beside their files and queries.
struct SearchCommand {
    ListOutputs outputs;
    QueryOptions query_options;
    Options options;
    bool check = false, stats = false, stream = false, progress = false;

    /// Throws Error (invalid_argument) for options that do not go with `--stream`, if it is given.
    void check_stream() const;
    /// Writes a result while it is found: find(take) delivers its blocks. Returns the status.
    template <class Block, class Find>
    int write_stream(io::ListKind of, const ListWords& words, Find find, std::int64_t triangles) const {
        Statistics statistics;
        outputs.write_blocks(
            of, [&](io::FeatureWriter& writer) { statistics = find([&](const Block& block) { writer.add(block); }); });
        return finish_stream(statistics, words, triangles);
    }
    int finish_stream(const Statistics& statistics, const ListWords& words, std::int64_t triangles) const;

    /// True if nothing but the status is requested.
    bool only_status() const { return check && outputs.paths.empty(); }
    /// The status, and the line that says so.
    static int report(bool any, const ListWords& words);
    /// Returns the status once the result is written; prints the summary where that went to files.
    int finish(bool any, const std::string& summary) const;
};
/// `--check` with this help, `--stats`, and all that changes how files are read and what a result costs.
void add_search_command_options(CLI::App& app, SearchCommand& command, const std::string& check);

/// Size of a result, for its summary.
struct Tally {
    std::int64_t count = 0;
    std::array<std::int64_t, feature_kinds> by_kind{};  ///< by FeatureKind
    double milliseconds = 0;
};
template <class Result>
Tally tally_of(const Result& result) {
    Tally tally{result.count, {}, result.statistics.milliseconds};
    for (std::size_t k = 0; k < tally.by_kind.size(); ++k)
        tally.by_kind[k] = static_cast<std::int64_t>(result.lists[k].pairs.size());
    return tally;
}

/// "27 vertex-face, 107 edge-edge"
std::string kinds_of(const Tally& tally);
/// The same of those that are listed.
std::string kinds_of(const Candidates& candidates);

/// "134 impacts (27 vertex-face, 107 edge-edge), 3.1 ms", or "nothing touches: 28 triangles, 3.1 ms". `kinds`: as
/// kinds_of says them; `more`: what follows them.
std::string summary_of(const Tally& tally, const std::string& kinds, const ListWords& words, std::int64_t triangles,
                       const std::string& more = {});
/// "134 impacts (27 vertex-face, 107 edge-edge), the first at 0.045, 3.1 ms"
std::string summary_of_impacts(const Tally& tally, const FirstImpact& first, bool earliest, std::int64_t triangles);
inline std::string summary_of_near(const Tally& tally, std::int64_t triangles) {
    return summary_of(tally, kinds_of(tally), words_of_near, triangles);
}

/// Returns only the first impact of the lists.
Impacts only_first(const Impacts& impacts);
/// Remark of --stats on impacts where one is enough.
inline constexpr const char* only_first_remark = "only the first was looked for";

/// A row as a list of text has it: "vf 8481 17305 0.25", "vf 8481 17305".
std::string text_of(const io::FeatureRow& row, bool has_bodies);
std::string text_of(const io::CandidateRow& row, bool has_bodies);

}  // namespace crumple::cli
