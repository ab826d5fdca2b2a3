#include "cli/verify_features.h"

#include <algorithm>
#include <iostream>
#include <tuple>

#include <fmt/format.h>

#include "cli/bodies.h"
#include "cli/commands.h"
#include "cli/print_some.h"
#include "cli/search.h"

namespace crumple::cli {
namespace {

using io::FeatureRow;

auto features_of(const FeatureRow& row) { return std::tie(row.kind, row.bodies, row.ids); }

/// What touches at the start does so before what touches later in the same float64.
auto value_of(const FeatureRow& row) { return std::tuple(row.value, !row.flag); }

/// A row of the list with a wrong value, and the right one.
struct Wrong {
    FeatureRow listed, right;
};

struct FeatureComparison {
    std::vector<FeatureRow> missed, false_ones, repeated;
    std::vector<Wrong> larger, smaller;  ///< than they should be

    bool right() const {
        return missed.empty() && false_ones.empty() && repeated.empty() && larger.empty() && smaller.empty();
    }
};

/// Rows in any order. `flags`: whether these count.
FeatureComparison compare(std::vector<FeatureRow> list, std::vector<FeatureRow> answer, bool flags) {
    const auto before = [](const FeatureRow& a, const FeatureRow& b) { return features_of(a) < features_of(b); };
    std::stable_sort(list.begin(), list.end(), before);
    std::sort(answer.begin(), answer.end(), before);
    FeatureComparison result;
    auto exact = answer.begin();
    for (auto row = list.begin(); row != list.end();) {
        for (; exact != answer.end() && before(*exact, *row); ++exact) result.missed.push_back(*exact);
        const auto next = std::upper_bound(row, list.end(), *row, before);
        if (next - row > 1) result.repeated.push_back(*row);
        if (exact == answer.end() || before(*row, *exact)) {
            result.false_ones.push_back(*row);
        } else {
            FeatureRow listed = *row;
            if (!flags) listed.flag = exact->flag;
            if (value_of(*exact) < value_of(listed)) result.larger.push_back({listed, *exact});
            if (value_of(listed) < value_of(*exact)) result.smaller.push_back({listed, *exact});
            ++exact;
        }
        row = next;
    }
    result.missed.insert(result.missed.end(), exact, answer.end());
    return result;
}

/// How the two questions call things.
struct Words {
    const char *what, *larger, *smaller;
    bool flags;  ///< lists of text have them
};
constexpr Words of_impacts{"impacts", "late", "early", true}, of_near{"near pairs", "far", "close", false};

int print_verdict(const io::FeatureList& list, const io::FeatureList& answer, const Words& words, bool has_bodies) {
    const FeatureComparison comparison = compare(list.rows, answer.rows, words.flags);
    const bool right = comparison.right();
    const auto colour = fmt::fg(right ? fmt::terminal_color::green : fmt::terminal_color::red);
    const std::string verdict = fmt::format(on_terminal(1, colour | fmt::emphasis::bold), right ? "right" : "wrong");
    to_standard_output([&](std::ostream& out) {
        out << fmt::format("{}: {} {}, {} missed, {} false, {} {}, {} {}, {} repeated\n", verdict, answer.rows.size(),
                           words.what, comparison.missed.size(), comparison.false_ones.size(), comparison.larger.size(),
                           words.larger, comparison.smaller.size(), words.smaller, comparison.repeated.size());
        const auto text = [&](const FeatureRow& row) { return text_of(row, has_bodies); };
        const auto with_right = [&](const Wrong& row) {
            const bool same = row.listed.value == row.right.value;  // then it is the flag that is wrong
            return text(row.listed) + fmt::format(", it is {}", row.right.value) +
                   (!same            ? ""
                    : row.right.flag ? " at the start"
                                     : " after the start");
        };
        print_some(out, "missed", comparison.missed, text);
        print_some(out, "false", comparison.false_ones, text);
        print_some(out, words.larger, comparison.larger, with_right);
        print_some(out, words.smaller, comparison.smaller, with_right);
        print_some(out, "repeated", comparison.repeated, text);
    });
    return right ? done : collided;
}

io::FeatureList read_list(const std::string& path, const std::string& format, bool impacts, bool two_files) {
    if (!format.empty() && !is_standard(path)) refuse("--format is for a list from standard input, -");
    const std::string name = is_standard(path) ? "standard input" + (format.empty() ? "" : "." + format) : path;
    io::FeatureList list = is_standard(path)
                               ? impacts ? io::read_impacts(std::cin, name) : io::read_near(std::cin, name)
                           : impacts ? io::read_impacts(path)
                                     : io::read_near(path);
    if (!list.rows.empty() && list.has_bodies != two_files)
        refuse(name +
               (two_files ? ": ids of two files are 0:ID and 1:ID" : ": ids of one mesh have no number of a file"));
    return list;
}

}  // namespace

bool FeatureCheck::wanted(const AnswerOptions& answer) const {
    if (motion.any() && !impacts) refuse("--separation and --separation-share need --impacts");
    if (near.below && !near.radius) refuse("--below needs --near");
    if (!impacts && !near.radius) return false;
    if (impacts && near.radius) refuse("--impacts and --near are two questions");
    refuse_beside_features(impacts ? "--impacts" : "--near", answer);
    return true;
}

void add_feature_check_options(CLI::App& app, FeatureCheck& check) {
    app.add_flag("--impacts", check.impacts,
                 "The list is one of impacts, as crumple impacts writes it, and so are the other files: START and END. "
                 "Besides what is missed or false, times are checked: late, or early");
    add_motion_options(app, check.motion);
    add_number_option(
        app, "--near", [&check](double value) { check.near.radius = value; }, any_distance,
        "The list is one of near pairs within this radius, as crumple near writes it. Squared distances are checked, "
        "too: far, or close")
        ->type_name("R");
    add_below_option(app, check.near);
}

int verify_features(const FeatureCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const AnswerOptions& answer, const Options& options) {
    if (check.impacts && files.size() != 3) refuse("verify --impacts takes START, END and a list");
    Search search(answer, feature_options(options));
    check_standard_input(files);
    const bool two_files = !check.impacts && files.size() == 3;
    const io::FeatureList list = read_list(files.back(), format, check.impacts, two_files);
    if (check.impacts) {
        const MovingInput input = read_moving_input(files[0], files[1], answer);
        const Impacts& found = search.find(input.start, input.end, check.motion.question(answer, MotionWants::impacts));
        return print_verdict(list, io::list_of(found), of_impacts, false);
    }
    const Input input = read_input({files.begin(), files.end() - 1}, with_lines_and_points(answer));
    const Nearby& found = search.find(input, check.near.question(answer, NearWants::pairs));
    return print_verdict(list, io::list_of(found), of_near, two_files);
}

}  // namespace crumple::cli
