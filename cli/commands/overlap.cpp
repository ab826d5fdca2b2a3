// crumple overlap: finds how much the bodies of a world overlap, where, and in which direction they separate fastest.

#include <memory>
#include <optional>
#include <type_traits>

#include "cli/bodies/body_lists.h"
#include "cli/bodies/found_overlaps.h"
#include "cli/commands.h"
#include "cli/ranks/rank_overlaps.h"
#include "cli/ranks/ranks.h"
#include "cli/search_command.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"
#include "io/bytes/atomic_file.h"

namespace crumple::cli {
namespace {

constexpr ListWords words_of_overlaps{"overlap", "something overlaps", "nothing overlaps"};

/// Calls write(stream). `to`: a stream, or the path of a file, which appears only when it is complete.
template <class To, class Write>
void write_whole(To& to, Write write) {
    if constexpr (std::is_base_of_v<std::ostream, To>) {
        write(to);
    } else {
        io::AtomicFile file(to);
        write(file.stream());
        file.commit();
    }
}

struct OverlapCommand : SearchCommand {
    std::vector<std::string> files;
    OverlapOptions overlap;
    bool body_pairs = false;

    Output output() const {
        if (only_status() && !stats) return Output::any;
        return overlap.bodies.any ? Output::any_by_world : body_pairs ? Output::body_pairs : Output::pairs;
    }

    bool is_picture(const std::string& path) const {
        return io::has_colours(io::mesh_format_of(extension_of(path, outputs.format)));
    }

    void check_options() const {
        outputs.check("overlaps", {".html", ".glb", ".3mf", ".obj", ".ply"});
        for (const std::string& path : outputs.paths) {
            if (!is_picture(path)) continue;
            if (!overlap.bodies.poses.empty())
                refuse("-o " + path + ": with --poses, rows are written as .txt, .csv, .json or .npz");
            if (is_standard(path) && outputs.format == "obj")
                refuse("-o - --format obj: a coloured .obj needs a file beside it");
        }
        const bool has_parts = overlap.regions || overlap.depth_tolerance > 0 || !overlap.directions.empty();
        for (const std::string& path : outputs.paths)
            if (has_parts && extension_of(path, outputs.format) == ".csv")
                refuse("-o " + path + ": regions, depths and withdrawals are written as .txt, .json or .npz");
        if (has_parts && (body_pairs || overlap.bodies.any))
            refuse(
                "--regions, --depth-tolerance and --withdraw need all numbers of a row, so neither --body-pairs nor "
                "--any-by-world");
        if (overlap.first_free && overlap.directions.empty()) refuse("--first-free needs --withdraw");
        if (!overlap.bodies.any) return;
        if (overlap.bodies.poses.empty())
            refuse("--any-by-world needs --poses; to find out whether anything overlaps, use --check");
        for (const std::string& path : outputs.paths)
            if (extension_of(path, outputs.format) == ".npz")
                refuse("-o " + path + ": with --any-by-world, rows are written as .txt, .csv or .json");
    }

    void write_configurations(const BodyScene& scene, const FoundOverlaps& found) const {
        const ConfigurationList list{.names = scene.names(),
                                     .has_pairs = false,
                                     .collides = found.has_overlaps,
                                     .milliseconds = found.statistics.milliseconds,
                                     .verb = "overlaps"};
        outputs.write([&](auto& to, io::PairFormat format) {
            const ListFormat rows = format == io::PairFormat::json                           ? ListFormat::json
                                    : format == io::PairFormat::csv || outputs.paths.empty() ? ListFormat::csv
                                                                                             : ListFormat::txt;
            write_whole(to, [&](std::ostream& out) { write_list(out, list, rows); });
        });
    }

    /// Writes the bodies with their overlaps coloured, to a path or to a stream.
    template <class To>
    void write_picture(To& to, const BodyScene& scene, const FoundOverlaps& found) const {
        Overlaps rows;
        for (const io::OverlapListRow& row : found.list.rows) {
            rows.bodies.push_back(row.bodies);
            rows.relation.push_back(row.relation);
        }
        if constexpr (std::is_base_of_v<std::ostream, To>)
            io::write_coloured(to, scene.mesh(), rows, io::mesh_format_of("." + outputs.format),
                               feature_options(options));
        else
            io::write_coloured(to, scene.mesh(), rows, feature_options(options));
    }

    void write(const BodyScene& scene, const FoundOverlaps& found) const {
        if (overlap.bodies.any) return write_configurations(scene, found);
        const io::OverlapBodies bodies{scene.names(), scene.mesh().unit};
        outputs.write(
            [&](auto& to, io::PairFormat format) {
                if (format == io::PairFormat::txt)
                    write_whole(to, [&](std::ostream& out) { write_text(out, found.list, bodies); });
                else
                    write_whole(to, [&](std::ostream& out) {
                        io::write_overlaps(out, found.list, bodies, found.statistics, format);
                    });
            },
            [&](auto& to) { write_picture(to, scene, found); });
    }

    std::string summary(const FoundOverlaps& found, std::size_t bodies) const {
        if (!overlap.bodies.any) return summary_of(found, bodies);
        return fmt::format("bodies overlap or touch in {} of {} configurations, {:.1f} ms\n",
                           grouped(std::count(found.has_overlaps.begin(), found.has_overlaps.end(), 1)),
                           grouped(std::ssize(found.has_overlaps)), found.statistics.milliseconds);
    }

    /// Prints statistics, writes the result, and returns the exit status.
    int finish(const BodyScene& scene, const FoundOverlaps& found, const Steps& steps) const {
        if (stats) print_statistics(found.statistics, relations_of(found.list));
        if (only_status()) return report(found.any, words_of_overlaps);
        steps.begin("write");
        write(scene, found);
        const bool only_standard = !outputs.paths.empty() && !outputs.have_files();
        if (!stats && (!found.any || !only_standard)) say(summary(found, scene.names().size()));
        return check && found.any ? collided : done;
    }

    /// Each rank reads all files, and searches some of the pairs of bodies. Rank 0 writes.
    int run_on_ranks() const {
        if (!overlap.bodies.poses.empty()) refuse_on_ranks("--poses");
        std::vector<std::string> inputs = files;
        overlap.bodies.add_files(inputs);
        for (const std::string& path : inputs)
            if (is_standard(path)) refuse_on_ranks("standard input to overlap");
        query_options.check();
        check_cost_options(options);
        const Steps steps(progress);
        std::optional<BodyScene> scene;
        std::optional<io::WorldView> view;
        std::vector<Body> bodies;
        const auto read = [&] {
            check_outputs(outputs.paths, inputs, query_options, /*is_writer=*/false);
            steps.begin("read");
            scene.emplace(files, query_options, overlap.bodies);
            view.emplace(scene->mesh().view());
            bodies = scene->bodies(1, false);
            steps.begin("search");
            return World{view->shapes, bodies, view->poses};
        };
        return overlaps_on_ranks({.options = feature_options(options),
                                  .read = read,
                                  .query = [&] { return overlap_query(*scene, overlap, output()); },
                                  .named = [&](const Error& error) { return with_origin(error, scene->origins(), -1); },
                                  .write =
                                      [&](const Overlaps& found) {
                                          return finish(*scene, found_of(found, *scene, overlap, output()), steps);
                                      }});
    }

    int run() const {
        check_options();
        if (Ranks::count() > 1) return run_on_ranks();
        std::vector<std::string> inputs = files;
        overlap.bodies.add_files(inputs);
        check_standard_input(inputs);
        check_outputs(outputs.paths, inputs, query_options);
        SearchSession search(query_options, feature_options(options));
        const Steps steps(progress);
        steps.begin("read");
        const BodyScene scene(files, query_options, overlap.bodies);
        steps.begin("search");
        const FoundOverlaps found = find_overlaps(search, scene, overlap, output());
        return finish(scene, found, steps);
    }
};

}  // namespace

Command add_overlap(CLI::App& app) {
    const auto overlap = std::make_shared<OverlapCommand>();
    CLI::App& command =
        *app.add_subcommand("overlap", "Measure how much closed bodies overlap, and in which direction they separate");
    command
        .add_option(
            "FILE", overlap->files,
            "Files whose bodies form one world: the nodes of glTF scenes, the objects of 3MF, and any other mesh (PLY, "
            "OBJ, STL, OFF) as one body. For a single body, the overlap with itself is computed. - is standard input")
        ->type_name("FILE ...")
        ->required()
        ->expected(1, std::numeric_limits<int>::max());
    command
        .add_option("-o,--output", overlap->outputs.paths,
                    "All numbers as .csv, .json or .npz, which read back exactly, or the text as .txt; or a picture as "
                    ".html, .glb, .3mf or .obj, in which the surface of the overlaps is seen through the bodies, or as "
                    ".ply, which contains only that surface. May be repeated. - is standard output, see --format. "
                    "Without it, the text is printed")
        ->type_name("OUT")
        ->allow_extra_args(false);
    add_format_option(command, overlap->outputs.format, "txt|csv|json|npz|html|glb|3mf|ply");
    command.add_flag(
        "--check", overlap->check,
        "Exit with status 1 if bodies overlap or touch. Without -o, nothing else is computed, and one line is printed");
    CLI::Option* const body_pairs =
        command.add_flag("--body-pairs", overlap->body_pairs,
                         "List only which bodies overlap or touch, and how, without volumes and normals");
    add_overlap_options(command, overlap->overlap, "");
    add_overlap_parts(command, overlap->overlap);
    command.add_flag("--any-by-world", overlap->overlap.bodies.any,
                     "With --poses: list only whether bodies overlap or touch in each configuration, which is a world");
    body_pairs->excludes("--any-by-world");
    command.add_flag("--stats", overlap->stats, "Print times and counts of the stages to standard error");
    add_progress_option(command, overlap->progress);
    add_reading_options(command, overlap->query_options);
    add_cost_options(command, overlap->options);
    command.footer(
        "Each line has two bodies: whether they touch or overlap, or which lies inside the other; the volume that\n"
        "both cover; the mean depth, which is that volume divided by the length of its derivative; and the normal:\n"
        "moving the first body against it reduces the volume fastest. A body overlaps itself where it covers space\n"
        "twice. Bodies must be closed surfaces, counter-clockwise seen from outside; crumple info --open-edges lists\n"
        "where one is not closed. STL files and glTF scenes are welded; other files whose faces share no vertices\n"
        "need --weld. Several MPI ranks share the pairs of bodies; --poses is not supported on ranks.\n\n"
        "Example: crumple overlap lid.stl pot.stl\n"
        "         crumple overlap lid.stl pot.stl -o overlap.html\n"
        "         crumple overlap lid.stl pot.stl --regions --depth-tolerance 0.01 --withdraw 0,0,1\n"
        "         crumple overlap robot.glb --excluded-bodies base,arm --min-volume 1e-9 -o overlaps.csv");
    return {&command, [overlap] { return overlap->run(); }, true};
}

}  // namespace crumple::cli
