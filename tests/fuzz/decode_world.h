#pragma once

// Decodes worlds from bytes: a few small shapes, some of them named, their bodies in several worlds, poses of every
// kind, and successive calls with other poses of the same bodies and other queries.

#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/decode.h"

namespace crumple::fuzz {

/// Poses and query of one call.
struct Call {
    std::vector<Pose> poses;  ///< one per body, or empty
    IntersectionQuery query;
};

struct Bodies {
    Options options;
    std::int64_t memory_limit = -1;  ///< limit of a second detector, in bytes; -1: no such detector
    std::vector<Mesh> shapes;
    std::vector<std::uint64_t> names;  ///< names of the shapes; 0: unnamed
    std::vector<Body> bodies;
    std::vector<Call> calls;

    explicit Bodies(Bytes bytes);
};

/// Returns C++ code that can be pasted into a test.
std::string as_code(const Bodies& bodies);

}  // namespace crumple::fuzz
