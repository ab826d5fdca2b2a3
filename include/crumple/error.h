#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "crumple/export.h"

namespace crumple {

/// Kind of failure.
enum class ErrorCode : std::uint8_t {
    invalid_argument,    ///< a shape, an option or a combination of them is invalid
    not_finite,          ///< a vertex has a NaN or an infinite coordinate
    index_out_of_range,  ///< a triangle, an edge or a point names a vertex that does not exist
    memory_limit,  ///< the search, or its result, does not fit in Options::memory_limit, or memory is exhausted; see
                   ///< Error::bytes_needed
    backend_unavailable,  ///< the requested backend was not built or has no device
    file,                 ///< a file cannot be opened, read or written
    format,               ///< the content of a file violates its format
    cancelled,            ///< a std::stop_token ended the call
    device,               ///< a call of CUDA failed; the message names it
    communication,        ///< a call of MPI failed, or another rank has ended
};

/// Kind of element that Error::index counts.
enum class Element : std::uint8_t { none, vertex, triangle, group, option, line, byte, body, shape, edge, point };

/// Exception for every failure of the library. The message is a sentence that names the place, e.g. "vertex 17 is not
/// finite" or "triangle 4 names vertex 90 of 80". The detector that threw stays usable.
class CRUMPLE_API Error : public std::runtime_error {
   public:
    /// Sets the members of the same names; `message` is what() returns. `rank` stays -1.
    explicit Error(ErrorCode code, const std::string& message, Element element = Element::none, std::int64_t index = -1,
                   std::int64_t bytes_needed = 0, int system_error = 0)
        : std::runtime_error(message),
          code(code),
          element(element),
          index(index),
          bytes_needed(bytes_needed),
          system_error(system_error) {}

    ErrorCode code;
    Element element;            ///< kind of element that `index` counts
    std::int64_t index;         ///< the first offending element, -1 if there is none
    std::int64_t bytes_needed;  ///< memory_limit: lower bound on a sufficient limit; otherwise 0
    int system_error;           ///< file: errno, if the operating system failed; otherwise 0
    int rank = -1;              ///< rank that failed, if there are several (crumple/distributed.h); otherwise -1
};

}  // namespace crumple
