#pragma once

// Crumple asked about motion and nearness: all impacts of a step, all near pairs at its start.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "crumple/detector.h"
#include "race.h"
#include "step.h"

namespace crumple::benchmark {

enum class FeatureQuestion : std::uint8_t { motion, nearness };
inline constexpr std::array feature_questions{FeatureQuestion::motion, FeatureQuestion::nearness};
constexpr std::string_view name_of(FeatureQuestion question) {
    return question == FeatureQuestion::motion ? "motion" : "nearness";
}

/// Answers the question; what the call did.
const Statistics& ask(Detector& detector, const Step& step, FeatureQuestion question);

/// A detector of its own, kept warm, that answers at each call; `step` must outlive it.
Contestant asks(const Options& options, const Step& step, FeatureQuestion question, std::string name);

/// Most bytes that a new detector owns, and bytes of its answer.
struct FeatureMemory {
    std::int64_t peak = 0, answer = 0;
};
FeatureMemory memory_of(const Step& step, FeatureQuestion question);

/// How the studies of features ask: the first two are there on every machine.
struct FeatureWay {
    std::string name;
    Options options;
};
std::vector<FeatureWay> feature_ways();

}  // namespace crumple::benchmark
