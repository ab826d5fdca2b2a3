// crumple sequence: searches the frames of an animation one after another with one detector, whose searches are
// warm-started: each begins with the cluster centres of the search before.
//
// Tables have a row for each frame, or for each step from one frame to the next. Coloured frames are written as one
// file per frame, or as one animation. After Ctrl-C, tables and animations have the frames searched so far. After an
// error, files of tables and animations remain as they were before.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/commands/sequence_output.h"
#include "cli/frames.h"
#include "cli/numbered.h"
#include "cli/search.h"
#include "cli/search_command.h"
#include "cli/signals.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

volatile std::sig_atomic_t stop = 0;  // nonzero after Ctrl-C: stop after the current frame

struct Sequence {
    std::vector<std::string> files, outputs;
    std::string scene, format;
    scenes::Parameters parameters;
    QueryOptions query_options;
    Options options;
    MotionOptions motion;
    bool json = false, check = false, stats = false, impacts = false;
    int repeat = 1;  ///< number of searches of each frame or step

    void check_impacts() const {
        if (motion.any() && !impacts)
            fail("--min-distance, --min-distance-share and --approaching-only need --impacts");
        if (impacts) refuse_beside_features("--impacts", query_options);
    }

    int run() const {
        check_impacts();
        if (!outputs.empty() || !format.empty()) check_format(outputs, format);
        std::vector<StatisticsTable> tables;
        std::vector<std::string> pictures;
        std::string standard =
            outputs.empty() ? (json ? ".json" : ".csv") : "";  // extension of standard output; empty: not used
        for (const std::string& path : outputs) {
            const std::string extension = extension_of(path, format);
            const bool table = extension == ".csv" || extension == ".json";
            if (json && extension == ".csv") fail(path + ": --json writes no .csv");
            if (!table && extension != ".glb" && (is_standard(path) || (extension != ".ply" && extension != ".obj"))) {
                fail(path + ": a sequence is written as .csv or .json, coloured frames as .glb, .ply or .obj" +
                     (is_standard(path) ? ", to standard output as csv, json or glb" : ""));
            }
            if (impacts && !table) fail(path + ": with --impacts a sequence is written as .csv or .json");
            if (is_standard(path))
                standard = extension;
            else if (table)
                tables.emplace_back(path, extension == ".json", impacts);
            else
                pictures.push_back(path);
        }
        if (scene.empty() && (parameters.triangles || parameters.seed != scenes::Parameters().seed))
            fail("--triangles and --seed need --scene");
        SequenceFrames frames(files, scene, parameters);
        check_outputs(files_written(pictures, frames.count()), files, query_options);
        if (impacts && frames.count() < 2) fail("--impacts needs two frames or more");
        SearchSession search(query_options, impacts ? feature_options(options) : options);
        if (standard.empty()) return find(search, frames, tables, {pictures, nullptr, frames.count()});
        int status = done;
        to_standard_output([&](std::ostream& out) {
            const bool animated = standard == ".glb";
            if (!animated) tables.emplace_back(out, standard == ".json", impacts);
            status = find(search, frames, tables, {pictures, animated ? &out : nullptr, frames.count()});
        });
        return status;
    }

    [[noreturn]] static void fail(const std::string& what) {
        throw Error(ErrorCode::invalid_argument, what, Element::option);
    }

    /// Returns the outputs, and the numbered files of `pictures` that exist already, to compare them with the inputs.
    std::vector<std::string> files_written(const std::vector<std::string>& pictures, std::size_t count) const {
        std::vector<std::string> written = outputs;
        for (const std::string& path : pictures) {
            for (std::size_t i = 0; i < count && extension_of(path) != ".glb"; ++i) {
                const std::string name = numbered(path, i, count);
                if (std::filesystem::exists(name)) written.push_back(name);
            }
        }
        return written;
    }

    /// Statistics of the search with the median time (of an even number, the faster one of the middle two), and times.
    struct Median {
        Statistics statistics;
        Repeats repeats;
    };
    /// Calls find(), which returns a result, `repeat` times, and writes the median. Returns the last result.
    template <class Find>
    const auto& find_repeatedly(Median& median, Find find) const {
        std::vector<Statistics> all;
        for (int i = 1; i < repeat; ++i) all.push_back(find().statistics);
        const auto& found = find();
        all.push_back(found.statistics);
        std::sort(all.begin(), all.end(),
                  [](const Statistics& a, const Statistics& b) { return a.milliseconds < b.milliseconds; });
        median = {all[(all.size() - 1) / 2], {repeat, all.front().milliseconds, all.back().milliseconds}};
        return found;
    }

    /// Finds the impacts of the step from `start` to `end`. Then moves `end` to `start`, for the next step.
    const Impacts& find_step(SearchSession& search, InputMeshes& start, InputMeshes&& end, Median& median) const {
        check_same_faces(start, end.name, end.first);
        start.name += " to " + end.name;
        const Impacts& found = find_repeatedly(median, [&]() -> const Impacts& {
            return search.find(start, motion.query(query_options, Output::pairs), &end.first);
        });
        start = std::move(end);
        return found;
    }

    int find(SearchSession& search, SequenceFrames& frames, std::vector<StatisticsTable>& tables,
             Pictures pictures) const {
        stop_at_first_interrupt(stop);
        Statistics sum;
        std::int64_t hits = 0;
        const std::size_t count = impacts ? frames.count() - 1 : frames.count();
        Progress progress(count);
        std::size_t i = 0;
        const auto is_good = [](const StatisticsTable& table) { return table.is_good(); };
        Median median;
        const auto add_row = [&](const FirstImpact& first = {}) {
            progress.clear();
            for (StatisticsTable& table : tables) table.add(frames.name(i), median.statistics, median.repeats, first);
            add(sum, median.statistics);
        };
        try {
            std::optional<InputMeshes> start;
            for (; i < count && !stop && std::all_of(tables.begin(), tables.end(), is_good); ++i) {
                progress.show(i, frames.name(i));
                if (impacts) {
                    const QueryOptions reading = reading_of_motion(query_options);
                    if (!start) start = frames.load(i, reading);
                    add_row(find_step(search, *start, frames.load(i + 1, reading), median).first);
                    continue;
                }
                const InputMeshes input = frames.load(i, query_options);
                const Intersections& found =
                    find_repeatedly(median, [&]() -> const Intersections& { return search.find(input); });
                add_row();
                pictures.add(input, found);
                hits += count_hits(found);
            }
        } catch (...) {
            for (StatisticsTable& table : tables) table.give_up();
            throw;
        }
        progress.clear();
        for (StatisticsTable& table : tables) table.finish();
        pictures.finish();
        if (stats && impacts) print_statistics(sum, "impacts of all steps");
        if (stats && !impacts) print_statistics(sum, hits);
        if (stop) {
            print_error(fmt::format("interrupted after {} of {} {}", i, count, impacts ? "steps" : "frames"));
            return interrupted;
        }
        return check && sum.pairs > 0 ? collided : done;
    }
};

}  // namespace

Command add_sequence(CLI::App& app) {
    const auto sequence = std::make_shared<Sequence>();
    CLI::App& command =
        *app.add_subcommand("sequence", "Find the colliding pairs, or the impacts, of every frame of an animation");
    command
        .add_option("FRAME", sequence->files,
                    "Meshes (PLY, OBJ, STL, OFF, glTF, 3MF), in order; the topology may change")
        ->type_name("FRAME...");
    command
        .add_option("--scene", sequence->scene,
                    "Search all frames of a procedural or simulated scene instead; see make --list")
        ->type_name("NAME");
    command.add_option("--triangles", sequence->parameters.triangles, "Approximate number of triangles of the scene")
        ->type_name("N")
        ->check(integer(1, 500'000'000));
    command.add_option("--seed", sequence->parameters.seed, "Seed of the scene's random numbers")
        ->type_name("N")
        ->check(integer(0, std::numeric_limits<std::int64_t>::max()));
    command
        .add_option(
            "-o,--output", sequence->outputs,
            "Table with one row per frame, of pairs, times and counts of the stages, as .csv or .json; or coloured "
            "meshes, as one animated .glb or numbered .ply or .obj. May be repeated. - is standard output, see "
            "--format. Without it, the table is printed as CSV")
        ->type_name("OUT")
        ->allow_extra_args(false);
    command.add_flag("--json", sequence->json, "Print the table as JSON instead of CSV");
    add_format_option(command, sequence->format, "csv|json|glb");
    command.add_flag("--impacts", sequence->impacts,
                     "Find what touches in the steps from each frame to the next, one row per step: the number of "
                     "impacts, and the time of the first. All frames must have the same faces");
    add_motion_options(command, sequence->motion);
    add_query_options(command, sequence->query_options);
    command.add_flag("--contacts", sequence->query_options.contacts,
                     "Also compute where each pair meets; this time counts towards the stage `output`");
    command
        .add_option("--repeat", sequence->repeat,
                    "Search each frame or step N times: a row has the times and counts of the search with the median "
                    "time, and the least and the greatest time. All searches but the first start from the cluster "
                    "centres of the same frame")
        ->type_name("N")
        ->check(integer(1, 1'000'000));
    command.add_flag("--check", sequence->check,
                     "Exit with status 1 if anything collides in any frame, or touches in any step");
    command.add_flag("--stats", sequence->stats, "Print times and counts, summed over all frames, to standard error");
    add_cost_options(command, sequence->options);
    command.footer(
        "Times are in milliseconds, those of the stages summed over threads; reading or making frames is not counted.\n"
        "Example: crumple sequence frames/*.ply -o times.csv -o collisions.glb\n"
        "         crumple sequence frames/*.ply --impacts --check");
    return {&command, [sequence] { return sequence->run(); }};
}

}  // namespace crumple::cli
