#include "cli/search_command.h"

#include <algorithm>

#include <fmt/ranges.h>

#include "cli/bodies_of_files.h"
#include "cli/commands.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"
#include "io/lists/feature_kinds.h"

namespace crumple::cli {

ImpactQuery MotionOptions::query(const QueryOptions& query_options, Output output) const {
    ImpactQuery query;
    query.output = output;
    query.min_distance = min_distance;
    query.min_distance_share = share;
    query.approaching_only = approaching_only;
    query.weld = query_options.weld.value_or(false);
    query.filter.groups = query_options.filter.value_or(PairScope::both);
    return query;
}

void add_motion_options(CLI::App& app, MotionOptions& options) {
    add_number_option(
        app, "--min-distance", [&options](double value) { options.min_distance = value; }, any_distance,
        "Features touch if their distance is at most D, in the units of the coordinates")
        ->type_name("D");
    add_number_option(
        app, "--min-distance-share", [&options](double value) { options.share = value; },
        {1, "share of 0 or more and below 1"},
        "Features touch if their distance is at most S times their own distance at the start; with --min-distance, the "
        "larger one applies")
        ->type_name("S");
    app.add_flag("--approaching-only", options.approaching_only,
                 "Leave out features that touch at the start and come no nearer than they are there");
}

ProximityQuery NearOptions::query(const QueryOptions& query_options, Output output) const {
    ProximityQuery query;
    query.output = output;
    query.radius = radius.value_or(0);
    query.strict = below;
    query.weld = query_options.weld.value_or(false);
    query.filter.groups = query_options.filter.value_or(PairScope::both);
    return query;
}

CLI::Option* add_below_option(CLI::App& app, NearOptions& options) {
    return app.add_flag("--below", options.below,
                        "Features are near if their distance is below the radius, not equal to it");
}

void refuse_beside_features(const std::string& option_of_features, const QueryOptions& query_options) {
    const auto refuse_with = [&](const char* option, bool given) {
        if (given) refuse(std::string(option) + " does not go with " + option_of_features);
    };
    const QueryOptions usual;
    refuse_with("--neighbours", query_options.neighbours != usual.neighbours);
    refuse_with("--kind", query_options.kind != usual.kind);
    refuse_with("--part", query_options.part.has_value());
    refuse_with("--polygons", query_options.polygons);
    refuse_with("--contacts", query_options.contacts);
}

Options feature_options(Options options) {
    if (options.backend == Backend::automatic) options.backend = Backend::cpu;
    return options;
}

void ListOutputs::check(const std::string& what, const std::vector<std::string>& coloured) const {
    check_format(paths, format);
    for (const std::string& path : paths) {
        const std::string extension = extension_of(path, format);
        const bool is_coloured = std::find(coloured.begin(), coloured.end(), extension) != coloured.end();
        if (is_coloured || io::pair_format_of(extension) != io::PairFormat::automatic) continue;
        refuse("-o " + (path.empty() ? "''" : path) + (is_standard(path) ? " --format " + format : "") + ": " + what +
               fmt::format(" are written as .txt, .csv, .json or .npz{}{}", coloured.empty() ? "" : ", coloured as ",
                           fmt::join(coloured, ", ")));
    }
}

void ListOutputs::check_stream() const {
    const io::PairFormat list =
        paths.empty() ? io::PairFormat::txt : io::pair_format_of(extension_of(paths.front(), format));
    if (paths.size() > 1 || (list != io::PairFormat::txt && list != io::PairFormat::csv))
        refuse("--stream writes one list, as .txt or .csv");
}

bool ListOutputs::have_files() const { return !std::all_of(paths.begin(), paths.end(), is_standard); }

void add_output_options(CLI::App& app, ListOutputs& outputs, const std::string& what, const std::string& coloured) {
    app.add_option(
           "-o,--output", outputs.paths,
           what + " as .txt, .csv, .json or .npz, or " + coloured +
               ", as .glb. May be repeated. - is standard output, see --format. Without it, the text is printed")
        ->type_name("OUT")
        ->allow_extra_args(false);
    add_format_option(app, outputs.format, "txt|csv|json|npz|glb");
}

int SearchCommand::report(bool any, const ListWords& words) {
    to_standard_output([&](std::ostream& out) { out << (any ? words.some : words.none) << '\n'; });
    return any ? collided : done;
}

void SearchCommand::check_stream() const {
    if (!stream) return;
    if (check) refuse("--stream does not go with --check");
    outputs.check_stream();
}

int SearchCommand::finish_stream(const Statistics& statistics, const ListWords& words, std::int64_t triangles) const {
    const std::string found =
        fmt::format("{} {}{}", grouped(statistics.pairs), words.one, statistics.pairs == 1 ? "" : "s");
    if (stats) print_statistics(statistics, found);
    const std::string printed =
        statistics.pairs > 0 ? found : fmt::format("{}: {} triangles", words.none, grouped(triangles));
    return finish(statistics.pairs > 0, fmt::format("{}, {:.1f} ms\n", printed, statistics.milliseconds));
}

int SearchCommand::finish(bool any, const std::string& summary) const {
    if (!stats && (!any || outputs.have_files())) say(summary);
    return check && any ? collided : done;
}

void add_search_command_options(CLI::App& app, SearchCommand& command, const std::string& check) {
    app.add_flag("--check", command.check, check);
    app.add_flag("--stream", command.stream,
                 "Write the list, as .txt or .csv, while it is found, for results that exceed memory. Its order "
                 "differs from that without --stream, and does not depend on threads");
    app.add_flag("--stats", command.stats, "Print times and counts of the stages to standard error");
    add_progress_option(app, command.progress);
    add_reading_options(app, command.query_options);
    add_group_options(app, command.query_options);
    add_cost_options(app, command.options);
}

std::string kinds_of(const ResultSize& tally) {
    const auto count = [&](FeatureKind kind) { return tally.by_kind[static_cast<std::size_t>(kind)]; };
    std::string text = fmt::format("{} vertex-face, {} edge-edge", grouped(count(FeatureKind::vertex_face)),
                                   grouped(count(FeatureKind::edge_edge)));
    if (count(FeatureKind::vertex_edge) > 0)
        text += fmt::format(", {} vertex-edge", grouped(count(FeatureKind::vertex_edge)));
    if (count(FeatureKind::vertex_vertex) > 0)
        text += fmt::format(", {} vertex-vertex", grouped(count(FeatureKind::vertex_vertex)));
    return text;
}

std::string summary_of(const ResultSize& tally, const std::string& kinds, const ListWords& words,
                       std::int64_t triangles, const std::string& more) {
    if (tally.count == 0)
        return fmt::format("{}: {} triangles, {:.1f} ms\n", words.none, grouped(triangles), tally.milliseconds);
    return fmt::format("{} {}{} ({}){}, {:.1f} ms\n", grouped(tally.count), words.one, tally.count == 1 ? "" : "s",
                       kinds, more, tally.milliseconds);
}

Impacts only_first(const Impacts& impacts) {
    Impacts one = impacts;
    if (!one.first.found) return one;
    ImpactList& list = one[one.first.kind];
    list.pairs.push_back(one.first.pair);
    list.toi.push_back(one.first.toi);
    list.start.push_back(one.first.start ? 1 : 0);
    return one;
}

std::string summary_of_impacts(const ResultSize& tally, const FirstImpact& first, bool earliest,
                               std::int64_t triangles) {
    const std::string time = fmt::format("{:.6g}", first.toi);
    if (earliest && first.found) return fmt::format("the first impact is at {}, {:.1f} ms\n", time, tally.milliseconds);
    return summary_of(tally, kinds_of(tally), words_of_impacts, triangles, ", the first at " + time);
}

std::string kinds_of(const Candidates& candidates) {
    std::string text;
    for (const CandidateKind kind : io::all_kinds) {
        if (!candidates.listed[static_cast<std::size_t>(kind)]) continue;
        std::string name(candidate_kind_name(kind));
        name[name.find('_')] = '-';
        const std::string count = grouped(static_cast<std::int64_t>(candidates[kind].pairs.size()));
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, name);
    }
    return text;
}

std::string text_of(const io::FeatureRow& row, bool has_bodies) {
    return text_of(static_cast<const io::CandidateRow&>(row), has_bodies) + fmt::format(" {}", row.value);
}

std::string text_of(const io::CandidateRow& row, bool has_bodies) {
    std::string text(io::in_files(row.kind).keyword);
    for (std::size_t k = 0; k < io::id_count(row.kind); ++k) {
        const std::int32_t body = k < io::first_ids(row.kind) ? row.bodies.first : row.bodies.second;
        text += ' ' + (has_bodies ? fmt::format("{}:", body) : "") + std::to_string(row.ids[k]);
    }
    return text;
}

}  // namespace crumple::cli
