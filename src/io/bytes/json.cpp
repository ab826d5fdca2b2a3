#include "io/bytes/json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace crumple::io {

namespace {

/// Rounds to whole microseconds, so that files do not list digits without meaning.
double rounded(double milliseconds) { return std::round(milliseconds * 1000) / 1000; }

nlohmann::ordered_json document(const Statistics& statistics) {
    nlohmann::ordered_json stages;
    for (int i = 0; i < stage_count; ++i) {
        const auto stage = static_cast<Stage>(i);
        stages[std::string(stage_name(stage))] = rounded(statistics[stage]);
    }
    return {
        {"milliseconds", rounded(statistics.milliseconds)},
        {"stage_milliseconds", stages},
        {"triangles", statistics.triangles},
        {"clusters", statistics.clusters},
        {"leaves", statistics.leaves},
        {"members", statistics.members},
        {"interval_tests", statistics.interval_tests},
        {"box_overlaps", statistics.box_overlaps},
        {"edge_tests", statistics.edge_tests},
        {"double_tests", statistics.double_tests},
        {"exact_tests", statistics.exact_tests},
        {"rational_tests", statistics.rational_tests},
        {"rational_contacts", statistics.rational_contacts},
        {"pairs", statistics.pairs},
        {"peak_memory_bytes", statistics.peak_memory_bytes},
        {"complete", statistics.complete},
        {"threads", statistics.threads},
        {"backend", statistics.backend},
        {"simd", statistics.simd},
    };
}

}  // namespace

std::string valid_utf8(const std::string& text) {
    using nlohmann::json;
    return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
}

std::string json_of(const Statistics& statistics) { return document(statistics).dump(2); }

}  // namespace crumple::io
