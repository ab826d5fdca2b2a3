#pragma once

// Ranks: MPI processes that a launcher has started, which search together. A process runs alone if no launcher has
// started it, if the environment variable CRUMPLE_MPI is 0, or if the program was built without CRUMPLE_MPI
// (ranks_none.cpp).

#include <string>

namespace crumple::cli {

/// Initialises MPI in its constructor, finalises it in its destructor, and suppresses the output of all ranks but rank
/// 0. Create one at the beginning of the program.
class Ranks {
   public:
    Ranks(int& argument_count, char**& arguments);
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;
    ~Ranks();

    static int count();
};

/// Throws Error (invalid_argument): "WHAT is not supported on several ranks: run it in one process".
[[noreturn]] void refuse_on_ranks(const std::string& what);

}  // namespace crumple::cli
