#pragma once

// Queries of the feature studies: all impacts of a step (motion), and all near pairs at its start (nearness).

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

enum class FeatureQueryKind : std::uint8_t { motion, nearness };
inline constexpr std::array feature_queries{FeatureQueryKind::motion, FeatureQueryKind::nearness};
constexpr std::string_view name_of(FeatureQueryKind query) {
    return query == FeatureQueryKind::motion ? "motion" : "nearness";
}

/// Runs the query and returns the statistics of the call.
const Statistics& ask(Detector& detector, const Step& step, FeatureQueryKind query);

/// Returns a contestant with a detector of its own, which stays warm and runs the query in each call. `step` must
/// outlive the contestant.
Contestant asks(const Options& options, const Step& step, FeatureQueryKind query, std::string name);

/// Peak memory of a new detector in one call, and memory of its result, in bytes.
struct FeatureMemory {
    std::int64_t peak = 0, answer = 0;
};
FeatureMemory memory_of(const Step& step, FeatureQueryKind query);

/// Options with which the feature studies run their queries. The first two ways exist on every machine.
struct FeatureWay {
    std::string name;
    Options options;
};
std::vector<FeatureWay> feature_ways();

}  // namespace crumple::benchmark
