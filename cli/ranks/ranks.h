#pragma once

// MPI processes that a launcher has started, which search together. A build without CRUMPLE_MPI (ranks_none.cpp), or a
// process that no launcher has started, runs alone.

#include <string>

namespace crumple::cli {

/// Initialises MPI at the beginning of the program, and finalises it at the end. All ranks but rank 0 print nothing.
class Ranks {
   public:
    Ranks(int& argument_count, char**& arguments);
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    ~Ranks();

    static int count();
};

/// Throws Error (invalid_argument): "WHAT is not shared among ranks".
[[noreturn]] void refuse_on_ranks(const std::string& what);

}  // namespace crumple::cli
