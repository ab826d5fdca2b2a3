#include "cli/commands/verify_overlaps.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/commands/list_comparison.h"
#include "cli/print_some.h"

namespace crumple::cli {
namespace {

using io::OverlapListRow;

/// Row of the list with wrong contents, and the same row with the right contents.
struct WrongOverlap {
    OverlapListRow listed, right;
};

/// True if both numbers are equal, or both are NaN. Ignores the sign of 0, which is lost in JSON.
bool is_same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Describes the first quantity that differs, with the listed and the right number: "volume 0.5, it is 0.25". Returns
/// an empty text if none differs.
std::string difference(std::span<const io::OverlapQuantity> quantities, std::span<const double> all_listed,
                       std::span<const double> all_right) {
    std::size_t place = 0;
    for (const io::OverlapQuantity& quantity : quantities) {
        const auto listed = all_listed.subspan(place, quantity.width), right = all_right.subspan(place, quantity.width);
        if (!std::equal(listed.begin(), listed.end(), right.begin(), is_same_number))
            return fmt::format("{} {}, it is {}", quantity.name, fmt::join(listed, " "), fmt::join(right, " "));
        place += quantity.width;
    }
    return {};
}

/// Comparison of the numbers of rows of two lists.
class RowNumbers {
   public:
    RowNumbers(const io::OverlapList& list, const io::OverlapList& right) : list_(list), right_(right) {}

    /// Describes the first number that differs, as above.
    std::string difference(const WrongOverlap& row) const {
        if (!list_.has_numbers) return {};
        std::string text = cli::difference(io::overlap_quantities, row.listed.numbers, row.right.numbers);
        const std::size_t directions = list_.directions.size() / 3;
        for (const auto& [name, numbers, count] :
             {std::tuple("depth_reached", &io::OverlapList::depth_reached, std::size_t{1}),
              std::tuple("depth_bound", &io::OverlapList::depth_bound, std::size_t{1}),
              std::tuple("withdrawals", &io::OverlapList::withdrawals, directions),
              std::tuple("first_free", &io::OverlapList::first_free, directions)})
            if (text.empty()) text = difference(name, list_.*numbers, right_.*numbers, count, row);
        return text.empty() && list_.has_regions ? difference_of_regions(row) : text;
    }

   private:
    static std::string difference(const char* name, const std::vector<double>& listed, const std::vector<double>& right,
                                  std::size_t count, const WrongOverlap& row) {
        if (listed.empty()) return {};
        const auto of = [&](const std::vector<double>& numbers, const OverlapListRow& at) {
            return std::span(numbers).subspan(static_cast<std::size_t>(at.place) * count, count);
        };
        const auto given = of(listed, row.listed), exact = of(right, row.right);
        if (std::equal(given.begin(), given.end(), exact.begin(), is_same_or_null)) return {};
        return fmt::format("{} {}, it is {}", name, fmt::join(given, " "), fmt::join(exact, " "));
    }

    std::string difference_of_regions(const WrongOverlap& row) const {
        const auto listed = list_.regions_of(row.listed), right = right_.regions_of(row.right);
        if (listed.size() != right.size()) return fmt::format("{} regions, it has {}", listed.size(), right.size());
        for (std::size_t r = 0; r < listed.size(); ++r)
            if (const std::string text = cli::difference(io::region_quantities, listed[r].numbers, right[r].numbers);
                !text.empty())
                return fmt::format("region {}: {}", r, text);
        return {};
    }

    /// True if the numbers are the same. NaN may stand for infinity, as JSON has null for both.
    static bool is_same_or_null(double listed, double right) {
        return is_same_number(listed, right) || (std::isnan(listed) && std::isinf(right));
    }

    const io::OverlapList &list_, &right_;
};

int print_overlap_verdict(const io::OverlapList& list, const io::OverlapList& right_list,
                          const std::vector<std::string>& names) {
    std::vector<WrongOverlap> relations, numbers;
    const RowNumbers row_numbers(list, right_list);
    const auto key = [](const OverlapListRow& row) { return std::tie(row.configuration, row.bodies); };
    const auto comparison =
        compare_rows(list.rows, right_list.rows, key, [&](const OverlapListRow& listed, const OverlapListRow& exact) {
            if (listed.relation != exact.relation) relations.push_back({listed, exact});
            if (!row_numbers.difference({listed, exact}).empty()) numbers.push_back({listed, exact});
        });
    const bool right = comparison.right() && relations.empty() && numbers.empty();
    to_standard_output([&](std::ostream& out) {
        out << fmt::format(
            "{}: {} overlaps, {} missed, {} false, {} of another relation, {} of other numbers, {} "
            "repeated\n",
            verdict(right), right_list.rows.size(), comparison.missed.size(), comparison.false_ones.size(),
            relations.size(), numbers.size(), comparison.repeated.size());
        const auto name = [&](std::int32_t body) { return quoted_name(names[static_cast<std::size_t>(body)]); };
        const auto text = [&](const OverlapListRow& row) {
            return (list.has_configurations ? fmt::format("configuration {}: ", row.configuration) : "") +
                   name(row.bodies.first) + " and " + name(row.bodies.second);
        };
        print_some(out, "missed", comparison.missed, text);
        print_some(out, "false", comparison.false_ones, text);
        print_some(out, "relation of", relations, [&](const WrongOverlap& row) {
            return fmt::format("{}: {}, it is {}", text(row.right), io::name_of(row.listed.relation),
                               io::name_of(row.right.relation));
        });
        print_some(out, "numbers of", numbers,
                   [&](const WrongOverlap& row) { return text(row.right) + ": " + row_numbers.difference(row); });
        print_some(out, "repeated", comparison.repeated, text);
    });
    return right ? done : collided;
}

}  // namespace

bool OverlapCheck::is_requested(const FeatureCheck& features, const QueryOptions& query_options) const {
    for (const CLI::Option* const option : of_overlaps)
        if (*option && !overlaps) refuse(option->get_name() + " needs --overlaps");
    if (!overlaps) return false;
    if (features.any()) refuse("--impacts, --candidates, --radius and --overlaps exclude each other");
    (void)features.is_requested(query_options);  // throws if an option is given that needs --impacts and so on
    refuse_beside_features("--overlaps", query_options);
    if (!query_options.groups.empty()) refuse("--groups does not go with --overlaps, which are between bodies");
    if (query_options.filter) refuse("--filter does not go with --overlaps, which are between bodies");
    return true;
}

void add_overlap_check_options(CLI::App& app, OverlapCheck& check) {
    app.add_flag(
        "--overlaps", check.overlaps,
        "The list has overlaps, a .csv, .json or .npz as crumple overlap -o writes it; the other files contain the "
        "bodies. Besides missed and false overlaps, reports relations and numbers that differ, even in the last bit");
    check.of_overlaps = add_overlap_options(app, check.options, "With --overlaps: ");
}

int verify_overlaps(const OverlapCheck& check, const std::vector<std::string>& files, const std::string& format,
                    const QueryOptions& query_options, const Options& options) {
    const std::string& path = files.back();
    if (!format.empty() && !is_standard(path)) refuse("--format is for a list from standard input, -");
    std::vector<std::string> inputs = files;
    check.options.bodies.add_files(inputs);
    check_standard_input(inputs);
    SearchSession search(query_options, feature_options(options));
    const BodyScene scene({files.begin(), files.end() - 1}, query_options, check.options.bodies);
    const bool has_configurations = !check.options.bodies.poses.empty();
    const io::OverlapList list =
        is_standard(path) ? io::read_overlaps(std::cin, "standard input" + (format.empty() ? "" : "." + format),
                                              scene.names(), has_configurations)
                          : io::read_overlaps(path, scene.names(), has_configurations);
    OverlapOptions overlap = check.options;
    overlap.regions = list.has_regions;
    overlap.depth_tolerance = list.depth_tolerance;
    overlap.first_free = list.has_first_free;
    for (std::size_t j = 0; j + 2 < list.directions.size(); j += 3)
        overlap.directions.push_back({list.directions[j], list.directions[j + 1], list.directions[j + 2]});
    const FoundOverlaps found =
        find_overlaps(search, scene, overlap, list.has_numbers ? Output::pairs : Output::body_pairs);
    return print_overlap_verdict(list, found.list, scene.names());
}

}  // namespace crumple::cli
