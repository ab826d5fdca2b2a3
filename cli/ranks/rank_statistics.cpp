#include "cli/ranks/rank_statistics.h"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/terminal.h"

namespace crumple::cli {
namespace {

constexpr double per_millisecond = 1e6;

void table_row(std::string_view name, const std::string& value, const std::string& remark = {}) {
    say("{:<15}{:>15}{}{}\n", name, value, remark.empty() ? "" : "  ", remark);
}

/// Times as integers, which ranks add and compare in any order.
void reduce_times(RankLink& link, std::span<double> milliseconds, distribute::Reduction how) {
    std::vector<std::int64_t> times(milliseconds.size());
    std::transform(milliseconds.begin(), milliseconds.end(), times.begin(),
                   [](double t) { return static_cast<std::int64_t>(per_millisecond * t); });
    link.transport().reduce(times, how);
    std::transform(times.begin(), times.end(), milliseconds.begin(),
                   [](std::int64_t t) { return static_cast<double>(t) / per_millisecond; });
}

}  // namespace

RankTotals total(RankLink& link, const DistributedStatistics& mine, std::int64_t triangles, std::int64_t pairs,
                 int threads) {
    RankTotals totals{mine, static_cast<int>(link.sum(threads))};
    DistributedStatistics& all = totals.statistics;
    Statistics& search = all.search;
    reduce_times(link, {&all.milliseconds, 1}, distribute::Reduction::max);
    reduce_times(link, all.phase_milliseconds, distribute::Reduction::max);
    reduce_times(link, search.stage_milliseconds, distribute::Reduction::sum);
    all.parts = static_cast<int>(link.sum(all.parts));
    for (const auto count :
         {&DistributedStatistics::members, &DistributedStatistics::bytes_sent, &DistributedStatistics::messages})
        all.*count = link.sum(all.*count);
    for (const auto count :
         {&Statistics::clusters, &Statistics::leaves, &Statistics::members, &Statistics::interval_tests,
          &Statistics::box_overlaps, &Statistics::edge_tests, &Statistics::double_tests, &Statistics::exact_tests,
          &Statistics::rational_tests, &Statistics::rational_contacts})
        search.*count = link.sum(search.*count);
    search.peak_memory_bytes = link.largest(search.peak_memory_bytes);
    search.milliseconds = all.milliseconds;
    search.triangles = triangles;
    search.pairs = pairs;
    search.threads = totals.threads;
    return totals;
}

void print_statistics(const RankLink& link, const RankTotals& totals, const std::string& remark) {
    const DistributedStatistics& s = totals.statistics;
    const double sum = std::accumulate(s.phase_milliseconds.begin(), s.phase_milliseconds.end(), 0.0);
    say(on_terminal(2, fmt::emphasis::bold), "{:<15}{:>12}{:>9}\n", "phase", "time", "share");
    for (int i = 0; i < phase_count; ++i) {
        const auto phase = static_cast<Phase>(i);
        say("{:<15}{:>9.2f} ms{:>7.0f} %\n", phase_name(phase), s[phase], sum > 0 ? 100 * s[phase] / sum : 0);
    }
    say(on_terminal(2, fmt::emphasis::bold), "{:<15}{:>9.2f} ms", "wall clock", s.milliseconds);
    say("  {} ranks, {} threads\n\n", link.ranks(), totals.threads);
    const auto triangles = static_cast<double>(std::max<std::int64_t>(1, s.search.triangles));
    table_row("triangles", grouped(s.search.triangles));
    table_row("parts", grouped(s.parts));
    table_row("members", grouped(s.members),
              fmt::format("{:.2f} a triangle", static_cast<double>(s.members) / triangles));
    table_row("balance", fmt::format("{:.2f}", s.mean_work > 0 ? s.largest_work / s.mean_work : 1),
              fmt::format("largest over mean work, {:.2f} and {:.2f} ms", s.largest_work, s.mean_work));
    table_row("bytes sent", grouped(s.bytes_sent), fmt::format("in {} messages", grouped(s.messages)));
    table_row("exact tests", grouped(s.search.exact_tests),
              fmt::format("{} in rational numbers", grouped(s.search.rational_tests)));
    table_row("pairs", grouped(s.search.pairs), remark);
}

}  // namespace crumple::cli
