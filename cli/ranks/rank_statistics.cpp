#include "cli/ranks/rank_statistics.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "cli/statistics_table.h"
#include "cli/terminal.h"

namespace crumple::cli {
namespace {

/// Reduces times over all ranks, as whole nanoseconds: sums of integers do not depend on the order of the ranks.
void reduce_times(RankLink& link, std::span<double> milliseconds, distribute::Reduction how) {
    constexpr double per_millisecond = 1e6;
    std::vector<std::int64_t> times;
    for (const double t : milliseconds) times.push_back(static_cast<std::int64_t>(per_millisecond * t));
    link.reduce(times, how);
    for (std::size_t i = 0; i < times.size(); ++i) milliseconds[i] = static_cast<double>(times[i]) / per_millisecond;
}

}  // namespace

DistributedStatistics total(RankLink& link, DistributedStatistics mine) {
    Statistics& search = mine.search;
    reduce_times(link, {&mine.milliseconds, 1}, distribute::Reduction::max);
    reduce_times(link, mine.phase_milliseconds, distribute::Reduction::max);
    reduce_times(link, search.stage_milliseconds, distribute::Reduction::sum);
    mine.parts = static_cast<int>(link.sum(mine.parts));
    search.threads = static_cast<int>(link.sum(search.threads));
    for (std::int64_t* const count :
         {&mine.members, &mine.bytes_sent, &mine.messages, &search.clusters, &search.leaves, &search.members,
          &search.interval_tests, &search.box_overlaps, &search.edge_tests, &search.double_tests, &search.exact_tests,
          &search.rational_tests, &search.rational_contacts})
        *count = link.sum(*count);
    search.peak_memory_bytes = link.largest(search.peak_memory_bytes);
    search.milliseconds = mine.milliseconds;
    return mine;
}

void print_statistics(const RankLink& link, const DistributedStatistics& s, const std::string& remark) {
    print_times("phase", s.phase_milliseconds, [](std::size_t i) { return phase_name(static_cast<Phase>(i)); });
    say(on_terminal(2, fmt::emphasis::bold), "{:<15}{:>9.2f} ms", "wall clock", s.milliseconds);
    say("  {} ranks, {} threads\n\n", link.ranks(), s.search.threads);
    const auto triangles = static_cast<double>(std::max<std::int64_t>(1, s.search.triangles));
    print_row("triangles", grouped(s.search.triangles));
    print_row("parts", grouped(s.parts));
    print_row("members", grouped(s.members),
              fmt::format("{:.2f} a triangle", static_cast<double>(s.members) / triangles));
    print_row("balance", fmt::format("{:.2f}", s.mean_work > 0 ? s.largest_work / s.mean_work : 1),
              fmt::format("largest over mean work, {:.2f} and {:.2f} ms", s.largest_work, s.mean_work));
    print_row("bytes sent", grouped(s.bytes_sent), fmt::format("in {} messages", grouped(s.messages)));
    print_row("exact tests", grouped(s.search.exact_tests),
              fmt::format("{} in rational numbers", grouped(s.search.rational_tests)));
    print_row("pairs", grouped(s.search.pairs), remark);
}

}  // namespace crumple::cli
