#include "race.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <thread>

namespace crumple::benchmark {
namespace {

constexpr double hopeless = 1.5;  // largest ratio of a warm-up time to that of the fastest way of the same name
constexpr int least_rounds = 3;

double milliseconds(const std::function<void()>& call) {
    const auto begin = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

/// Returns the quantile `share` (0.5: the median) of sorted values, by linear interpolation between neighbouring
/// values.
double quantile(const std::vector<double>& sorted, double share) {
    const double place = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return sorted[below] + (place - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return quantile(values, 0.5);
}

}  // namespace

std::vector<double> time_slice(const Contestant& contestant, double seconds) {
    std::vector<double> times;
    for (double spent = 0; times.empty() || spent < 1000 * seconds; spent += times.back())
        times.push_back(milliseconds(contestant.call));
    return times;
}

double processors_at_hand() {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const std::clock_t spent = std::clock();
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i)
        threads.emplace_back([=] {
            while (Clock::now() - begin < std::chrono::milliseconds(50)) {
            }
        });
    for (std::thread& thread : threads) thread.join();
    const double seconds = static_cast<double>(std::clock() - spent) / CLOCKS_PER_SEC;
    return seconds / std::chrono::duration<double>(Clock::now() - begin).count();
}

std::string describe_processors(double at_hand) {
    const unsigned all = std::thread::hardware_concurrency();
    const bool busy = at_hand < 0.9 * all;
    return fmt::format("{:.1f} of {} processors at hand{}", at_hand, all, busy ? ": BUSY, figures are rough" : "");
}

Summary summarise(std::vector<double> values) {
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    return {quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75),
            values.front(),        quantile(values, 0.99), static_cast<std::int64_t>(values.size())};
}

Summary Times::summary() const {
    if (!raced()) return {warm_up, warm_up, warm_up, warm_up, warm_up, 0};
    std::vector<double> all;
    for (const auto& round : rounds) all.insert(all.end(), round.begin(), round.end());
    return summarise(std::move(all));
}

Summary ratio(const Times& theirs, const Times& ours) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < std::min(theirs.rounds.size(), ours.rounds.size()); ++r)
        ratios.push_back(median(theirs.rounds[r]) / median(ours.rounds[r]));
    return summarise(std::move(ratios));
}

std::vector<Times> race(std::span<const Contestant> contestants, const Effort& effort) {
    std::vector<Times> times(contestants.size());
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        times[i].warm_up = std::ranges::min(time_slice(contestants[i], 2 * effort.slice));
    }

    std::vector<std::size_t> turns;
    double round_seconds = 0;
    for (std::size_t i = 0; i < contestants.size(); ++i) {
        double fastest = times[i].warm_up;
        for (std::size_t j = 0; j < contestants.size(); ++j)
            if (contestants[j].name == contestants[i].name) fastest = std::min(fastest, times[j].warm_up);
        if (times[i].warm_up > hopeless * fastest) continue;
        turns.push_back(i);
        round_seconds += std::max(effort.slice, times[i].warm_up / 1000);
    }

    const int affordable = static_cast<int>(effort.budget / round_seconds);
    const int rounds = std::min(effort.rounds, std::max(least_rounds, affordable));
    for (int r = 0; r < rounds; ++r) {
        for (const std::size_t i : turns) times[i].rounds.push_back(time_slice(contestants[i], effort.slice));
        std::reverse(turns.begin(), turns.end());
    }
    return times;
}

}  // namespace crumple::benchmark
