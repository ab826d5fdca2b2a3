#pragma once

// Races of contestants, timed so that ratios of their times stay meaningful on a machine whose speed drifts and that
// other programs use, too.
//
// After a warm-up the contestants alternate: in each round, each contestant calls its function until its slice of time
// is spent, at least once. The order is reversed after each round. A contestant's time is the median over all its
// calls. The ratio of two contestants is computed for each round from their medians within that round; median and
// quartiles of a ratio are taken over the rounds.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "crumple/intersections.h"

namespace crumple::benchmark {

/// One way to compute a result. Of contestants with the same name and different ways, the fastest one stands for the
/// name.
struct Contestant {
    std::string name;                          ///< program: "crumple", "CGAL", ...
    std::string way;                           ///< method: "1 thread", "AABB trees, float32", ...
    std::string computes;                      ///< "exact pairs", "overlapping boxes", ...
    std::function<void()> call;                ///< the timed call
    std::function<std::vector<Pair>()> pairs;  ///< result of the last call, in any order; null if it has no pairs
};

/// Statistics of times in milliseconds, or of ratios.
struct Summary {
    double median = 0, lower_quartile = 0, upper_quartile = 0, minimum = 0, percentile_99 = 0;
    std::int64_t calls = 0;
};
Summary summarise(std::vector<double> values);

struct Times {
    std::vector<std::vector<double>>
        rounds;          ///< milliseconds, [round][call]; empty if the contestant's warm-up was too slow (race())
    double warm_up = 0;  ///< milliseconds of the fastest call of the warm-up

    bool raced() const { return !rounds.empty(); }
    Summary summary() const;
};

/// Returns the processor time per wall-clock time of this process when it uses all processors, measured for a twentieth
/// of a second: the number of processors that it gets. If that is less than their number, other load uses the others,
/// and multi-threaded times are pessimistic.
double processors_at_hand();
/// Describes the result of processors_at_hand() in words, with a warning if it is below 90 % of all processors.
std::string describe_processors(double at_hand);

/// Returns statistics of the ratio of `theirs` to `ours` over the rounds. In each round, it is the ratio of the
/// medians.
Summary ratio(const Times& theirs, const Times& ours);

struct Effort {
    int rounds = 15;
    double slice = 0.03;  ///< seconds of one contestant in one round
    double budget =
        40;  ///< seconds of a whole race without the warm-up; the number of rounds is reduced to fit, to at least three
};

/// Calls a contestant until `seconds` are spent, at least once, and returns the milliseconds of each call.
std::vector<double> time_slice(const Contestant& contestant, double seconds);

/// Returns the times of each contestant. A contestant whose warm-up takes over 1.5 times as long as that of the fastest
/// one of the same name does not take part in the rounds, because it cannot be the fastest.
std::vector<Times> race(std::span<const Contestant> contestants, const Effort& effort);

}  // namespace crumple::benchmark
