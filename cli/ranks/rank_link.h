#pragma once

// How the ranks of the command line talk: over a communicator of their own, by the transport that the search uses.

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "distributed/mpi/mpi_transport.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/rounds.h"

namespace crumple::cli {

/// For what only one rank knows of: it tells, and all end.
[[noreturn]] void abort_all_ranks(const char* message, int status);

class RankLink {
   public:
    RankLink();
    RankLink(const RankLink&) = delete;
    RankLink& operator=(const RankLink&) = delete;

    int rank() const { return transport_.rank(); }
    int ranks() const { return transport_.size(); }
    bool is_first() const { return rank() == 0; }
    MPI_Comm communicator() const { return communicator_.get(); }
    distribute::Rounds& rounds() { return rounds_; }
    distribute::Transport& transport() { return transport_; }

    /// Runs work() on each rank, and returns where it has returned on all; otherwise throws the same Error on all. What
    /// a rank does by itself, and may fail to do, is done so: else the others would wait for it.
    template <class Work>
    void agree(Work work) {
        try {
            agreement_(Phase::input, std::move(work));
        } catch (const Error& error) {
            throw as_of_one_process(error);
        }
    }
    std::int64_t least(std::int64_t number) { return reduced(number, distribute::Reduction::min); }
    std::int64_t largest(std::int64_t number) { return reduced(number, distribute::Reduction::max); }
    std::int64_t sum(std::int64_t number) { return reduced(number, distribute::Reduction::sum); }
    /// The error of all ranks, without the rank where that does not matter.
    static Error as_of_one_process(const Error& error);
    /// The text that rank 0 has.
    std::string text_of_first(std::string text);

   private:
    struct Communicator {
        Communicator();
        MPI_Comm get() const { return own; }
        MPI_Comm own = MPI_COMM_NULL;
    };
    std::int64_t reduced(std::int64_t number, distribute::Reduction how) {
        transport_.reduce({&number, 1}, how);
        return number;
    }

    Communicator communicator_;
    distribute::MpiTransport transport_;
    distribute::Rounds rounds_;
    distribute::Agreement agreement_;
};

}  // namespace crumple::cli
