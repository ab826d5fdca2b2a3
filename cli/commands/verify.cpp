// crumple verify: checks a list of pairs.

#include <algorithm>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>

#include <fmt/format.h>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/commands/list_comparison.h"
#include "cli/commands/verify_features.h"
#include "cli/commands/verify_overlaps.h"
#include "cli/print_some.h"
#include "cli/search.h"
#include "cli/terminal.h"
#include "crumple/error.h"

namespace crumple::cli {
namespace {

struct Comparison {
    std::vector<Pair> missing, extra, repeated;  // `repeated`: pairs listed more than once, here once each

    bool right() const { return missing.empty() && extra.empty() && repeated.empty(); }
};

/// Compares a list of pairs, in any order, with the right list. For one mesh, (i, j) and (j, i) are the same pair.
Comparison compare(std::vector<Pair> list, const Array<Pair>& right, bool one_mesh) {
    if (one_mesh) {
        for (Pair& pair : list) pair = {std::min(pair.a, pair.b), std::max(pair.a, pair.b)};
    }
    std::sort(list.begin(), list.end());
    Comparison result;
    for (std::size_t i = 1; i < list.size(); ++i) {
        const bool first_repetition = list[i] == list[i - 1] && (i < 2 || list[i] != list[i - 2]);
        if (first_repetition) result.repeated.push_back(list[i]);
    }
    list.erase(std::unique(list.begin(), list.end()), list.end());
    std::set_difference(right.begin(), right.end(), list.begin(), list.end(), std::back_inserter(result.missing));
    std::set_difference(list.begin(), list.end(), right.begin(), right.end(), std::back_inserter(result.extra));
    return result;
}

struct Verify {
    std::vector<std::string> files;  // one mesh or two, then the list
    std::string format;
    QueryOptions query_options;
    Options options;
    FeatureCheck features;
    OverlapCheck overlaps;

    int run() const {
        if (overlaps.is_requested(features, query_options))
            return verify_overlaps(overlaps, files, format, query_options, options);
        if (files.size() > 3) refuse("verify takes one mesh or two and a list, or any number of files with --overlaps");
        if (features.is_requested(query_options))
            return verify_features(features, files, format, query_options, options);
        if (!format.empty() && !is_standard(files.back()))
            throw Error(ErrorCode::invalid_argument, "--format is for a list from standard input, -", Element::option);
        SearchSession search(query_options, options);
        check_standard_input(files);
        std::vector<Pair> list = is_standard(files.back())
                                     ? io::read_pairs(std::cin, "standard input" + (format.empty() ? "" : "." + format))
                                     : io::read_pairs(files.back());
        const InputMeshes input = read_input({files.begin(), files.end() - 1}, query_options);
        Intersections of_polygons;
        const Intersections& found = search.find(input);
        if (query_options.polygons) of_polygons = io::by_polygon(input.first, input.second_or_null(), found);
        const Array<Pair>& pairs = query_options.polygons ? of_polygons.pairs : found.pairs;
        const Comparison comparison = compare(std::move(list), pairs, !input.second);
        const bool right = comparison.right();
        to_standard_output([&](std::ostream& out) {
            out << fmt::format("{}: {} pairs, {} missing, {} extra, {} repeated\n", verdict(right), pairs.size(),
                               comparison.missing.size(), comparison.extra.size(), comparison.repeated.size());
            const auto text = [](const Pair& pair) { return fmt::format("{} {}", pair.a, pair.b); };
            print_some(out, "missing", comparison.missing, text);
            print_some(out, "extra", comparison.extra, text);
            print_some(out, "repeated", comparison.repeated, text);
        });
        return right ? done : collided;
    }
};

}  // namespace

Command add_verify(CLI::App& app) {
    const auto verify = std::make_shared<Verify>();
    CLI::App& command = *app.add_subcommand(
        "verify", "Check whether a list of pairs, impacts, candidates, near pairs or overlaps is complete and correct");
    command
        .add_option("FILE", verify->files,
                    "One mesh or two, then a list of pairs in any order: a .csv, .json or .npz as detect -o writes it, "
                    "a .npy, or text, of which the first two integers of each line are read. One of the files may be "
                    "-, standard input. With --impacts: START, END and a list of impacts; with --candidates: START, "
                    "optionally END, and a list of candidates; with --radius or --radii: one mesh or two, and a list "
                    "of near pairs; with --overlaps: any number of files of bodies, and a list of overlaps")
        ->type_name("FILE [FILE_B] PAIRS")
        ->required()
        ->expected(2, std::numeric_limits<int>::max());
    command.add_option("--format", verify->format, "Format of a list that is read from standard input; txt by default")
        ->type_name("txt|csv|json|npz|npy");
    add_feature_check_options(command, verify->features);
    add_overlap_check_options(command, verify->overlaps);
    add_query_options(command, verify->query_options);
    add_polygons_option(command, verify->query_options);
    add_cost_options(command, verify->options);
    command.footer(
        "Prints how many rows are missing, extra or repeated, and the first few of them; exits with status 1 if the\n"
        "list is wrong.\n"
        "Example: crumple verify bunny.ply theirs.txt --neighbours skip\n"
        "         crumple verify --impacts cloth_092.ply cloth_093.ply theirs.txt\n"
        "         crumple verify --overlaps lid.stl pot.stl overlaps.csv");
    return {&command, [verify] { return verify->run(); }};
}

}  // namespace crumple::cli
