#pragma once

// Worlds from bytes: a few small shapes, named and not, bodies of them in several worlds, poses of every kind, and
// calls that follow each other: other poses of the same bodies, and other questions.

#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/decode.h"

namespace crumple::fuzz {

/// What one call is asked.
struct Call {
    std::vector<Pose> poses;  ///< one a body, or empty
    IntersectionQuery question;
};

struct Bodies {
    Options options;
    std::int64_t memory_limit = -1;  ///< of a second detector; -1: none
    std::vector<Mesh> shapes;
    std::vector<std::uint64_t> names;  ///< of shapes; 0: none
    std::vector<Body> bodies;
    std::vector<Call> calls;

    explicit Bodies(Bytes bytes);
};

/// As C++ that a test can take over.
std::string as_code(const Bodies& bodies);

}  // namespace crumple::fuzz
