#pragma once

// Lists that travel between ranks, of any length, in rounds of bounded bytes: what is on its way never takes more than
// that at either end. Rows are packed when their round comes, and unpacked when it has come, so no list need exist as
// such on either side.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "distribute/transport.h"

namespace crumple::distribute {

/// How many rows go to each rank and come from each.
struct Traffic {
    explicit Traffic(int ranks) : out(static_cast<std::size_t>(ranks), 0), in(out) {}
    std::vector<std::int64_t> out, in;
};

class Rounds {
   public:
    /// `bytes`: what one rank may have on its way out, and in, at a time.
    Rounds(Transport& transport, std::int64_t bytes) : transport_(transport), bytes_(bytes) {}

    /// pack(rank, first, span of rows) writes the rows [first, first + n) for a rank; unpack(rank, first, rows) takes
    /// those from it. Rows for the rank itself go the same way.
    template <class Row, class Pack, class Unpack>
    void exchange(const Traffic& traffic, Pack pack, Unpack unpack) {
        exchange_bytes<Row>(traffic, sizeof(Row), pack, unpack);
    }

    std::int64_t bytes_sent() const { return sent_; }
    std::int64_t messages() const { return messages_; }
    void reset_counts() { sent_ = messages_ = 0; }
    Transport& transport() { return transport_; }

   private:
    template <class Row, class Pack, class Unpack>
    void exchange_bytes(const Traffic& traffic, std::size_t row_bytes, Pack pack, Unpack unpack) {
        const std::int64_t most = rows_at_once(row_bytes);
        const auto at_once = [&](std::int64_t rows, std::int64_t first) {
            return std::clamp<std::int64_t>(rows - first, 0, most);
        };
        std::int64_t rounds = 0;
        const std::size_t ranks = traffic.out.size();
        for (std::size_t r = 0; r < ranks; ++r)
            rounds = std::max({rounds, (traffic.out[r] + most - 1) / most, (traffic.in[r] + most - 1) / most});
        const auto self = static_cast<std::size_t>(transport_.rank());
        for (std::int64_t round = 0; round < rounds; ++round) {
            const std::int64_t first = round * most;
            out_.clear(), in_.clear();
            std::size_t leaving = 0, coming = 0;
            for (std::size_t r = 0; r < ranks; ++r) {
                leaving += static_cast<std::size_t>(at_once(traffic.out[r], first)) * row_bytes;
                if (r != self) coming += static_cast<std::size_t>(at_once(traffic.in[r], first)) * row_bytes;
            }
            grow(leaving_, leaving), grow(coming_, coming);
            std::byte *to = leaving_.data(), *from = coming_.data();
            std::span<const Row> mine;
            for (std::size_t r = 0; r < ranks; ++r) {
                const auto n = static_cast<std::size_t>(at_once(traffic.out[r], first));
                const std::span<Row> rows(reinterpret_cast<Row*>(to), n);
                if (n > 0) pack(static_cast<int>(r), first, rows);
                if (r == self)
                    mine = rows;
                else if (n > 0)
                    send(static_cast<int>(r), std::as_bytes(rows));
                to += rows.size_bytes();
            }
            for (std::size_t r = 0; r < ranks; ++r) {
                const auto n = static_cast<std::size_t>(at_once(traffic.in[r], first));
                if (r == self || n == 0) continue;
                in_.push_back({static_cast<int>(r), {from, n * row_bytes}});
                from += n * row_bytes;
            }
            transport_.exchange(out_, in_);
            if (!mine.empty()) unpack(static_cast<int>(self), first, mine);
            for (const Incoming& message : in_)
                unpack(message.rank, first,
                       std::span<const Row>(reinterpret_cast<const Row*>(message.bytes.data()),
                                            message.bytes.size() / row_bytes));
        }
    }

    // Equal shares, so that both ends of a message know how long it is.
    std::int64_t rows_at_once(std::size_t row_bytes) const {
        const std::int64_t share = std::min<std::int64_t>(bytes_ / transport_.size(), std::int64_t{1} << 30);
        return std::max<std::int64_t>(1, share / static_cast<std::int64_t>(row_bytes));
    }
    void send(int rank, std::span<const std::byte> bytes) {
        out_.push_back({rank, bytes});
        sent_ += static_cast<std::int64_t>(bytes.size());
        ++messages_;
    }
    static void grow(std::vector<std::byte>& buffer, std::size_t bytes) {
        if (buffer.size() < bytes) buffer.resize(bytes);
    }

    Transport& transport_;
    std::int64_t bytes_;
    std::int64_t sent_ = 0, messages_ = 0;
    std::vector<Outgoing> out_;
    std::vector<Incoming> in_;
    std::vector<std::byte> leaving_, coming_;
};

}  // namespace crumple::distribute
