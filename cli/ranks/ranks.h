#pragma once

// The processes of MPI that a launcher has started: they search together. A build without CRUMPLE_MPI (ranks_none.cpp),
// and a process that no launcher has started, is alone.

#include <string>

namespace crumple::cli {

/// Joins the others, from the beginning of the program to its end. All but rank 0 are silent.
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
