#pragma once

// Races of contestants, timed so that their ratios stay meaningful on a machine whose speed drifts and that others use,
// too.
//
// After a warm-up the contestants alternate: in each round every one calls its function until its slice of time is
// spent, at least once, and every other round goes backwards. A contestant's time is the median over all its calls. A
// ratio is formed round by round from medians within that round, and its spread is the spread over the rounds.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "crumple/intersections.h"

namespace crumple::benchmark {

/// One way to compute a result. Ways of the same name compete: the fastest one stands for the name.
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
        rounds;          ///< milliseconds of each call in each round; empty: the warm-up was too slow
    double warm_up = 0;  ///< fastest call of the warm-up, milliseconds

    bool raced() const { return !rounds.empty(); }
    Summary summary() const;
};

/// Returns how many processors' worth of time this process gets when it uses all of them, measured for a twentieth of a
/// second. If that is fewer than there are, other load takes the rest, and multi-threaded times are pessimistic.
double processors_at_hand();
/// Describes that number in words, with a warning if it is below 90 % of all processors.
std::string describe_processors(double at_hand);

/// Returns the ratio of `theirs` to `ours`, formed round by round.
Summary ratio(const Times& theirs, const Times& ours);

struct Effort {
    int rounds = 15;
    double slice = 0.03;  ///< seconds of one contestant in one round
    double budget =
        40;  ///< seconds of a whole race, warm-up excluded: fewer rounds if they are long, but at least three
};

/// Calls a contestant until `seconds` are spent, at least once, and returns the milliseconds of each call.
std::vector<double> time_slice(const Contestant& contestant, double seconds);

/// Returns the times of each contestant. Ways that in the warm-up are over 1.5 times slower than the fastest one of the
/// same name do not take part in the rounds: they cannot win.
std::vector<Times> race(std::span<const Contestant> contestants, const Effort& effort);

}  // namespace crumple::benchmark
