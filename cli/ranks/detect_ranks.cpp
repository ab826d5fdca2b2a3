#include "cli/ranks/detect_ranks.h"

#include <algorithm>

#include "cli/commands.h"
#include "cli/ranks/rank_command.h"
#include "cli/ranks/rank_input.h"
#include "cli/ranks/rank_output.h"
#include "cli/ranks/rank_rows.h"
#include "cli/ranks/rank_statistics.h"
#include "cli/statistics_table.h"
#include "crumple/mpi.h"

namespace crumple::cli {
namespace {

void check_is_shared(const RanksDetection& asked) {
    check_shared_groups(asked.answer);
    if (asked.files.size() > 1) refuse_on_ranks("a second mesh");
    if (asked.answer.polygons) refuse_on_ranks("--polygons");
    if (asked.answer.part) refuse_on_ranks("--part");
    if (asked.stream) refuse_on_ranks("--stream");
    check_shared_outputs(asked.outputs, asked.format);
}

void write(RankLink& link, const RanksDetection& asked, const DistributedIntersections& found, io::Blocks triangles,
           const Statistics& statistics) {
    const auto text = [&](io::PairFormat format) { return text_of(link, found, asked.answer.contacts, format); };
    const auto all = [&] {
        Intersections collected = collect(link, found, triangles);
        collected.statistics = statistics;
        return collected;
    };
    write_list(link, asked.outputs, asked.format, text, all,
               [](auto& to, const Intersections& collected, io::PairFormat format) {
                   io::write_pairs(to, collected, format);
               });
}

int detect(RankLink& link, const RanksDetection& asked) {
    const std::string& file = asked.files[0];
    link.agree([&] {
        if (link.is_first()) check_outputs(asked.outputs, asked.files, asked.answer);
    });
    const auto threads = allowed_threads(asked.options);
    const Steps steps(asked.progress);
    steps.begin("read");
    const RankInput input = read_on_ranks(link, file, asked.answer);
    IntersectionQuery query = query_of(asked.answer);
    query.weld = query.weld || input.weld;
    DistributedOptions options;
    options.detector = asked.options;
    mpi::Detector detector(MPI_COMM_WORLD, options);
    tell_phases(detector, steps);
    const auto report = [&](bool any) { return report_on_ranks(link, any, "something collides", "nothing collides"); };
    if (asked.check && asked.outputs.empty() && !asked.stats)
        return report(about_input(file, [&] { return detector.any(input.share(), query); }));
    const DistributedIntersections& found =
        about_input(file, [&]() -> const DistributedIntersections& { return detector.find(input.share(), query); });
    const std::int64_t hits = count_hits(link, found, input.triangles);
    const RankTotals totals =
        total(link, found.statistics, input.triangles.rows, found.count, detector.options().detector.threads);
    if (asked.stats) print_statistics(link, totals, fmt::format("{} triangles collide", grouped(hits)));
    if (asked.check && asked.outputs.empty()) return report(found.count > 0);
    steps.begin("write");
    write(link, asked, found, input.triangles, totals.statistics.search);
    if (!asked.stats && (found.count == 0 || !std::all_of(asked.outputs.begin(), asked.outputs.end(), is_standard)))
        say(summary_of_pairs(found.count, hits, input.triangles.rows, "triangles", totals.statistics.milliseconds));
    return asked.check && found.count > 0 ? collided : done;
}

}  // namespace

int detect_on_ranks(const RanksDetection& asked) {
    check_is_shared(asked);
    asked.answer.check();
    check_cost_options(asked.options);
    return run_on_ranks([&](RankLink& link) { return detect(link, asked); });
}

}  // namespace crumple::cli
