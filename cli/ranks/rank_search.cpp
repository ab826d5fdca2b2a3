#include "cli/ranks/rank_search.h"

#include <chrono>
#include <functional>
#include <optional>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/ranks/guarded_ranks.h"
#include "cli/ranks/rank_input.h"
#include "cli/ranks/rank_link.h"
#include "cli/ranks/rank_lists.h"
#include "cli/ranks/rank_statistics.h"
#include "cli/ranks/ranks.h"
#include "cli/search.h"
#include "cli/statistics_table.h"
#include "cli/steps.h"
#include "cli/threads.h"
#include "crumple/mpi.h"
#include "io/bytes/gzip.h"
#include "io/lists/feature_tables.h"
#include "io/lists/pairs.h"

namespace crumple::cli {
namespace {

/// Throws Error (invalid_argument) if an option is not supported for several ranks, or if options conflict.
void check_options(const SearchCommand& command) {
    if (command.query_options.of_bodies()) refuse_on_ranks("--groups bodies");
    if (command.query_options.groups == "components") refuse_on_ranks("--groups components");
    if (command.query_options.polygons) refuse_on_ranks("--polygons");
    if (command.query_options.part) refuse_on_ranks("--part");
    if (command.stream) refuse_on_ranks("--stream");
    for (const std::string& path : command.outputs.paths) {
        if (io::has_gzip_name(path)) refuse_on_ranks("-o " + path + ", a compressed file,");
        const std::string extension = extension_of(path, command.outputs.format);
        if (io::pair_format_of(extension) == io::PairFormat::automatic) refuse_on_ranks("a coloured " + extension);
    }
    command.query_options.check();
    check_cost_options(command.options);
}

/// Makes the detector print the phases of its calls as steps. `steps` must outlive these calls.
void print_phases(mpi::Detector& detector, const Steps& steps) {
    using Clock = std::chrono::steady_clock;
    detector.set_progress([&steps, last = Clock::time_point()](const DistributedProgress& progress) mutable {
        const bool begins = progress.parts_done == 0;
        // Prints the number of parts at most once a second: a part may take minutes, or almost no time.
        if (!begins && Clock::now() - last < std::chrono::seconds(1)) return;
        last = Clock::now();
        steps.begin(begins ? std::string(phase_name(progress.phase))
                           : fmt::format("{}, {} of {} parts done", phase_name(progress.phase), progress.parts_done,
                                         progress.parts));
    });
}

/// Description of a result: the remark in the table of --stats, and the summary.
struct ResultTexts {
    std::string remark, summary;
};

ResultTexts description_of(RankLink& link, const IntersectionQuery&, const DistributedIntersections& found,
                           io::Blocks triangles, double milliseconds) {
    const std::int64_t hits = count_hits(link, found, triangles);
    return {fmt::format("{} triangles collide", grouped(hits)),
            summary_of_pairs(found.count, hits, triangles.rows, "triangles", milliseconds)};
}

/// Describes impacts or near pairs.
template <class Query>
ResultTexts description_of(RankLink& link, const Query& query, const typename Query::DistributedResult& found,
                           io::Blocks triangles, double milliseconds) {
    ResultSize tally{found.count, {}, milliseconds};
    for (std::size_t kind = 0; kind < tally.by_kind.size(); ++kind)
        tally.by_kind[kind] = link.sum(static_cast<std::int64_t>(found.lists[kind].pairs.size()));
    if constexpr (std::is_same_v<Query, ProximityQuery>) {
        return {kinds_of(tally), summary_of_near(tally, triangles.rows)};
    } else {
        const bool earliest = query.output == Output::first;
        return {earliest ? only_first_remark : kinds_of(tally),
                summary_of_impacts(tally, found.first, earliest, triangles.rows)};
    }
}

/// Collective. Writes a list to all outputs, or prints it if there are none. All ranks write .txt and .csv together,
/// unless `by_first`. Rank 0 writes other formats, and with `by_first` all formats, from the collected result, after
/// complete(result) has set the members that do not follow from the rows.
template <class Result>
void write(RankLink& link, const ListOutputs& outputs, const RankList<Result>& list, bool by_first,
           const std::function<void(Result&)>& complete) {
    std::optional<Result> all;
    const bool printed = outputs.paths.empty();
    for (const std::string& path : printed ? std::vector<std::string>{"-"} : outputs.paths) {
        const io::PairFormat format = io::pair_format_of(extension_of(path, printed ? "txt" : outputs.format));
        if (!by_first && (format == io::PairFormat::txt || format == io::PairFormat::csv)) {
            write_text(link, path, list.table, list.sections, format == io::PairFormat::csv);
            continue;
        }
        if (!all) complete(all.emplace(list.collect()));
        link.run_checked([&] {
            if (!link.is_first()) return;
            if (!is_standard(path)) return io::write_list(path, io::table_of(*all), format);
            to_standard_output([&](std::ostream& out) { io::write_list(out, io::table_of(*all), format); });
        });
    }
}

template <class Query>
int search(RankLink& link, const SearchCommand& command, const std::vector<std::string>& files, Query query) {
    constexpr bool of_features = !std::is_same_v<Query, IntersectionQuery>;
    constexpr ListWords words = !of_features                         ? words_of_pairs
                                : std::is_same_v<Query, ImpactQuery> ? words_of_impacts
                                                                     : words_of_near;
    link.run_checked([&] { check_outputs(command.outputs.paths, files, command.query_options, link.is_first()); });
    std::optional<AllowedThreads> threads;
    if (command.options.threads) threads.emplace(command.options.threads);
    const Steps steps(command.progress);
    steps.begin("read");
    const RankInput input = read_on_ranks(link, files, command.query_options, of_features);
    query.weld = query.weld || input.weld;
    DistributedOptions options;
    options.detector = of_features ? feature_options(command.options) : command.options;
    mpi::Detector detector(MPI_COMM_WORLD, options);
    print_phases(detector, steps);
    const auto find = [&]() -> const auto& {
        try {
            return detector.find(input.local_mesh(), query);
        } catch (const Error& error) {
            throw with_name(files.size() > 1 ? files[0] + " to " + files[1] : files[0], without_rank(error));
        }
    };
    const auto& found = find();
    const auto report = [&] {
        int status = done;
        link.run_checked([&] { status = SearchCommand::report(found.any, words); });
        return status;
    };
    if (query.output == Output::any) return report();
    DistributedStatistics statistics = found.statistics;
    statistics.search.threads = detector.options().detector.threads;
    statistics.search.triangles = input.triangles.rows;
    statistics.search.pairs = found.count;
    statistics = total(link, statistics);
    const ResultTexts description = description_of(link, query, found, input.triangles, statistics.milliseconds);
    if (command.stats) print_statistics(link, statistics, description.remark);
    if (command.only_status()) return report();
    steps.begin("write");
    using Result = typename Query::Result;
    write<Result>(link, command.outputs, rank_list_of(link, input, query, found), query.output == Output::first,
                  [&](Result& all) {
                      all.any = found.any;
                      all.statistics = statistics.search;
                      if constexpr (std::is_same_v<Result, Impacts>) {
                          all.first = found.first;
                          if (query.output == Output::first) all = only_first(all);
                      }
                  });
    return command.finish(found.any, description.summary);
}

}  // namespace

void refuse_on_ranks(const std::string& what) {
    throw Error(ErrorCode::invalid_argument, what + " is not supported on several ranks: run it in one process",
                Element::option);
}

template <class Query>
int search_on_ranks(const SearchCommand& command, const std::vector<std::string>& files, const Query& query) {
    check_options(command);
    return guarded_on_ranks([&] {
        RankLink link;
        return search(link, command, files, query);
    });
}

template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const IntersectionQuery&);
template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const ImpactQuery&);
template int search_on_ranks(const SearchCommand&, const std::vector<std::string>&, const ProximityQuery&);

}  // namespace crumple::cli
