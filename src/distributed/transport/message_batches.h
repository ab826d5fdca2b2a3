#pragma once

// Exchanges lists of any length between ranks, in message batches of bounded size, which bounds the buffers at both
// ends. Rows are packed right before their batch is sent and unpacked when it has arrived, so the whole list need not
// exist on either side.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "distributed/transport/transport.h"

namespace crumple::distribute {

/// Number of rows sent to, and received from, each rank.
struct Traffic {
    explicit Traffic(int ranks) : out(static_cast<std::size_t>(ranks), 0), in(out) {}
    std::vector<std::int64_t> out, in;
};

class MessageBatches {
   public:
    /// `bytes`: size of a message batch of one rank, in each direction.
    MessageBatches(Transport& transport, std::int64_t bytes) : transport_(transport), bytes_(bytes) {}

    /// Exchanges rows. pack(rank, first, span of n rows) writes the rows [first, first + n) for a rank; unpack(rank,
    /// first, rows) reads those received from it. A rank's rows for itself are packed and unpacked, but not sent.
    /// Collective.
    template <class Row, class Pack, class Unpack>
    void exchange(const Traffic& traffic, Pack pack, Unpack unpack) {
        const auto self = static_cast<std::size_t>(transport_.rank());
        swap_out<Row>(static_cast<int>(self), traffic.out[self], pack, unpack);
        const std::int64_t most = rows_at_once(sizeof(Row));
        std::int64_t batches = 0;
        for (std::size_t r = 0; r < traffic.out.size(); ++r)
            if (r != self) batches = std::max(batches, (std::max(traffic.out[r], traffic.in[r]) + most - 1) / most);
        const auto others = [&](const std::vector<std::int64_t>& rows, std::int64_t first, auto visit) {
            for (std::size_t r = 0; r < rows.size(); ++r)
                if (const std::int64_t n = std::min(rows[r] - first, most); r != self && n > 0)
                    visit(static_cast<int>(r), static_cast<std::size_t>(n));
        };
        for (std::int64_t round = 0; round < batches; ++round) {
            const std::int64_t first = round * most;
            std::size_t leaving = 0, coming = 0;
            others(traffic.out, first, [&](int, std::size_t n) { leaving += n; });
            others(traffic.in, first, [&](int, std::size_t n) { coming += n; });
            Row *to = rows_in<Row>(leaving_, leaving), *from = rows_in<Row>(coming_, coming);
            out_.clear(), in_.clear();
            others(traffic.out, first, [&](int rank, std::size_t n) {
                const std::span<Row> rows(to, n);
                pack(rank, first, rows);
                send(rank, std::as_bytes(rows));
                to += n;
            });
            others(traffic.in, first, [&](int rank, std::size_t n) {
                in_.push_back({rank, std::as_writable_bytes(std::span(from, n))});
                from += n;
            });
            transport_.exchange(out_, in_);
            for (const Incoming& message : in_)
                unpack(message.rank, first,
                       std::span<const Row>(reinterpret_cast<const Row*>(message.bytes.data()),
                                            message.bytes.size() / sizeof(Row)));
        }
    }

    /// Reserves buffers, so that exchanges do not allocate memory for messages. Pages are committed when they are used.
    void reserve() {
        const auto most = static_cast<std::size_t>(bytes_) + 64 * static_cast<std::size_t>(transport_.size());
        leaving_.reserve(most), coming_.reserve(most);
        out_.reserve(static_cast<std::size_t>(transport_.size())), in_.reserve(out_.capacity());
    }
    std::int64_t bytes() const { return bytes_; }
    std::int64_t bytes_sent() const { return sent_; }
    std::int64_t messages() const { return messages_; }
    void reset_counts() { sent_ = messages_ = 0; }
    Transport& transport() { return transport_; }

   private:
    // Packs and unpacks a rank's rows for itself, through a buffer that fits into the CPU's cache.
    template <class Row, class Pack, class Unpack>
    void swap_out(int self, std::int64_t count, Pack pack, Unpack unpack) {
        constexpr auto at_once =
            static_cast<std::int64_t>(std::max<std::size_t>(1, (std::size_t{1} << 16) / sizeof(Row)));
        std::vector<Row> rows(static_cast<std::size_t>(std::min(count, at_once)));
        for (std::int64_t first = 0; first < count; first += at_once) {
            const std::span<Row> some(rows.data(), static_cast<std::size_t>(std::min(count - first, at_once)));
            pack(self, first, some);
            unpack(self, first, std::span<const Row>(some));
        }
    }

    // Returns the maximum number of rows in a message. Each pair of ranks has an equal share of a batch, so that both
    // ends know the length of a message.
    std::int64_t rows_at_once(std::size_t row_bytes) const {
        const std::int64_t piece = std::min<std::int64_t>(bytes_ / transport_.size(), std::int64_t{1} << 30);
        return std::max<std::int64_t>(1, piece / static_cast<std::int64_t>(row_bytes));
    }
    void send(int rank, std::span<const std::byte> bytes) {
        out_.push_back({rank, bytes});
        sent_ += static_cast<std::int64_t>(bytes.size());
        ++messages_;
    }
    template <class Row>
    static Row* rows_in(std::vector<std::byte>& buffer, std::size_t rows) {
        if (buffer.size() < rows * sizeof(Row)) buffer.resize(rows * sizeof(Row));
        return reinterpret_cast<Row*>(buffer.data());
    }

    Transport& transport_;
    std::int64_t bytes_;
    std::int64_t sent_ = 0, messages_ = 0;
    std::vector<Outgoing> out_;
    std::vector<Incoming> in_;
    std::vector<std::byte> leaving_, coming_;
};

}  // namespace crumple::distribute
