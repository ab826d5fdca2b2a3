// Colliding pairs as one JSON object: {"pairs": [[a, b], ...], "contacts": [{"kind": ..., "points": [[x, y, z], ...]},
// ...], "statistics": {...}}.

#include "io/bytes/json.h"
#include "io/bytes/sink.h"
#include "io/formats.h"
#include "io/lists/pairs.h"

namespace crumple::io {

void write_pairs_json(std::ostream& out, const Intersections& collisions) {
    Sink sink(out);
    sink << "{\n\"pairs\": ";
    write_json_array(sink, collisions.pairs.size(), [&](std::size_t i) {
        sink << '[' << collisions.pairs[i].a << ',' << collisions.pairs[i].b << ']';
    });
    if (has_contacts(collisions)) {
        sink << ",\n\"contacts\": ";
        write_json_array(sink, collisions.pairs.size(), [&](std::size_t i) {
            sink << R"({"kind":")" << name_of(collisions.contacts.kinds[i]) << R"(","points":[)";
            bool first = true;
            for (const auto& [x, y, z] : points_of_pair(collisions, i)) {
                sink << (first ? "[" : ",[") << x << ',' << y << ',' << z << ']';
                first = false;
            }
            sink << "]}";
        });
    }
    sink << ",\n\"statistics\": " << json_of(collisions.statistics) << "\n}\n";
}

}  // namespace crumple::io
