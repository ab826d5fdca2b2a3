#pragma once

// Communication between the ranks of the command line: over a communicator of their own, by the transport of the
// search.

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "distributed/mpi/mpi_transport.h"
#include "distributed/transport/agreement.h"
#include "distributed/transport/exchange_lists.h"
#include "distributed/transport/rounds.h"

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
    distribute::Rounds& rounds() { return rounds_; }

    /// Collective error check: runs work() on each rank. Returns if it has returned on all, otherwise throws the same
    /// Error on all. Required for work that may fail on one rank, for which the others would wait.
    template <class Work>
    void agree(Work work) {
        agreement_(Phase::input, std::move(work));
    }

    std::int64_t least(std::int64_t number) { return reduced(number, distribute::Reduction::min); }
    std::int64_t largest(std::int64_t number) { return reduced(number, distribute::Reduction::max); }
    std::int64_t sum(std::int64_t number) { return reduced(number, distribute::Reduction::sum); }
    void reduce(std::vector<std::int64_t>& numbers, distribute::Reduction how) { transport_.reduce(numbers, how); }
    /// Returns the text that rank 0 has.
    std::string text_of_first(std::string text);

    /// Sends row i to rank rank_of(i). Returns the received rows, those from rank 0 first, each rank's in their order.
    /// A row is `width` values.
    template <class Values, class RankOf>
    auto redistribute(const Values& values, RankOf rank_of, std::size_t width = 1) {
        using Value = std::decay_t<decltype(values[std::size_t{0}])>;
        std::vector<std::vector<Value>> leaving;
        agree([&] {
            leaving.resize(static_cast<std::size_t>(ranks()));
            for (std::size_t i = 0; i < values.size(); i += width) {
                std::vector<Value>& to = leaving[static_cast<std::size_t>(rank_of(i / width))];
                to.insert(to.end(), values.data() + i, values.data() + i + width);
            }
        });
        const distribute::Traffic traffic =
            distribute::traffic_of(rounds_, [&](std::size_t rank) { return leaving[rank].size(); });
        std::vector<Value> coming;
        agree([&] { coming.resize(distribute::all(traffic.in)); });
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
    distribute::Rounds rounds_;
    distribute::Agreement agreement_;
};

}  // namespace crumple::cli
