// crumple detect: finds colliding triangles in one mesh or between two, or colliding bodies of a world.

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "cli/commands.h"
#include "cli/commands/detect_bodies.h"
#include "cli/ranks/rank_search.h"
#include "cli/ranks/ranks.h"
#include "cli/search.h"
#include "cli/search_command.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

constexpr const char* formats =
    "pairs are written as .txt, .csv, .json or .npz, coloured meshes as .ply, .obj, .glb, .3mf or .html";

struct Detect : SearchCommand {
    std::vector<std::string> files;
    DetectBodyOptions bodies;

    static std::optional<io::PairFormat> list_format(const std::string& extension) {
        const io::PairFormat format = io::pair_format_of(extension);
        return format == io::PairFormat::automatic ? std::nullopt : std::optional(format);
    }
    static std::optional<io::MeshFormat> picture_format(const std::string& extension) {
        const io::MeshFormat format = io::mesh_format_of(extension);
        return io::has_colours(format) ? std::optional(format) : std::nullopt;
    }

    [[noreturn]] static void fail(const std::string& what) {
        throw Error(ErrorCode::invalid_argument, what, Element::option);
    }

    void check_output_formats() const {
        check_format(outputs.paths, outputs.format);
        bool shows_contacts = false;
        for (const std::string& path : outputs.paths) {
            const std::string extension = extension_of(path, outputs.format);
            if (!list_format(extension) && !picture_format(extension))
                fail("-o " + (path.empty() ? "''" : path) + (is_standard(path) ? " --format " + outputs.format : "") +
                     ": " + formats);
            if (is_standard(path) && extension == ".obj")
                fail("-o - --format obj: a coloured .obj needs a file beside it");
            shows_contacts = shows_contacts || list_format(extension) || extension == ".html";
        }
        if (!query_options.contacts || shows_contacts) return;
        if (!outputs.paths.empty())
            fail("--contacts: coloured meshes hold no contacts; write a .txt, .csv, .json, .npz or .html");
        if (check) fail("--contacts needs -o with --check, which prints no pairs");
    }

    void write(const std::string& path, const InputMeshes& input, const Intersections& found) const {
        const std::string extension = extension_of(path, outputs.format);
        const auto list = list_format(extension);
        if (!is_standard(path)) {
            if (list) return io::write_pairs(path, found);
            return io::write_coloured(path, input.first, input.second_or_null(), found);
        }
        to_standard_output([&](std::ostream& out) {
            if (list) return io::write_pairs(out, found, *list);
            io::write_coloured(out, input.first, input.second_or_null(), found, *picture_format(extension));
        });
    }

    std::string summary(std::int64_t pairs, const Intersections& found) const {
        const auto all = static_cast<std::int64_t>(found.hit.size() + found.hit_second.size());
        return summary_of_pairs(pairs, count_hits(found), all, query_options.polygons ? "polygons" : "triangles",
                                found.statistics.milliseconds);
    }

    /// Implements --stream: writes pairs to the only output as they are found.
    int run_stream(const Steps& steps) const {
        const std::string path = outputs.paths.empty() ? "-" : outputs.paths.front();
        const auto list = outputs.paths.empty() ? io::PairFormat::txt : list_format(extension_of(path, outputs.format));
        if (outputs.paths.size() > 1 || (list != io::PairFormat::txt && list != io::PairFormat::csv))
            fail("--stream writes one list of pairs, as .txt or .csv");
        if (check || query_options.polygons || query_options.part)
            fail("--stream does not go with --check, --polygons or --part");
        check_outputs(outputs.paths, files, query_options);
        SearchSession search(query_options, options);
        steps.begin("read");
        const InputMeshes input = read_input(files, query_options);
        steps.begin("search and write");
        Intersections all;  // holds hit flags and statistics, but no pairs
        all.hit.assign(static_cast<std::size_t>(input.first.triangle_count()), 0);
        if (input.second) all.hit_second.assign(static_cast<std::size_t>(input.second->triangle_count()), 0);
        const auto write_to = [&](io::PairWriter writer) {
            all.statistics = search.stream(input, [&](const Intersections& block) {
                for (const Pair& pair : block.pairs)
                    all.hit[pair.a] = (input.second ? all.hit_second : all.hit)[pair.b] = 1;
                writer.add(block);
            });
            writer.commit();
        };
        if (is_standard(path))
            to_standard_output(
                [&](std::ostream& out) { write_to(io::PairWriter(out, query_options.contacts, *list)); });
        else
            write_to(io::PairWriter(path, query_options.contacts));
        if (stats) print_statistics(all.statistics, count_hits(all));
        return finish(all.statistics.pairs > 0, summary(all.statistics.pairs, all));
    }

    int run() const {
        check_detect_body_options(bodies, query_options);
        if (Ranks::count() > 1) {
            check_output_formats();
            if (files.size() > 1) refuse_on_ranks("a second mesh");
            IntersectionQuery query = query_of(query_options);
            if (only_status() && !stats) query.output = Output::any;
            return search_on_ranks(*this, files, query);
        }
        if (stream && query_options.of_bodies()) fail("--stream does not go with --groups bodies, which lists bodies");
        if (query_options.of_bodies()) {
            if (stats) fail("--stats does not go with --groups bodies, which lists bodies");
            return detect_bodies(
                {files, outputs.paths, outputs.format, query_options, bodies, options, check, progress});
        }
        if (files.size() > 2) fail("detect takes one FILE or two, or any number with --groups bodies");
        check_output_formats();
        const Steps steps(progress);
        if (stream) return run_stream(steps);
        check_outputs(outputs.paths, files, query_options);
        SearchSession search(query_options, options);
        steps.begin("read");
        const InputMeshes input = read_input(files, query_options);
        steps.begin("search");
        if (only_status() && !stats) return report(search.any(input), words_of_pairs);
        const Intersections& of_triangles = search.find(input);
        if (stats) print_statistics(of_triangles.statistics, count_hits(of_triangles));
        if (only_status()) return report(!of_triangles.pairs.empty(), words_of_pairs);

        steps.begin("write");
        Intersections of_polygons;
        if (query_options.polygons) of_polygons = io::by_polygon(input.first, input.second_or_null(), of_triangles);
        const Intersections& found = query_options.polygons ? of_polygons : of_triangles;
        for (const std::string& path : outputs.paths) write(path, input, found);
        if (outputs.paths.empty()) to_standard_output([&](std::ostream& out) { io::write_pairs(out, found); });
        return finish(!found.pairs.empty(), summary(static_cast<std::int64_t>(found.pairs.size()), found));
    }
};

}  // namespace

Command add_detect(CLI::App& app) {
    const auto detect = std::make_shared<Detect>();
    CLI::App& command = *app.add_subcommand("detect", "Find every pair of colliding triangles");
    command
        .add_option("FILE", detect->files,
                    "A mesh (PLY, OBJ, STL, OFF, glTF, 3MF), searched against itself, or two, searched against each "
                    "other; with --groups bodies any number of them. - is standard input")
        ->type_name("FILE [FILE_B]")
        ->required()
        ->expected(1, std::numeric_limits<int>::max());
    command
        .add_option("-o,--output", detect->outputs.paths,
                    "Pairs as .txt, .csv, .json or .npz, or the mesh with colliding triangles coloured as .ply, .obj, "
                    ".glb, .3mf or .html, a page to rotate and zoom. May be repeated. - is standard output, see "
                    "--format. Without it, pairs are printed, one `i j` per line. With --groups bodies: the names as "
                    ".txt, .csv or .json, or the coloured world")
        ->type_name("OUT")
        ->allow_extra_args(false);
    add_format_option(command, detect->outputs.format, "txt|csv|json|npz|ply|glb|3mf|html");
    add_query_options(command, detect->query_options);
    add_detect_body_options(command, detect->bodies);
    add_polygons_option(command, detect->query_options);
    command.add_flag("--contacts", detect->query_options.contacts,
                     "Also list where each pair meets: the kind of the contact and its points");
    command.add_flag(
        "--check", detect->check,
        "Exit with status 1 if anything collides. Without -o, nothing else is computed, and one line is printed");
    command.add_flag("--stream", detect->stream,
                     "Write pairs, as .txt or .csv, while they are found, for results that exceed memory. Their order "
                     "differs from that without --stream, and does not depend on threads");
    command.add_flag("--stats", detect->stats, "Print times and counts of the stages to standard error");
    add_progress_option(command, detect->progress);
    add_cost_options(command, detect->options);
    command.footer(
        "Example: crumple detect dress.ply body.obj -o dress.glb -o pairs.csv --contacts\n"
        "         crumple detect robot.glb --groups bodies --excluded-bodies base,arm -o hits.glb\n"
        "         mpirun -n 16 crumple detect scan.ply -o pairs.csv --stats\n\n"
        "On several processes: if the program was built with CRUMPLE_MPI and started by mpirun,\n"
        "mpiexec or srun, all ranks share the search of one mesh against itself. Each rank reads\n"
        "its part of a binary PLY of triangles or of a binary STL; rank 0 reads any other file.\n"
        "Each rank writes its rows of .txt and .csv. The lists are those of one process, byte for\n"
        "byte. Two meshes, --groups components and bodies, --polygons, --part, --stream and\n"
        "coloured meshes are not supported on several ranks. --memory-limit and --threads apply to\n"
        "each rank; without --threads, ranks divide the cores. With CRUMPLE_MPI=0 in the\n"
        "environment, each process works alone.");
    return {&command, [detect] { return detect->run(); }, true};
}

}  // namespace crumple::cli
