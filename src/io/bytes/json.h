#pragma once

// What the JSON of pairs, of impacts and of near pairs has in common. Long arrays are written directly: a document
// would take some 100 bytes a number.

#include <cstddef>
#include <string>
#include <utility>

#include "crumple/intersections.h"
#include "io/bytes/sink.h"

namespace crumple::io {

/// What is no UTF-8 is replaced, for files may have any name.
std::string valid_utf8(const std::string& text);

/// An object, indented.
std::string json_of(const Statistics& statistics);

/// [item, item, ...], an item a line.
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
