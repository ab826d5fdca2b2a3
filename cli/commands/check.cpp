// crumple check: a verdict on the bodies of files: holes, places where surfaces pass through themselves, clashes.

#include <limits>
#include <memory>

#include "checks/check_report.h"
#include "checks/check_writers.h"
#include "checks/item_texts.h"
#include "cli/bodies/body_scene.h"
#include "cli/commands.h"
#include "cli/length_option.h"
#include "cli/search_command.h"
#include "cli/steps.h"
#include "io/bytes/atomic_file.h"

namespace crumple::cli {
namespace {

using checks::CheckReport, checks::CheckedBody, checks::summary_of;

struct CheckCommand {
    std::vector<std::string> files;
    ListOutputs outputs;
    QueryOptions query_options;
    Options options;
    BodyOptions bodies;
    std::optional<LengthOption> ignore_below, clearance;
    bool json = false, progress = false;

    void check_options() const {
        check_format(outputs.paths, outputs.format);
        for (const std::string& path : outputs.paths)
            if (!checks::check_writer_of(extension_of(path, outputs.format)))
                refuse("-o " + (path.empty() ? "''" : path) + (is_standard(path) ? " --format " + outputs.format : "") +
                       ": a check is written as .txt, .csv, .json or .html");
        if (json && std::any_of(outputs.paths.begin(), outputs.paths.end(), is_standard))
            refuse("--json does not go with -o -: both write to standard output");
    }

    void write(const CheckReport& report) const {
        for (const std::string& path : outputs.paths) {
            const checks::CheckWriter write_to = checks::check_writer_of(extension_of(path, outputs.format));
            if (is_standard(path)) {
                to_standard_output([&](std::ostream& out) { write_to(out, report); });
                continue;
            }
            io::AtomicFile file(path);
            write_to(file.stream(), report);
            file.commit();
        }
        if (json) return to_standard_output([&](std::ostream& out) { checks::write_check_json(out, report); });
        if (outputs.paths.empty())
            return to_standard_output([&](std::ostream& out) { checks::write_check_text(out, report); });
        if (outputs.have_files()) say(summary_of(report) + '\n');
    }

    int run() const {
        check_options();
        std::vector<std::string> inputs = files;
        bodies.add_files(inputs);
        check_standard_input(inputs);
        check_outputs(outputs.paths, inputs, query_options);
        SearchSession search(query_options, feature_options(options));
        const Steps steps(progress);
        steps.begin("read");
        const BodyScene scene(files, query_options, bodies);
        if (scene.names().empty()) refuse("check needs bodies; " + scene.origins().files + " holds none");
        const io::Unit unit = scene.mesh().unit;
        checks::CheckOptions check;
        if (ignore_below) check.ignore_below = ignore_below->in(unit);
        if (clearance) check.clearance = clearance->in(unit);
        steps.begin("check");
        const CheckReport report =
            checks::check_bodies(search.detector(), {scene.mesh(), scene.origins(), scene.given_excluded()}, check);
        search.warn_of_losses(report.crossings.statistics);
        print_hints(report);
        steps.begin("write");
        write(report);
        return report.count_findings() > 0 ? collided : done;
    }

   private:
    /// Prints a note for each body in which most triangles share no vertices.
    static void print_hints(const CheckReport& report) {
        for (std::int32_t b = 0; b < std::ssize(report.bodies); ++b) {
            const CheckedBody& body = report.bodies[static_cast<std::size_t>(b)];
            if (body.shells > 1 && 2 * std::int64_t{body.shells} > body.report.triangles)
                print_note(checks::name_of(report, {b}) +
                           ": most faces share no vertices, so that each is a shell; --weld merges vertices at equal "
                           "positions");
        }
    }
};

}  // namespace

Command add_check(CLI::App& app) {
    const auto check = std::make_shared<CheckCommand>();
    CLI::App& command = *app.add_subcommand(
        "check", "Check parts before printing or assembly: holes, places that pass through themselves, clashes");
    command
        .add_option("FILE", check->files,
                    "Files whose bodies are checked: the nodes of glTF scenes, the objects of 3MF, and any other mesh "
                    "(PLY, OBJ, STL, OFF) as one body. - is standard input")
        ->type_name("FILE ...")
        ->required()
        ->expected(1, std::numeric_limits<int>::max());
    command
        .add_option(
            "-o,--output", check->outputs.paths,
            "All items as .csv or .json, the text as .txt, or a page as .html that shows the bodies and moves to "
            "each place. May be repeated. - is standard output, see --format. Without it, the text is printed")
        ->type_name("OUT")
        ->allow_extra_args(false);
    add_format_option(command, check->outputs.format, "txt|csv|json|html");
    command.add_flag("--json", check->json, "Print JSON instead of the text");
    add_length_option(
        command, "--ignore-below", check->ignore_below,
        "Two bodies, or two shells, that touch or overlap, but nowhere deeper than this, are no findings: "
        "0.01mm, or 0.01 in the unit of the files. Use it for faces that are meant to be flush");
    add_length_option(
        command, "--clearance", check->clearance,
        "Pairs of bodies that are nearer to each other than this are findings, also if they touch, unless "
        "--ignore-below is given");
    add_excluded_options(command, check->bodies, {"", "this pair of bodies is not checked; A,A: A with itself", ""});
    add_progress_option(command, check->progress);
    add_reading_options(command, check->query_options);
    add_cost_options(command, check->options);
    command.footer(
        "Exit status: 0 no findings, 1 findings, 2 wrong use or bad input. Findings are: holes and other edges at\n"
        "which a surface is not closed, flipped, degenerate or duplicated triangles, bodies and shells (connected\n"
        "components) that are inside out, places where a shell passes through itself or touches itself, shells of one\n"
        "body that touch, overlap or lie inside each other, and bodies that overlap or lie inside each other. Bodies\n"
        "that only touch are listed, and are findings with --clearance. Bodies that are not closed have no volumes.\n"
        "Files whose faces share no vertices need --weld; STL files and glTF scenes are welded.\n\n"
        "Example: crumple check part.stl --unit mm\n"
        "         crumple check plate.3mf --ignore-below 0.01mm -o report.html\n"
        "         crumple check lid.stl pot.stl --clearance 0.1 -o clashes.csv");
    return {&command, [check] { return check->run(); }};
}

}  // namespace crumple::cli
