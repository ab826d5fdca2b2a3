// Colliding pairs as one JSON object: {"pairs": [[a, b], ...], "contacts": [{"kind": ..., "points": [[x, y, z], ...]},
// ...], "statistics": {...}}. The long arrays are written directly: a document would take some 100 bytes a number.

#include <cmath>

#include <nlohmann/json.hpp>

#include "io/formats.h"
#include "io/pairs.h"
#include "io/sink.h"

namespace crumple::io {

namespace {

/// Clocks tell no more than microseconds.
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
        {"threads", statistics.threads},
        {"backend", statistics.backend},
        {"simd", statistics.simd},
    };
}

/// [item, item, ...], an item a line.
template <class Write>
void write_array(Sink& sink, std::size_t size, Write&& write) {
    sink << '[';
    for (std::size_t i = 0; i < size; ++i) {
        sink << (i ? ",\n" : "\n");
        write(i);
    }
    sink << (size ? "\n]" : "]");
}

}  // namespace

void write_pairs_json(std::ostream& out, const Collisions& collisions) {
    Sink sink(out);
    sink << "{\n\"pairs\": ";
    write_array(sink, collisions.pairs.size(),
                [&](std::size_t i) { sink << '[' << collisions.pairs[i].a << ',' << collisions.pairs[i].b << ']'; });
    if (has_contacts(collisions)) {
        sink << ",\n\"contacts\": ";
        write_array(sink, collisions.pairs.size(), [&](std::size_t i) {
            sink << R"({"kind":")" << name_of(collisions.contacts.kinds[i]) << R"(","points":[)";
            bool first = true;
            for (const auto& [x, y, z] : points_of_pair(collisions, i)) {
                sink << (first ? "[" : ",[") << x << ',' << y << ',' << z << ']';
                first = false;
            }
            sink << "]}";
        });
    }
    sink << ",\n\"statistics\": " << document(collisions.statistics).dump(2) << "\n}\n";
}

}  // namespace crumple::io
