#pragma once

// Transport between ranks that are threads of one process: for several devices, and for tests with any number of
// simulated machines.

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "distributed/transport/transport.h"

namespace crumple::distribute {

/// Shared state of all ranks: barrier, data exposed at barriers, and messages.
class Hub {
   public:
    explicit Hub(int size)
        : size_(size), slot_(static_cast<std::size_t>(size)), mailboxes_(slot_.size() * slot_.size()) {}
    int size() const { return size_; }

    /// Ends the calls of the other ranks because one rank has failed: they throw Error (communication) instead of
    /// waiting.
    void leave();

   private:
    friend class InProcess;
    struct Mailbox {
        const std::byte* bytes = nullptr;  ///< message not yet received; null: none
    };

    /// Barrier: returns when all ranks have called it.
    void meet();
    /// Wakes all waiting ranks. The caller must have locked mutex_.
    void notify_change();
    template <class Ready>
    void wait(std::unique_lock<std::mutex>& lock, Ready ready);
    Mailbox& mailbox(int from, int to) {
        return mailboxes_[static_cast<std::size_t>(from) * slot_.size() + static_cast<std::size_t>(to)];
    }

    int size_;
    std::mutex mutex_;
    /// Counter that ranks wait on. Not a condition variable, whose wait() requires a newer libstdc++ than everything
    /// else.
    std::atomic<int> changes_ = 0;
    int here_ = 0;
    std::uint64_t meetings_ = 0;
    bool left_ = false;
    std::vector<const void*> slot_;   ///< data that each rank exposes at a barrier
    std::vector<Mailbox> mailboxes_;  ///< by sender, then by receiver
};

/// Transport of one rank.
class InProcess final : public Transport {
   public:
    InProcess(std::shared_ptr<Hub> hub, int rank) : hub_(std::move(hub)), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return hub_->size(); }
    void reduce(std::span<std::int64_t> numbers, Reduction how) override;
    void broadcast(std::span<std::byte> bytes, int root) override;
    void all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) override;
    void exchange(std::span<const Outgoing> out, std::span<const Incoming> in) override;

   private:
    template <class T>
    const T* shown_by(int rank) const {
        return static_cast<const T*>(hub_->slot_[static_cast<std::size_t>(rank)]);
    }
    /// Exposes `mine` to the other ranks, and calls read() while all ranks expose theirs.
    template <class Read>
    void show(const void* mine, Read read);

    std::shared_ptr<Hub> hub_;
    int rank_;
};

}  // namespace crumple::distribute
