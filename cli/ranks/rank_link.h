#pragma once

// Communication between the ranks (MPI processes) of the command line: over a communicator of its own, with the
// transport classes that the search uses.

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "distributed/mpi/mpi_transport.h"
#include "distributed/transport/collective_check.h"
#include "distributed/transport/exchange_lists.h"
#include "distributed/transport/message_batches.h"

namespace crumple::cli {

/// All calls are collective, except rank(), ranks(), is_first() and rounds().
class RankLink {
   public:
    RankLink();
    RankLink(const RankLink&) = delete;
    RankLink& operator=(const RankLink&) = delete;

    int rank() const { return transport_.rank(); }
    int ranks() const { return transport_.size(); }
    bool is_first() const { return rank() == 0; }
    distribute::MessageBatches& rounds() { return rounds_; }

    /// Collective error check: runs work() on each rank. If it throws on any rank, throws the same Error on all ranks.
    /// Use it for all work that may fail on one rank only, because the other ranks would wait for that rank forever.
    template <class Work>
    void run_checked(Work work) {
        agreement_(Phase::input, std::move(work));
    }

    std::int64_t least(std::int64_t number) { return reduced(number, distribute::Reduction::min); }
    std::int64_t largest(std::int64_t number) { return reduced(number, distribute::Reduction::max); }
    std::int64_t sum(std::int64_t number) { return reduced(number, distribute::Reduction::sum); }
    void reduce(std::vector<std::int64_t>& numbers, distribute::Reduction how) { transport_.reduce(numbers, how); }
    /// Returns the `text` of rank 0 on all ranks.
    std::string text_of_first(std::string text);

    /// Sends row i, which is `width` values, to rank rank_of(i). Returns the received rows in the order of the ranks
    /// that sent them; rows from one rank stay in their order.
    template <class Values, class RankOf>
    auto redistribute(const Values& values, RankOf rank_of, std::size_t width = 1) {
        using Value = std::decay_t<decltype(values[std::size_t{0}])>;
        std::vector<std::vector<Value>> leaving;
        run_checked([&] {
            leaving.resize(static_cast<std::size_t>(ranks()));
            for (std::size_t i = 0; i < values.size(); i += width) {
                std::vector<Value>& to = leaving[static_cast<std::size_t>(rank_of(i / width))];
                to.insert(to.end(), values.data() + i, values.data() + i + width);
            }
        });
        const distribute::Traffic traffic =
            distribute::traffic_of(rounds_, [&](std::size_t rank) { return leaving[rank].size(); });
        std::vector<Value> coming;
        run_checked([&] { coming.resize(distribute::all(traffic.in)); });
        distribute::exchange_lists(
            rounds_, traffic, [&](std::size_t rank) -> auto& { return leaving[rank]; }, coming);
        return coming;
    }
    /// Returns the values of all ranks, rank by rank, on rank 0, and none on the other ranks.
    template <class Values>
    auto gather(const Values& values) {
        return redistribute(values, [](std::size_t) { return 0; });
    }

   private:
    std::int64_t reduced(std::int64_t number, distribute::Reduction how) {
        transport_.reduce({&number, 1}, how);
        return number;
    }

    distribute::MpiTransport transport_;
    distribute::MessageBatches rounds_;
    distribute::CollectiveCheck agreement_;
};

}  // namespace crumple::cli
