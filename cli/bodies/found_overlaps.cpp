#include "cli/bodies/found_overlaps.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "cli/choice.h"
#include "cli/statistics_table.h"
#include "cli/terminal.h"

namespace crumple::cli {
namespace {

constexpr NumberRange any_tolerance{std::numeric_limits<double>::infinity(), "tolerance above 0"};
constexpr NumberRange any_volume{std::numeric_limits<double>::infinity(), "volume of 0 or more"};

OverlapQuery query_of(const OverlapOptions& options, Output output, const BodyScene& scene, std::size_t count) {
    OverlapQuery query;
    query.output = output;
    query.min_volume = options.min_volume;
    query.regions = options.regions;
    query.depth_tolerance = options.depth_tolerance;
    query.directions = options.directions;
    query.first_free = options.first_free;
    query.self_overlaps = options.self || scene.names().size() == 1;
    query.open = options.open;  // query.weld is not set: vertices are welded when files are read
    query.filter.excluded_bodies = scene.excluded(count);
    return query;
}

/// Format of the sentence for each OverlapRelation but `undefined`, such as "a and b touch". The arguments are the
/// names.
constexpr std::array<const char*, 5> sentences{"{} and {} touch", "{} and {} overlap", "{} lies inside {}",
                                               "{1} lies inside {0}", "{} and {} fill the same space"};
/// Index in `kind_words` of each OverlapRelation but `undefined`.
constexpr std::array<std::size_t, 5> kinds{0, 1, 2, 2, 3};
constexpr std::array<const char*, 4> kind_words{"touching", "overlapping", "nested", "equal"};

std::string number_of_text(double number) { return fmt::format("{:.6g}", number + 0.0); }
/// Reads a direction, "0,0,1".
std::array<double, 3> direction_of(const std::string& text) {
    std::array<double, 3> direction{};
    const char *at = text.data(), *const end = at + text.size();
    for (std::size_t k = 0; k < 3; ++k) {
        if (k > 0 && (at == end || *at++ != ',')) refuse("--withdraw " + text + ": a direction is written as 0,0,1");
        const auto [next, error] = std::from_chars(at, end, direction[k]);
        if (error != std::errc() || !std::isfinite(direction[k]))
            refuse("--withdraw " + text + ": a direction is written as 0,0,1");
        at = next;
    }
    if (at != end) refuse("--withdraw " + text + ": a direction is written as 0,0,1");
    if (direction == std::array<double, 3>{}) refuse("--withdraw " + text + ": the direction must not be 0");
    return direction;
}

std::string vector_of_text(std::span<const double, 3> v) {
    return fmt::format("({} {} {})", number_of_text(v[0]), number_of_text(v[1]), number_of_text(v[2]));
}

/// Writes the depth, the withdrawals and the regions of a row, each on a line of its own. `region`: index of the row's
/// first region; set to that of the next row.
void write_parts(std::ostream& out, const io::OverlapList& list, std::size_t row, const std::string& unit,
                 std::size_t& region) {
    if (!list.depth_bound.empty() && !std::isnan(list.depth_bound[row]))
        out << "  greatest depth between " << number_of_text(list.depth_reached[row]) << " and "
            << number_of_text(list.depth_bound[row]) << unit << '\n';
    const std::size_t directions = list.withdrawals.size() / list.rows.size();
    for (std::size_t j = 0; j < directions; ++j) {
        const std::size_t at = row * directions + j;
        if (std::isnan(list.withdrawals[at])) continue;
        out << "  direction " << j << ": the second body ";
        const bool has_first = !list.first_free.empty() && !std::isnan(list.first_free[at]);
        if (has_first)
            out << "first does not overlap the first one at " << number_of_text(list.first_free[at]) << ", and ";
        out << "is past " << (has_first ? "it" : "the first one") << " after " << number_of_text(list.withdrawals[at])
            << " times the direction\n";
    }
    for (int number = 0; region < list.regions.size() && list.regions[region].row == static_cast<std::int32_t>(row);
         ++region, ++number) {
        const io::OverlapListRegion& r = list.regions[region];
        out << "  region " << number << ": volume " << number_of_text(r.volume()) << unit << (unit.empty() ? "" : "^3");
        if (!std::isnan(r.thickness())) out << ", thickness " << number_of_text(r.thickness()) << unit;
        out << ", from " << vector_of_text(r.low()) << " to " << vector_of_text(r.high()) << '\n';
    }
}

}  // namespace

std::vector<const CLI::Option*> add_overlap_options(CLI::App& app, OverlapOptions& options,
                                                    const std::string& condition) {
    std::vector<const CLI::Option*> added =
        add_body_options(app, options.bodies,
                         {condition.c_str(), "overlaps of these two bodies are left out",
                          "Rows have the number of their configuration"});
    const std::string min_volume =
        help_under(condition,
                   "only pairs of bodies that overlap by at least this volume, in the unit of the coordinates cubed. "
                   "Without it, or with 0, pairs that only touch count, too");
    const auto set = [&options](double value) { options.min_volume = value; };
    added.push_back(add_number_option(app, "--min-volume", set, any_volume, min_volume.c_str())->type_name("V"));
    added.push_back(app.add_flag("--self-overlaps", options.self,
                                 help_under(condition,
                                            "also the overlap of each body with itself, where it covers space twice. "
                                            "For a single body this is the default")));
    const std::string open = help_under(condition,
                                        "a body whose surface is not closed is an error if its volume is needed "
                                        "(error, the default), or is left out (skip)");
    added.push_back(add_choice<OpenSurfaces, OpenSurfaces>(
        app, "--open", options.open, {{"error", OpenSurfaces::error}, {"skip", OpenSurfaces::skip}}, open.c_str()));
    return added;
}

void add_overlap_parts(CLI::App& app, OverlapOptions& options) {
    app.add_flag("--regions", options.regions,
                 "also the connected regions of each overlap, with volume, thickness and box; not in .csv");
    const auto set = [&options](double value) {
        if (value == 0) refuse("--depth-tolerance must be above 0");
        options.depth_tolerance = value;
    };
    add_number_option(app, "--depth-tolerance", set, any_tolerance,
                      "also bounds on the greatest depth of any point, which differ by at most this; not in .csv")
        ->type_name("D");
    app.add_option_function<std::vector<std::string>>(
           "--withdraw",
           [&options](const std::vector<std::string>& given) {
               for (const std::string& direction : given) options.directions.push_back(direction_of(direction));
           },
           "also how far the second body has to move along this direction until it is past the first one, in multiples "
           "of the direction; may be repeated; not in .csv")
        ->type_name("X,Y,Z")
        ->allow_extra_args(false);
    app.add_flag(
        "--first-free", options.first_free,
        "with --withdraw: also how far the second body has to move until it does not overlap the first one for "
        "the first time; not in .csv");
}

namespace {

/// Collects results of searches in one configuration or in many.
class Collected {
   public:
    Collected(const BodyScene& scene, const OverlapOptions& options, Output output)
        : scene_(scene), bodies_(static_cast<std::int32_t>(scene.names().size())) {
        result_.list.has_configurations = !options.bodies.poses.empty();
        result_.list.has_numbers = output == Output::pairs;
        result_.list.has_regions = options.regions;
        result_.list.depth_tolerance = options.depth_tolerance;
        result_.list.has_first_free = options.first_free;
        for (const auto& direction : options.directions)
            result_.list.directions.insert(result_.list.directions.end(), direction.begin(), direction.end());
    }
    void add(const Overlaps& found, std::size_t first_configuration) {
        for (const std::int32_t body : found.skipped) skipped_.insert(body % bodies_);
        result_.any = result_.any || found.any;
        result_.list.add(found, bodies_, static_cast<std::int32_t>(first_configuration));
        result_.has_overlaps.insert(result_.has_overlaps.end(), found.world_hit.begin(), found.world_hit.end());
        cli::add(result_.statistics, found.statistics);
    }
    bool any() const { return result_.any; }
    /// Prints which bodies were skipped, and returns the result.
    FoundOverlaps finish() {
        scene_.print_skipped(skipped_, "left out");
        return std::move(result_);
    }

   private:
    const BodyScene& scene_;
    std::int32_t bodies_;
    FoundOverlaps result_;
    std::set<std::int32_t> skipped_;
};

void check_has_bodies(const BodyScene& scene) {
    if (scene.names().empty()) refuse("overlap needs bodies; " + scene.origins().files + " holds none");
}

}  // namespace

OverlapQuery overlap_query(const BodyScene& scene, const OverlapOptions& options, Output output) {
    check_has_bodies(scene);
    return query_of(options, output, scene, 1);
}

FoundOverlaps found_of(const Overlaps& overlaps, const BodyScene& scene, const OverlapOptions& options, Output output) {
    Collected collected(scene, options, output);
    collected.add(overlaps, 0);
    return collected.finish();
}

FoundOverlaps find_overlaps(SearchSession& search, const BodyScene& scene, const OverlapOptions& options,
                            Output output) {
    check_has_bodies(scene);
    if (!options.bodies.poses.empty()) {
        Collected collected(scene, options, output);
        scene.search_all(
            search, scene.read_poses(options.bodies.poses), false,
            [&](std::size_t count) { return query_of(options, output, scene, count); },
            [&](const Overlaps& found, std::size_t first, std::size_t) {
                collected.add(found, first);
                return output != Output::any || !collected.any();
            });
        return collected.finish();
    }
    const io::WorldView view = scene.mesh().view();
    const std::vector<Body> all = scene.bodies(1, false);
    const World world{view.shapes, all, view.poses};
    return found_of(search.find(scene.origins(), -1, world, query_of(options, output, scene, 1)), scene, options,
                    output);
}

void write_text(std::ostream& out, const io::OverlapList& list, const io::OverlapBodies& bodies) {
    const std::string unit = bodies.unit == io::Unit::unknown ? "" : std::string(" ") + io::name_of(bodies.unit);
    const auto name = [&](std::int32_t body) { return quoted_name(bodies.names[static_cast<std::size_t>(body)]); };
    std::size_t region = 0;
    for (std::size_t i = 0; i < list.rows.size(); ++i) {
        const io::OverlapListRow& row = list.rows[i];
        if (list.has_configurations) out << "configuration " << row.configuration << ": ";
        const bool with_itself = row.bodies.first == row.bodies.second;
        const char* const sentence =
            with_itself ? "{} overlaps itself" : sentences[static_cast<std::size_t>(row.relation)];
        out << fmt::format(fmt::runtime(sentence), name(row.bodies.first), name(row.bodies.second));
        if (list.has_numbers) {
            out << ": volume " << number_of_text(row.volume()) << unit << (unit.empty() ? "" : "^3");
            if (!std::isnan(row.mean_depth())) out << ", mean depth " << number_of_text(row.mean_depth()) << unit;
            const std::array<double, 3> normal = row.normal();
            if (!std::isnan(normal[0])) out << ", normal " << vector_of_text(normal);
        }
        out << '\n';
        write_parts(out, list, i, unit, region);
    }
}

std::string relations_of(const io::OverlapList& list) {
    std::array<std::int64_t, kind_words.size()> counts{};
    for (const io::OverlapListRow& row : list.rows)
        if (row.bodies.first != row.bodies.second) ++counts[kinds[static_cast<std::size_t>(row.relation)]];
    std::string text;
    for (std::size_t k = 0; k < counts.size(); ++k)
        if (counts[k] > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(counts[k]), kind_words[k]);
    return text;
}

std::string summary_of(const FoundOverlaps& found, std::size_t bodies) {
    const std::vector<io::OverlapListRow>& rows = found.list.rows;
    const std::string all = grouped(static_cast<std::int64_t>(bodies)),
                      time = fmt::format("{:.1f} ms\n", found.statistics.milliseconds);
    if (rows.empty())
        return bodies == 1 ? "the body does not overlap itself: " + time
                           : fmt::format("nothing overlaps: {} bodies, {}", all, time);
    std::vector<std::uint8_t> hit(bodies);
    std::int64_t pairs = 0;
    for (const io::OverlapListRow& row : rows) {
        pairs += row.bodies.first != row.bodies.second;
        for (const std::int32_t b : {row.bodies.first, row.bodies.second}) hit[static_cast<std::size_t>(b)] = 1;
    }
    const std::int64_t alone = std::ssize(rows) - pairs;
    std::string text;
    if (pairs > 0)
        text =
            fmt::format("{} pair{} of bodies ({}), ", grouped(pairs), pairs == 1 ? "" : "s", relations_of(found.list));
    if (alone > 0) text += alone == 1 ? "1 body overlaps itself, " : grouped(alone) + " bodies overlap themselves, ";
    return text + fmt::format("{} of {} bodies, {}", grouped(std::count(hit.begin(), hit.end(), 1)), all, time);
}

}  // namespace crumple::cli
