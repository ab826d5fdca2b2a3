// crumple sequence: the frames of an animation, one after another, by one detector that stays warm.
//
// Every frame is a row, written as soon as it is known, so that what there is survives an interruption; coloured frames
// are a file each, as soon, or one animation at the end, of what there is. A table is not touched before the first row.

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/frames.h"
#include "cli/numbered.h"
#include "cli/search.h"
#include "cli/sequence_output.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

volatile std::sig_atomic_t stop = 0;

/// The first Ctrl-C ends the sequence after the frame at hand, the second one the process.
void catch_interrupt() {
    struct sigaction action {};
    action.sa_handler = [](int) { stop = 1; };
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
}

struct Sequence {
    std::vector<std::string> files, outputs;
    std::string scene;
    scenes::Parameters parameters;
    AnswerOptions answer;
    Options options;
    bool json = false, check = false, stats = false;

    int run() const {
        std::vector<Table> tables;
        std::vector<std::string> pictures;
        for (const std::string& path : outputs) {
            const std::string extension = extension_of(path);
            if (extension == ".csv" || extension == ".json") {
                if (json && extension == ".csv") {
                    throw Error(ErrorCode::invalid_argument, path + ": --json writes no .csv");
                }
                tables.emplace_back(path, extension == ".json");
            } else if (extension == ".glb" || extension == ".ply" || extension == ".obj") {
                pictures.push_back(path);
            } else {
                throw Error(ErrorCode::invalid_argument,
                            path + ": a sequence is written as .csv or .json, coloured frames as .glb, .ply or .obj");
            }
        }
        if (scene.empty() && (parameters.triangles || parameters.seed != scenes::Parameters().seed)) {
            throw Error(ErrorCode::invalid_argument, "--triangles and --seed are for a --scene", Element::option);
        }
        Frames frames(files, scene, parameters);
        check_outputs(files_written(pictures, frames.count()), files, answer);
        Search search(answer, options);
        if (!outputs.empty()) return find(search, frames, tables, pictures);
        int status = done;
        to_standard_output([&](std::ostream& out) {
            tables.emplace_back(out, json);
            status = find(search, frames, tables, pictures);
        });
        return status;
    }

    /// The outputs, and the numbered ones of them that are there already.
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

    int find(Search& search, Frames& frames, std::vector<Table>& tables,
             const std::vector<std::string>& coloured) const {
        catch_interrupt();
        Statistics sum;
        std::int64_t hits = 0;
        Pictures pictures(coloured, frames.count());
        Progress progress(frames.count());
        std::size_t i = 0;
        const auto well = [](const Table& table) { return table.well(); };
        const auto finish = [&] {
            progress.clear();
            for (Table& table : tables) table.finish();
            pictures.finish();
        };
        try {
            for (; i < frames.count() && !stop && std::all_of(tables.begin(), tables.end(), well); ++i) {
                progress.show(i, frames.name(i));
                const Input input = frames.load(i, answer);
                const Collisions& found = search.find(input);
                progress.clear();
                for (Table& table : tables) table.add(frames.name(i), found.statistics);
                pictures.add(input, found);
                add(sum, found.statistics);
                hits += count_hits(found);
            }
        } catch (...) {
            finish();
            throw;
        }
        finish();
        if (stats) print_statistics(sum, hits);
        if (stop) {
            print_error(fmt::format("interrupted after {} of {} frames", i, frames.count()));
            return interrupted;
        }
        return check && sum.pairs > 0 ? collided : done;
    }
};

}  // namespace

Command add_sequence(CLI::App& app) {
    const auto sequence = std::make_shared<Sequence>();
    CLI::App& command = *app.add_subcommand("sequence", "Find the colliding pairs of every frame of an animation");
    command.add_option("FRAME", sequence->files, "Meshes (PLY, OBJ, STL, OFF), in order; the topology may change")
        ->type_name("FRAME...");
    command
        .add_option("--scene", sequence->scene,
                    "All frames of a procedural or simulated scene instead; see make --list")
        ->type_name("NAME");
    command.add_option("--triangles", sequence->parameters.triangles, "Of the scene: about how many")
        ->type_name("N")
        ->check(CLI::Range(1, 500'000'000).description(""));
    command.add_option("--seed", sequence->parameters.seed, "Of the scene")
        ->type_name("N")
        ->check(CLI::Range(std::int64_t{0}, std::numeric_limits<std::int64_t>::max()).description(""));
    command
        .add_option("-o,--output", sequence->outputs,
                    "Table of triangles, pairs, time and stages, a row a frame, as .csv or .json; or coloured meshes, "
                    "as one animated .glb or numbered .ply or .obj. May be repeated. Without it CSV goes to standard "
                    "output")
        ->type_name("OUT")
        ->allow_extra_args(false);
    command.add_flag("--json", sequence->json, "JSON instead of CSV on standard output");
    add_answer_options(command, sequence->answer);
    command.add_flag("--contacts", sequence->answer.contacts,
                     "Also compute where each pair meets; the time is a part of the stage output");
    command.add_flag("--check", sequence->check, "Exit with status 1 if anything collides in any frame");
    command.add_flag("--stats", sequence->stats, "Print times and counts, summed over all frames, to standard error");
    add_cost_options(command, sequence->options);
    command.footer(
        "Times are in milliseconds, those of the stages summed over threads; reading or making frames is not counted.\n"
        "Example: crumple sequence frames/*.ply -o times.csv -o collisions.glb");
    return {&command, [sequence] { return sequence->run(); }};
}

}  // namespace crumple::cli
