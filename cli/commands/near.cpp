// crumple near: finds vertex-face and edge-edge pairs within a distance of each other, in one mesh or between two.

#include <memory>

#include <fmt/format.h>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/near_filters.h"
#include "cli/ranks/rank_search.h"
#include "cli/ranks/ranks.h"
#include "cli/search.h"
#include "cli/search_command.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"

namespace crumple::cli {
namespace {

struct NearCommand : SearchCommand {
    std::vector<std::string> files;
    NearOptions near;
    NearFilterOptions filters;

    Output output() const { return only_status() && !stats ? Output::any : Output::pairs; }

    int list_on_ranks() const {
        if (files.size() > 1) refuse_on_ranks("a second mesh");
        if (!filters.radii.empty()) refuse_on_ranks("--radii");
        if (!filters.rest.empty()) refuse_on_ranks("--rest");
        if (filters.rings > 0) refuse_on_ranks("--rings");
        return search_on_ranks(*this, files, near.query(query_options, output()));
    }

    int run() const {
        outputs.check("near pairs");
        check_stream();
        if (!near.radius && filters.radii.empty()) refuse("near: --radius or --radii is required");
        std::vector<std::string> inputs = files;
        for (const std::string& file : filters.files()) inputs.push_back(file);
        if (Ranks::count() > 1) return list_on_ranks();
        check_outputs(outputs.paths, inputs, query_options);
        check_standard_input(inputs);
        SearchSession search(query_options, feature_options(options));
        const Steps steps(progress);
        steps.begin("read");
        const QueryOptions reading = near_reading(filters, query_options);
        InputMeshes input = read_input(files, reading);
        const NearFilters given(filters, input, reading);
        ProximityQuery query = near.query(query_options, output());
        given.apply(query);
        steps.begin(stream ? "search and write" : "search");
        if (stream) {
            const auto find = [&](auto take) { return search.stream(input, query, take); };
            return write_stream<Proximities>(io::ListKind::near, words_of_near, find, input.triangle_count());
        }
        const Proximities& found = search.find(input, query);
        if (stats) print_statistics(found.statistics, kinds_of(tally_of(found)));
        if (only_status()) return report(found.any, words_of_near);
        steps.begin("write");
        outputs.write([&](auto& to, io::PairFormat format) { io::write_near(to, found, format); },
                      [&](auto& to) { io::write_coloured(to, input.first, input.second_or_null(), found); });
        return finish(found.any, summary_of_near(tally_of(found), input.triangle_count()));
    }
};

}  // namespace

Command add_near(CLI::App& app) {
    const auto near = std::make_shared<NearCommand>();
    CLI::App& command = *app.add_subcommand("near", "Find all features within a distance of each other");
    command
        .add_option("FILE", near->files,
                    "A mesh (PLY, OBJ, STL, OFF, glTF, 3MF), or two: then only pairs between the two are listed. - is "
                    "standard input")
        ->type_name("FILE [FILE_B]")
        ->required()
        ->expected(1, 2);
    CLI::Option* const radius =
        add_number_option(
            command, "--radius", [&options = near->near](double value) { options.radius = value; }, any_distance,
            "Features are near if their distance is at most R, in the units of the coordinates")
            ->type_name("R");
    add_below_option(command, near->near);
    add_near_filter_options(command, near->filters);
    radius->excludes("--radii");
    add_output_options(command, near->outputs, "Near pairs", "the mesh with triangles coloured by distance");
    add_search_command_options(
        command, *near,
        "Exit with status 1 if anything is near. Without -o, nothing else is computed, and one line is printed");
    command.footer(
        "A line `vf V F Q`: vertex V and face F are near; Q is the square of their distance, rounded to nearest.\n"
        "`ee A B C D Q`: the edge from A to B and that from C to D are near. Between two files an id is 0:ID or\n"
        "1:ID. Features with a common vertex are not listed. Lines and points of OBJ (l, p) are searched, too:\n"
        "`ve V A B Q`, `vv V W Q`. For cloth with a thickness: --radii with half of it, --rings 2, and --rest with\n"
        "the cloth as it was cut.\n\n"
        "Example: crumple near dress.ply body.obj --radius 0.005 -o near.csv\n\n"
        "Processes started by mpirun share the work on one mesh, as for crumple detect. --radii, --rest, --rings,\n"
        "--stream, coloured meshes, lines and points are not supported on several ranks.");
    return {&command, [near] { return near->run(); }, true};
}

}  // namespace crumple::cli
