#pragma once

// A block of an answer that is filled from any thread, and handed over when it is full, while others fill the next.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace crumple {

template <class Block>
class FillingBlock {
   public:
    /// What is done with a block. Each may be called from any thread.
    struct Work {
        std::function<std::unique_ptr<Block>()> make;  ///< an empty one
        std::function<void(Block&)> complete;          ///< a full one; several at the same time
        std::function<void(Block&)> take;              ///< one at a time; what it throws ends all
        std::function<void(Block&)> clear;
    };

    /// `most`: elements of a block.
    FillingBlock(std::int64_t most, Work work)
        : most_(static_cast<std::size_t>(most)), work_(std::move(work)), filling_(work_.make()) {}

    /// Holds the block for one thread, which may add to it many times.
    class Writer {
       public:
        explicit Writer(FillingBlock& to) : to_(to), lock_(to.mutex_) {}

        /// write(block, begin, end) appends these of `count` elements; called for as many blocks as it takes.
        template <class Write>
        void add(std::size_t count, Write write) {
            for (std::size_t begin = 0; begin < count;) {
                const std::size_t end = begin + std::min(count - begin, to_.most_ - to_.filled_);
                write(*to_.filling_, begin, end);
                to_.filled_ += end - begin;
                if (to_.filled_ == to_.most_) to_.hand_over(lock_);
                begin = end;
            }
        }

       private:
        FillingBlock& to_;
        std::unique_lock<std::mutex> lock_;
    };

    /// Hands the last block over, if there is anything in it.
    void finish() {
        std::unique_lock lock(mutex_);
        if (filled_ > 0) hand_over(lock);
    }

   private:
    std::unique_ptr<Block> fresh() {
        if (spare_.empty()) return work_.make();
        auto block = std::move(spare_.back());
        spare_.pop_back();
        return block;
    }
    void hand_over(std::unique_lock<std::mutex>& lock) {
        auto full = std::exchange(filling_, fresh());
        filled_ = 0;
        lock.unlock();
        if (work_.complete) work_.complete(*full);
        {
            const std::lock_guard turn(turn_);
            if (ended_) return lock.lock();
            ended_ = true;
            work_.take(*full);
            ended_ = false;
        }
        work_.clear(*full);
        lock.lock();
        spare_.push_back(std::move(full));
    }

    const std::size_t most_;
    const Work work_;
    std::mutex mutex_;  ///< of the block that is filled, and the spare ones
    std::mutex turn_;   ///< of take()
    bool ended_ = false;
    std::vector<std::unique_ptr<Block>> spare_;
    std::unique_ptr<Block> filling_;
    std::size_t filled_ = 0;
};

}  // namespace crumple
