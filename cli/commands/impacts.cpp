// crumple impacts: finds which features touch, and when, while a mesh moves from the vertices of one file to those of
// another. With --candidates, finds features whose boxes overlap during the step.

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/commands/list_candidates.h"
#include "cli/ranks/rank_search.h"
#include "cli/ranks/ranks.h"
#include "cli/search.h"
#include "cli/search_command.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"

namespace crumple::cli {
namespace {

struct ImpactsCommand : SearchCommand {
    std::string start, end;
    bool triangle_pairs = false, lists_candidates = false, first = false;
    MotionOptions motion;
    CandidateOptions candidates;
    /// Options that exclude --candidates, and options that need it.
    std::vector<const CLI::Option*> of_impacts, of_candidates;

    int run() const {
        check_lists();
        if (Ranks::count() > 1) return list_on_ranks();
        return lists_candidates ? list_candidates() : list_impacts();
    }

    /// Throws Error (invalid_argument) if an option does not apply to the requested list (impacts or candidates), or if
    /// --stream, --first and --triangle-pairs are combined.
    void check_lists() const {
        if (stream && first) refuse("--stream does not go with --first");
        if (stream && triangle_pairs) refuse("--stream does not go with --triangle-pairs");
        if (first && triangle_pairs) refuse("--first does not go with --triangle-pairs");
        for (const CLI::Option* const option : of_impacts)
            if (*option && lists_candidates) refuse(option->get_name() + " does not go with --candidates");
        for (const CLI::Option* const option : of_candidates)
            if (*option && !lists_candidates) refuse(option->get_name() + " needs --candidates");
    }

    int list_on_ranks() const {
        if (lists_candidates) refuse_on_ranks("--candidates");
        if (triangle_pairs) refuse_on_ranks("--triangle-pairs");
        check_impacts();
        return search_on_ranks(*this, {start, end}, motion.query(query_options, output()));
    }

    void check_impacts() const {
        outputs.check("impacts");
        if (end.empty()) refuse("impacts: END is required; see crumple impacts --help");
        check_stream();
    }
    Output output() const { return only_status() && !stats ? Output::any : first ? Output::first : Output::pairs; }

    int list_impacts() const {
        check_impacts();
        check_outputs(outputs.paths, {start, end}, query_options);
        SearchSession search(query_options, feature_options(options));
        const Steps steps(progress);
        steps.begin("read");
        const MovingInput input = read_moving_input(start, end, query_options);
        steps.begin(stream ? "search and write" : "search");
        if (stream) return stream_impacts(search, input);
        ImpactQuery query = motion.query(query_options, output());
        query.triangle_pairs = triangle_pairs;
        const Impacts& all = search.find(input.start, query, &input.end);
        if (stats) print_statistics(all.statistics, first ? only_first_remark : found_in(all));
        if (only_status()) return report(all.any, words_of_impacts);

        const Impacts one = first ? only_first(all) : Impacts();
        const Impacts& found = first ? one : all;
        const auto write = [&](auto& to, io::PairFormat format) {
            triangle_pairs ? io::write_triangle_pairs(to, found, format) : io::write_impacts(to, found, format);
        };
        steps.begin("write");
        outputs.write(write, [&](auto& to) { io::write_coloured(to, input.start.first, found); });
        return finish(found.any, summary(found, input.start.triangle_count()));
    }

    int stream_impacts(SearchSession& search, const MovingInput& input) const {
        const auto find = [&](auto take) {
            return search.stream(input.start, motion.query(query_options, Output::pairs), take, &input.end);
        };
        return write_stream<Impacts>(io::ListKind::impacts, words_of_impacts, find, input.start.triangle_count());
    }

    std::string found_in(const Impacts& found) const {
        return triangle_pairs ? pairs_of_triangles(found) : kinds_of(tally_of(found));
    }
    /// Returns "81 pairs of triangles, 12 from the start": the number of all, and of those in contact at the start.
    static std::string pairs_of_triangles(const Impacts& found) {
        const ImpactList& list = found.triangle_pairs;
        const auto from_start = std::count(list.start.begin(), list.start.end(), std::uint8_t{1});
        return fmt::format("{} pair{} of triangles, {} from the start",
                           grouped(static_cast<std::int64_t>(list.pairs.size())), list.pairs.size() == 1 ? "" : "s",
                           grouped(from_start));
    }

    std::string summary(const Impacts& found, std::int64_t triangles) const {
        if (triangle_pairs && found.any)
            return fmt::format("{}, {:.1f} ms\n", pairs_of_triangles(found), found.statistics.milliseconds);
        return summary_of_impacts(tally_of(found), found.first, first, triangles);
    }

    int list_candidates() const {
        outputs.check("candidates", {});
        check_stream();
        check_outputs(outputs.paths, {start, end}, query_options);
        SearchSession search(query_options, feature_options(options));
        const Steps steps(progress);
        steps.begin("read");
        const StepOrStatic input = read_step_or_static(start, end, query_options);
        steps.begin(stream ? "search and write" : "search");
        const CandidateQuery query = candidates.query(query_options);
        const std::int64_t triangles = input.start.triangle_count();
        if (stream) {
            const auto find = [&](auto take) { return search.stream(input.start, query, take, input.end_or_null()); };
            return write_stream<Candidates>(io::ListKind::candidates, words_of_candidates, find, triangles);
        }
        const Candidates& found = search.find(input.start, query, input.end_or_null());
        if (stats) print_statistics(found.statistics, kinds_of(found));
        steps.begin("write");
        outputs.write([&](auto& to, io::PairFormat format) { io::write_candidates(to, found, format); });
        const ResultSize tally{found.count, {}, found.statistics.milliseconds};
        return finish(found.count > 0, summary_of(tally, kinds_of(found), words_of_candidates, triangles));
    }
};

}  // namespace

Command add_impacts(CLI::App& app) {
    const auto impacts = std::make_shared<ImpactsCommand>();
    CLI::App& command =
        *app.add_subcommand("impacts", "Find all features that touch in the step from one mesh to another, and when");
    command
        .add_option("START", impacts->start,
                    "A mesh (PLY, OBJ, STL, OFF, glTF, 3MF) at the start of a step. - is standard input")
        ->type_name("START")
        ->required();
    command
        .add_option("END", impacts->end,
                    "The same mesh at the end of the step; each vertex moves in a straight line. With --candidates it "
                    "may be missing: then nothing moves")
        ->type_name("END");
    command.add_flag("--triangle-pairs", impacts->triangle_pairs,
                     "List pairs of triangles instead, also those that intersect at the start");
    command.add_flag(
        "--candidates", impacts->lists_candidates,
        "List candidates instead: all pairs of features whose boxes overlap in the step, for your own narrow phase");
    add_output_options(command, impacts->outputs, "Impacts or candidates",
                       "the mesh at the start with triangles coloured by the time of their first impact");
    add_motion_options(command, impacts->motion);
    command.add_flag("--first", impacts->first, "Only the first impact; faster");
    impacts->of_candidates = add_candidate_options(command, impacts->candidates, "--candidates");
    add_search_command_options(
        command, *impacts,
        "Exit with status 1 if anything touches. Without -o, nothing else is computed, and one line is printed");
    for (const char* const name :
         {"--triangle-pairs", "--first", "--min-distance", "--min-distance-share", "--approaching-only", "--check"})
        impacts->of_impacts.push_back(command.get_option(name));
    command.footer(
        "A line `vf V F T S`: vertex V touches face F at time T, from 0 to 1 and rounded down; S is 1 if they touch\n"
        "at the start. `ee A B C D T S`: the edge from A to B touches that from C to D. --weld affects neighbours\n"
        "only: vertices that coincide at the start and at the end count as one, and keep their own ids. Lines and\n"
        "points of OBJ (l, p) are searched, too: `ve V A B T S`, `vv V W T S`.\n"
        "Pairs of triangles are `ff F G T S`: they intersect at the start, or the first of their features touch at\n"
        "T. Candidates are listed likewise, without T and S: `vf V F`, `ee A B C D`, `ef A B F`, `ff F G`,\n"
        "`ve V A B`, `vv V W`. Two features are a candidate if they have no common vertex, and on every axis the gap\n"
        "between their boxes, which contain start and end, is at most twice --inflation.\n\n"
        "Example: crumple impacts cloth_092.ply cloth_093.ply -o impacts.csv -o impacts.glb\n"
        "         crumple impacts cloth_092.ply cloth_093.ply --candidates --inflation 0.001 -o candidates.npz\n\n"
        "Processes started by mpirun share the work, as for crumple detect. --triangle-pairs, --candidates,\n"
        "--stream, coloured meshes, lines and points are not supported on several ranks.");
    return {&command, [impacts] { return impacts->run(); }, true};
}

}  // namespace crumple::cli
