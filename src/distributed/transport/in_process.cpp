#include "distributed/transport/in_process.h"

#include <algorithm>
#include <cstring>

#include "crumple/error.h"

namespace crumple::distribute {

void Hub::notify_change() {
    ++changes_;
    changes_.notify_all();
}

void Hub::leave() {
    const std::lock_guard lock(mutex_);
    left_ = true;
    notify_change();
}

template <class Ready>
void Hub::wait(std::unique_lock<std::mutex>& lock, Ready ready) {
    while (!ready()) {
        if (left_) throw Error(ErrorCode::communication, "another rank has ended");
        const int seen = changes_;
        lock.unlock();
        changes_.wait(seen);
        lock.lock();
    }
}

void Hub::meet() {
    std::unique_lock lock(mutex_);
    const std::uint64_t meeting = meetings_;
    if (++here_ == size_) {
        here_ = 0;
        ++meetings_;
        notify_change();
        return;
    }
    wait(lock, [&] { return meetings_ != meeting; });
}

template <class Read>
void InProcess::show(const void* mine, Read read) {
    hub_->slot_[static_cast<std::size_t>(rank_)] = mine;
    hub_->meet();
    read();
    hub_->meet();
}

void InProcess::reduce(std::span<std::int64_t> numbers, Reduction how) {
    std::vector<std::int64_t> result(numbers.begin(), numbers.end());
    show(numbers.data(), [&] {
        for (int r = 0; r < size(); ++r) {
            if (r == rank_) continue;
            const auto* other = shown_by<std::int64_t>(r);
            for (std::size_t i = 0; i < result.size(); ++i)
                result[i] = how == Reduction::min   ? std::min(result[i], other[i])
                            : how == Reduction::max ? std::max(result[i], other[i])
                                                    : result[i] + other[i];
        }
    });
    std::copy(result.begin(), result.end(), numbers.begin());
}

void InProcess::broadcast(std::span<std::byte> bytes, int root) {
    show(bytes.data(), [&] {
        if (rank_ != root && !bytes.empty()) std::memcpy(bytes.data(), shown_by<std::byte>(root), bytes.size());
    });
}

void InProcess::all_to_all(std::span<const std::int64_t> to, std::span<std::int64_t> from) {
    show(to.data(), [&] {
        for (int r = 0; r < size(); ++r)
            from[static_cast<std::size_t>(r)] = shown_by<std::int64_t>(r)[static_cast<std::size_t>(rank_)];
    });
}

// A message stays in its sender's memory until it is received, so a rank waits until all that it has sent are received.
void InProcess::exchange(std::span<const Outgoing> out, std::span<const Incoming> in) {
    std::unique_lock lock(hub_->mutex_);
    for (const Outgoing& message : out)
        if (!message.bytes.empty()) hub_->mailbox(rank_, message.rank).bytes = message.bytes.data();
    hub_->notify_change();
    for (const Incoming& message : in) {
        if (message.bytes.empty()) continue;
        Hub::Mailbox& mailbox = hub_->mailbox(message.rank, rank_);
        hub_->wait(lock, [&] { return mailbox.bytes != nullptr; });
        lock.unlock();
        std::memcpy(message.bytes.data(), mailbox.bytes, message.bytes.size());
        lock.lock();
        mailbox.bytes = nullptr;
        hub_->notify_change();
    }
    for (const Outgoing& message : out)
        if (!message.bytes.empty())
            hub_->wait(lock, [&] { return hub_->mailbox(rank_, message.rank).bytes == nullptr; });
}

}  // namespace crumple::distribute
