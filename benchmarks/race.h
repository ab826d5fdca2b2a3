#pragma once

// Times contestants against each other, so that their ratio survives a machine whose speed drifts and that others use
// too.
//
// After a warm-up the contestants take turns: in each round every one calls its function until its slice of time is
// spent, at least once, and every other round goes backwards. A contestant's time is the median over all its calls. A
// ratio is formed round by round from medians within that round, and its spread is the spread over the rounds.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "crumple/intersections.h"

namespace crumple::benchmark {

/// One way to answer a question. Ways of the same name compete: the fastest one stands for the name.
struct Contestant {
    std::string name;                          ///< who: "crumple", "CGAL", ...
    std::string way;                           ///< how: "1 thread", "AABB trees, float32", ...
    std::string computes;                      ///< "exact pairs", "overlapping boxes", ...
    std::function<void()> call;                ///< what is timed
    std::function<std::vector<Pair>()> pairs;  ///< the last call's answer, in any order; null if it has none
};

/// Milliseconds.
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

/// How many processors' worth of time this process gets when it asks for all of them, measured for a twentieth of a
/// second. Fewer than there are: other load takes the rest, and multi-threaded times are pessimistic.
double processors_at_hand();
/// The same in words, a warning if there are fewer.
std::string describe_processors(double at_hand);

/// How many times `ours` fits into `theirs`, round by round.
Summary ratio(const Times& theirs, const Times& ours);

struct Effort {
    int rounds = 15;
    double slice = 0.03;  ///< seconds of one contestant in one round
    double budget =
        40;  ///< seconds of a whole race, warm-up excluded: fewer rounds if they are long, but at least three
};

/// Calls a contestant until `seconds` are spent, at least once; milliseconds of each call.
std::vector<double> time_slice(const Contestant& contestant, double seconds);

/// Times of each contestant. Of those with the same name, ways that are over 1.5 times slower than the fastest one in
/// the warm-up do not take part in the rounds: they cannot win.
std::vector<Times> race(std::span<const Contestant> contestants, const Effort& effort);

}  // namespace crumple::benchmark
