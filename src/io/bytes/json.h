#pragma once

// Parts that all JSON output shares. Long arrays are written directly: a JSON document in memory would take some 100
// bytes per number.

#include <cstddef>
#include <string>
#include <utility>

#include "crumple/intersections.h"
#include "io/bytes/sink.h"

namespace crumple::io {

/// Returns the text with invalid UTF-8 replaced, since file names may hold any bytes.
std::string valid_utf8(const std::string& text);

/// Returns an indented JSON object.
std::string json_of(const Statistics& statistics);

/// Writes [item, item, ...], one item per line; write(i) writes item i.
template <class Write>
void write_json_array(Sink& sink, std::size_t size, Write&& write) {
    sink << '[';
    for (std::size_t i = 0; i < size; ++i) {
        sink << (i ? ",\n" : "\n");
        write(i);
    }
    sink << (size ? "\n]" : "]");
}

}  // namespace crumple::io
