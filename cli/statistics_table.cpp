#include "cli/statistics_table.h"

#include <algorithm>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "cli/terminal.h"

namespace crumple::cli {
namespace {

void row(std::string_view name, std::int64_t count, const std::string& remark = {}) {
    print_row(name, grouped(count), remark);
}

double ratio(std::int64_t part, std::int64_t whole) {
    return whole ? static_cast<double>(part) / static_cast<double>(whole) : 0;
}

}  // namespace

std::int64_t count_hits(const Intersections& collisions) {
    const auto count = [](const Array<std::uint8_t>& hit) { return std::count(hit.begin(), hit.end(), 1); };
    return count(collisions.hit) + count(collisions.hit_second);
}

std::string summary_of_pairs(std::int64_t pairs, std::int64_t hits, std::int64_t all, const char* what,
                             double milliseconds) {
    if (pairs == 0) return fmt::format("nothing collides: {} {}, {:.1f} ms\n", grouped(all), what, milliseconds);
    return fmt::format("{} pair{}, {} of {} {}, {:.1f} ms\n", grouped(pairs), pairs == 1 ? "" : "s", grouped(hits),
                       grouped(all), what, milliseconds);
}

void print_times(std::string_view title, std::span<const double> milliseconds,
                 std::string_view (*name_of)(std::size_t)) {
    const double sum = std::accumulate(milliseconds.begin(), milliseconds.end(), 0.0);
    say(on_terminal(2, fmt::emphasis::bold), "{:<15}{:>12}{:>9}\n", title, "time", "share");
    for (std::size_t i = 0; i < milliseconds.size(); ++i)
        say("{:<15}{:>9.2f} ms{:>7.0f} %\n", name_of(i), milliseconds[i], sum > 0 ? 100 * milliseconds[i] / sum : 0);
}

void print_row(std::string_view name, const std::string& value, const std::string& remark) {
    say("{:<15}{:>15}{}{}\n", name, value, remark.empty() ? "" : "  ", remark);
}

void print_statistics(const Statistics& s, std::int64_t hits) {
    print_statistics(s, fmt::format("{} triangles collide", grouped(hits)));
}

void print_statistics(const Statistics& s, const std::string& remark) {
    const double sum = std::accumulate(s.stage_milliseconds.begin(), s.stage_milliseconds.end(), 0.0);
    print_times("stage", s.stage_milliseconds, [](std::size_t i) { return stage_name(static_cast<Stage>(i)); });
    say("{:<15}{:>9.2f} ms\n", s.backend == "cuda" ? "on the device" : "all threads", sum);
    say(on_terminal(2, fmt::emphasis::bold), "{:<15}{:>9.2f} ms", "wall clock", s.milliseconds);
    if (s.backend == "cuda") {
        say("  cuda backend\n\n");
    } else {
        say("  {} thread{}, {} backend, {}\n\n", s.threads, s.threads == 1 ? "" : "s", s.backend,
            s.simd.empty() ? "scalar" : s.simd);
    }
    row("triangles", s.triangles);
    row("clusters", s.clusters, fmt::format("{} leaves swept", grouped(s.leaves)));
    row("members", s.members, fmt::format("{:.2f} a triangle", ratio(s.members, s.triangles)));
    row("interval tests", s.interval_tests);
    row("box overlaps", s.box_overlaps, fmt::format("{:.1f} a triangle", ratio(s.box_overlaps, s.triangles)));
    row("edge tests", s.edge_tests);
    row("double tests", s.double_tests);
    row("exact tests", s.exact_tests, fmt::format("{} in rational numbers", grouped(s.rational_tests)));
    row("pairs", s.pairs, s.complete ? remark : remark + "; pairs may be missing");
    if (s.rational_contacts > 0)
        row("contacts", s.pairs, fmt::format("{} in rational numbers", grouped(s.rational_contacts)));
    print_row("peak memory", readable_bytes(s.peak_memory_bytes));
}

void add(Statistics& sum, const Statistics& more) {
    sum.milliseconds += more.milliseconds;
    for (int i = 0; i < stage_count; ++i) sum[static_cast<Stage>(i)] += more[static_cast<Stage>(i)];
    for (const auto count :
         {&Statistics::triangles, &Statistics::clusters, &Statistics::leaves, &Statistics::members,
          &Statistics::interval_tests, &Statistics::box_overlaps, &Statistics::edge_tests, &Statistics::double_tests,
          &Statistics::exact_tests, &Statistics::rational_tests, &Statistics::rational_contacts, &Statistics::pairs}) {
        sum.*count += more.*count;
    }
    sum.peak_memory_bytes = std::max(sum.peak_memory_bytes, more.peak_memory_bytes);
    sum.complete = sum.complete && more.complete;
    sum.threads = more.threads;
    sum.backend = more.backend;
    sum.simd = more.simd;
}

}  // namespace crumple::cli
