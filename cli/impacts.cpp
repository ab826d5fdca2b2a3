// crumple impacts: what touches what while a mesh goes from one file's vertices to another's, and when.

#include <memory>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/features.h"
#include "cli/search.h"
#include "cli/statistics_table.h"

namespace crumple::cli {
namespace {

/// Of the lists only their first impact.
Impacts only_first(const Impacts& impacts) {
    Impacts one = impacts;
    if (!one.first.found) return one;
    ImpactList& list = one[one.first.kind];
    list.pairs.push_back(one.first.pair);
    list.toi.push_back(one.first.toi);
    list.start.push_back(one.first.start ? 1 : 0);
    return one;
}

struct ImpactsCommand {
    std::string start, end;
    FeatureOutputs outputs;
    AnswerOptions answer;
    MotionOptions motion;
    Options options;
    bool earliest = false, check = false, stats = false;

    /// "134 impacts (27 vertex-face, 107 edge-edge), the first at 0.045, 3.1 ms"
    std::string summary(const Impacts& found, std::int64_t triangles) const {
        const double milliseconds = found.statistics.milliseconds;
        if (!found.any)
            return fmt::format("nothing touches: {} triangles, {:.1f} ms\n", grouped(triangles), milliseconds);
        const std::string first = fmt::format("{:.6g}", found.first.toi);
        if (earliest) return fmt::format("the first impact is at {}, {:.1f} ms\n", first, milliseconds);
        return fmt::format("{} impact{} ({}), the first at {}, {:.1f} ms\n", grouped(found.count),
                           found.count == 1 ? "" : "s", kinds_of(found), first, milliseconds);
    }

    int run() const {
        outputs.check("impacts");
        check_outputs(outputs.paths, {start, end}, answer);
        Search search(answer, feature_options(options));
        const MovingInput input = read_moving_input(start, end, answer);
        const bool only_status = check && outputs.paths.empty();
        const MotionWants wants = only_status && !stats ? MotionWants::any
                                  : earliest            ? MotionWants::earliest
                                                        : MotionWants::impacts;
        const Impacts& all = search.find(input.start, input.end, motion.question(answer, wants));
        if (stats) print_statistics(all.statistics, earliest ? "only the first was looked for" : kinds_of(all));
        if (only_status) return report(all.any);

        const Impacts one = earliest ? only_first(all) : Impacts();
        const Impacts& found = earliest ? one : all;
        outputs.write([&](auto& to, io::PairFormat format) { io::write_impacts(to, found, format); },
                      [&](auto& to) { io::write_coloured(to, input.start.first, found); });
        if (!stats && outputs.have_files()) say(summary(found, input.start.triangle_count()));
        return check && found.any ? collided : done;
    }

    static int report(bool touches) {
        to_standard_output([&](std::ostream& out) { out << (touches ? "something touches\n" : "nothing touches\n"); });
        return touches ? collided : done;
    }
};

}  // namespace

Command add_impacts(CLI::App& app) {
    const auto impacts = std::make_shared<ImpactsCommand>();
    CLI::App& command =
        *app.add_subcommand("impacts", "Find what touches on the way from one mesh to another, and when");
    command
        .add_option("START", impacts->start, "A mesh (PLY, OBJ, STL, OFF) at the start of a step. - is standard input")
        ->type_name("START")
        ->required();
    command.add_option("END", impacts->end, "The same mesh at the end: its vertices go there straight")
        ->type_name("END")
        ->required();
    add_output_options(command, impacts->outputs, "Impacts", "the mesh at the start with what is hit coloured by time");
    add_motion_options(command, impacts->motion);
    command.add_flag("--earliest", impacts->earliest, "Only the first impact, which is found faster");
    command.add_flag(
        "--check", impacts->check,
        "Exit with status 1 if anything touches. Without -o that is all that is searched for, and one line "
        "is printed");
    command.add_flag("--stats", impacts->stats, "Print times and counts of the stages to standard error");
    add_reading_options(command, impacts->answer);
    add_group_options(command, impacts->answer);
    add_cost_options(command, impacts->options);
    command.footer(
        "A line `vf V F T S`: vertex V touches face F at time T, from 0 to 1 and rounded down; S is 1 if they touch\n"
        "at the start. `ee A B C D T S`: the edge from A to B touches that from C to D. --weld is about neighbours\n"
        "only: vertices that coincide at the start and at the end count as one, and keep their own ids. Lines and\n"
        "points of OBJ (l, p) count, too: `ve V A B T S`, `vv V W T S`.\n"
        "Example: crumple impacts cloth_092.ply cloth_093.ply -o impacts.csv -o impacts.glb");
    return {&command, [impacts] { return impacts->run(); }};
}

}  // namespace crumple::cli
