#include "cli/commands/verify_features.h"

#include <algorithm>
#include <iostream>
#include <tuple>
#include <vector>

#include <fmt/format.h>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/commands/list_comparison.h"
#include "cli/print_some.h"
#include "cli/search.h"

namespace crumple::cli {
namespace {

using io::FeatureRow;

constexpr auto features_of = [](const auto& row) { return std::tie(row.kind, row.bodies, row.ids); };

/// Returns a key that orders rows by time or distance. Of rows with equal values, those with the flag (contact at the
/// start of the step) come first.
auto value_of(const FeatureRow& row) { return std::tuple(row.value, !row.flag); }

/// Row of the list with a wrong value, and the same row with the right value.
struct Wrong {
    FeatureRow listed, right;
};

/// Words for messages about one kind of list: what is listed, and adjectives for rows whose values are too large or too
/// small.
struct VerdictWords {
    const char *what, *larger, *smaller;
    bool flags;  ///< false: flags are not checked, because .txt lists of this kind have none
};
constexpr VerdictWords of_impacts{"impacts", "late", "early", true},
    of_triangle_pairs{"pairs of triangles", "late", "early", true}, of_near{"near pairs", "far", "close", false};

int print_verdict(const io::FeatureList& list, const io::FeatureList& right_list, const VerdictWords& words,
                  bool has_bodies) {
    std::vector<Wrong> larger, smaller;  // rows whose value_of() is larger or smaller than the right one
    const auto comparison =
        compare_rows(list.rows, right_list.rows, features_of, [&](FeatureRow listed, const FeatureRow& exact) {
            if (!words.flags) listed.flag = exact.flag;
            if (value_of(exact) < value_of(listed)) larger.push_back({listed, exact});
            if (value_of(listed) < value_of(exact)) smaller.push_back({listed, exact});
        });
    const bool right = comparison.right() && larger.empty() && smaller.empty();
    to_standard_output([&](std::ostream& out) {
        out << fmt::format("{}: {} {}, {} missed, {} false, {} {}, {} {}, {} repeated\n", verdict(right),
                           right_list.rows.size(), words.what, comparison.missed.size(), comparison.false_ones.size(),
                           larger.size(), words.larger, smaller.size(), words.smaller, comparison.repeated.size());
        const auto text = [&](const FeatureRow& row) { return text_of(row, has_bodies); };
        const auto with_right = [&](const Wrong& row) {
            const bool same = row.listed.value == row.right.value;  // if the values are equal, the flag is wrong
            return text(row.listed) + fmt::format(", it is {}", row.right.value) +
                   (!same            ? ""
                    : row.right.flag ? " at the start"
                                     : " after the start");
        };
        print_some(out, "missed", comparison.missed, text);
        print_some(out, "false", comparison.false_ones, text);
        print_some(out, words.larger, larger, with_right);
        print_some(out, words.smaller, smaller, with_right);
        print_some(out, "repeated", comparison.repeated, text);
    });
    return right ? done : collided;
}

int print_verdict(const io::CandidateRows& list, const io::CandidateRows& right_list) {
    const auto comparison = compare_rows(list.rows, right_list.rows, features_of, [](const auto&, const auto&) {});
    const bool right = comparison.right();
    to_standard_output([&](std::ostream& out) {
        out << fmt::format("{}: {} candidates, {} missed, {} false, {} repeated\n", verdict(right),
                           right_list.rows.size(), comparison.missed.size(), comparison.false_ones.size(),
                           comparison.repeated.size());
        const auto text = [](const io::CandidateRow& row) { return text_of(row, false); };
        print_some(out, "missed", comparison.missed, text);
        print_some(out, "false", comparison.false_ones, text);
        print_some(out, "repeated", comparison.repeated, text);
    });
    return right ? done : collided;
}

/// Reads a list by read_file(path), or by read_stream(in, name) if it comes from standard input. Checks that `format`
/// is given only for standard input, and that ids name files if and only if there are two.
template <class ReadFile, class ReadStream>
auto read_list(const std::string& path, const std::string& format, bool two_files, ReadFile read_file,
               ReadStream read_stream) {
    if (!format.empty() && !is_standard(path)) refuse("--format is for a list from standard input, -");
    const std::string name = is_standard(path) ? "standard input" + (format.empty() ? "" : "." + format) : path;
    auto list = is_standard(path) ? read_stream(std::cin, name) : read_file(path);
    if (!list.rows.empty() && list.has_bodies != two_files)
        refuse(name + (two_files ? ": ids of two files must be 0:ID or 1:ID"
                                 : ": ids of one mesh must have no file number, 0: or 1:"));
    return list;
}

int verify_impacts(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                   const QueryOptions& query_options, SearchSession& search) {
    const io::FeatureList list = read_list(
        files.back(), format, false, [](const auto& path) { return io::read_impacts(path); },
        [](auto& in, const auto& name) { return io::read_impacts(in, name); });
    const MovingInput input = read_moving_input(files[0], files[1], query_options);
    // A list may have rows of features, rows of pairs of triangles, or both. Only what it has is searched for.
    const auto is_of_triangles = [](const FeatureRow& row) { return row.kind == CandidateKind::face_face; };
    const bool of_triangles = std::any_of(list.rows.begin(), list.rows.end(), is_of_triangles);
    const bool of_features = !of_triangles || !std::all_of(list.rows.begin(), list.rows.end(), is_of_triangles);
    ImpactQuery query = check.motion.query(query_options, Output::pairs);
    query.triangle_pairs = of_triangles;
    io::FeatureList right = io::list_of(search.find(input.start, query, &input.end));
    if (!of_features) std::erase_if(right.rows, [&](const FeatureRow& row) { return !is_of_triangles(row); });
    return print_verdict(list, right, of_features ? of_impacts : of_triangle_pairs, false);
}

int verify_candidates(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                      const QueryOptions& query_options, SearchSession& search) {
    const io::CandidateRows list = read_list(
        files.back(), format, false, [](const auto& path) { return io::read_candidates(path); },
        [](auto& in, const auto& name) { return io::read_candidates(in, name); });
    const StepOrStatic input = read_step_or_static(files[0], files.size() == 3 ? files[1] : "", query_options);
    const Candidates& found =
        search.find(input.start, check.candidate_options.query(query_options), input.end_or_null());
    return print_verdict(list, io::list_of(found));
}

int verify_near(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                const QueryOptions& query_options, SearchSession& search) {
    const bool two_files = files.size() == 3;
    const io::FeatureList list = read_list(
        files.back(), format, two_files, [](const auto& path) { return io::read_near(path); },
        [](auto& in, const auto& name) { return io::read_near(in, name); });
    const QueryOptions reading = near_reading(check.filters, query_options);
    InputMeshes input = read_input({files.begin(), files.end() - 1}, reading);
    const NearFilters given(check.filters, input, reading);
    ProximityQuery query = check.near.query(query_options, Output::pairs);
    given.apply(query);
    const Proximities& found = search.find(input, query);
    return print_verdict(list, io::list_of(found), of_near, two_files);
}

}  // namespace

bool FeatureCheck::is_requested(const QueryOptions& query_options) const {
    if (motion.any() && !impacts) refuse("--min-distance, --min-distance-share and --approaching-only need --impacts");
    for (const CLI::Option* const option : of_near)
        if (*option && !near_pairs()) refuse(option->get_name() + " needs --radius or --radii");
    for (const CLI::Option* const option : of_candidates)
        if (*option && !candidates) refuse(option->get_name() + " needs --candidates");
    const std::string of_lists = near.radius ? "--radius" : "--radii";
    if (impacts + candidates + near_pairs() > 1)
        refuse("--impacts, --candidates and " + of_lists + " exclude each other");
    if (!any()) return false;
    refuse_beside_features(impacts ? "--impacts" : candidates ? "--candidates" : of_lists, query_options);
    return true;
}

void add_feature_check_options(CLI::App& app, FeatureCheck& check) {
    app.add_flag("--impacts", check.impacts,
                 "The list has impacts, as crumple impacts writes it; the other files are START and END. Besides "
                 "missed and false impacts, reports times that are late or early");
    add_motion_options(app, check.motion);
    app.add_flag("--candidates", check.candidates,
                 "The list has candidates, as crumple impacts --candidates writes it; the other files are START and "
                 "optionally END");
    check.of_candidates = add_candidate_options(app, check.candidate_options, "--candidates");
    CLI::Option* const radius = add_number_option(
        app, "--radius", [&check](double value) { check.near.radius = value; }, any_distance,
        "The list has near pairs within this radius, as crumple near --radius writes it. Besides missed and false "
        "pairs, reports squared distances that are far (too large) or close (too small)");
    radius->type_name("R");
    check.of_near = add_near_filter_options(app, check.filters);
    check.of_near.push_back(add_below_option(app, check.near));
    radius->excludes("--radii");
}

int verify_features(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const QueryOptions& query_options, const Options& options) {
    if (check.impacts && files.size() != 3) refuse("verify --impacts takes START, END and a list");
    SearchSession search(query_options, feature_options(options));
    std::vector<std::string> inputs = files;
    for (const std::string& file : check.filters.files()) inputs.push_back(file);
    check_standard_input(inputs);
    if (check.impacts) return verify_impacts(check, files, format, query_options, search);
    if (check.candidates) return verify_candidates(check, files, format, query_options, search);
    return verify_near(check, files, format, query_options, search);
}

}  // namespace crumple::cli
