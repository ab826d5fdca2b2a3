#pragma once

// Blocks of a result, filled in the order of the units of work that its rows come from, whoever is done first.
//
//     unit 0   finished
//     unit 1   piece, piece, ...   <-- its turn: its pieces go into the block at once
//     unit 2   piece, piece        kept until it is its turn; where too many rows are kept, its worker waits
//     unit 3   not begun
//
// A unit is a leaf, or a tile of a large one (backends/cpu/order.h). Units are begun in ascending order, so that the
// one whose turn it is has a worker that does not wait, and all goes on. Pieces depend on their unit alone, and so
// blocks do not depend on threads.

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/cancellation.h"

namespace crumple {

template <class Block>
class OrderedBlocks {
   public:
    /// Operations on blocks. All but `make` and `size` are called by one thread at a time, whichever.
    struct Work {
        std::function<std::unique_ptr<Block>()> make;  ///< an empty one
        std::function<std::size_t(const Block&)> size;
        /// Appends rows [begin, end) of a piece.
        std::function<void(Block& to, Block& piece, std::size_t begin, std::size_t end)> append;
        std::function<void(Block&)> take;  ///< a full one, and the last; what it throws ends all
        std::function<void(Block&)> clear;
    };

    /// `most`: rows of a block, and rows that are kept for later units.
    OrderedBlocks(std::int64_t most, Cancellation& cancellation, Work work)
        : most_(static_cast<std::size_t>(most)),
          cancellation_(cancellation),
          work_(std::move(work)),
          filling_(work_.make()) {}

    /// An empty piece.
    std::unique_ptr<Block> make() const { return work_.make(); }

    /// Takes a piece of a unit that is not finished, by the one worker of that unit. Waits where too much is kept.
    void add(std::int64_t unit, std::unique_ptr<Block> piece) {
        const std::size_t rows = work_.size(*piece);
        if (rows == 0) return;
        std::unique_lock lock(mutex_);
        unit += first_;
        wait(lock, [&] { return unit == turn_ ? !busy_ : kept_ + rows <= most_; });
        if (failed_) return;
        if (unit == turn_) return deliver(lock, *piece);
        units_[unit].pieces.push_back(std::move(piece));
        kept_ += rows;
    }

    /// The unit has no further piece.
    void finish(std::int64_t unit) {
        std::unique_lock lock(mutex_);
        unit += first_;
        units_[unit].finished = true;
        wait(lock, [&] { return unit != turn_ || !busy_; });  // until nobody delivers what was kept of this unit
        if (unit != turn_) return;                            // or will be finished by whoever does
        while (!failed_ && units_.contains(turn_)) {
            Unit& of_turn = units_[turn_];
            for (auto& piece : std::exchange(of_turn.pieces, {})) {
                kept_ -= work_.size(*piece);
                deliver(lock, *piece);
                if (failed_) return;
            }
            if (!of_turn.finished) break;
            units_.erase(turn_++);
        }
        changed_.notify_all();
    }

    /// After an error: nobody waits any longer, and nothing is delivered.
    void fail() {
        const std::lock_guard lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }

    /// Units of the next scene are counted from 0 again; those of the one before are all finished.
    void next_scene() { first_ = turn_; }

    /// Delivers the last block, if there is anything in it.
    void finish() {
        if (work_.size(*filling_) == 0) return;
        cancellation_.check();
        work_.take(*filling_);
    }

   private:
    struct Unit {
        std::vector<std::unique_ptr<Block>> pieces;
        bool finished = false;
    };

    // Waits until ready() or an error, and checks now and then that the call was not cancelled.
    template <class Ready>
    void wait(std::unique_lock<std::mutex>& lock, Ready ready) {
        while (!failed_ && !ready()) {
            changed_.wait_for(lock, std::chrono::milliseconds(20));
            lock.unlock();
            cancellation_.check();
            lock.lock();
        }
    }

    // Meanwhile others may keep what they have found.
    void deliver(std::unique_lock<std::mutex>& lock, Block& piece) {
        busy_ = true;
        lock.unlock();
        try {
            fill(piece);
        } catch (...) {
            lock.lock();
            busy_ = false;
            failed_ = true;
            changed_.notify_all();
            throw;
        }
        lock.lock();
        busy_ = false;
    }

    void fill(Block& piece) {
        const std::size_t rows = work_.size(piece);
        for (std::size_t begin = 0; begin < rows;) {
            const std::size_t end = begin + std::min(rows - begin, most_ - work_.size(*filling_));
            work_.append(*filling_, piece, begin, end);
            if (work_.size(*filling_) == most_) {
                cancellation_.check();
                work_.take(*filling_);
                work_.clear(*filling_);
            }
            begin = end;
        }
    }

    const std::size_t most_;
    Cancellation& cancellation_;
    const Work work_;
    std::mutex mutex_;
    std::condition_variable changed_;  ///< whose turn it is, or how much is kept
    std::map<std::int64_t, Unit> units_;
    std::int64_t first_ = 0, turn_ = 0;
    std::size_t kept_ = 0;  ///< rows of units whose turn has not come
    bool busy_ = false;     ///< somebody delivers
    bool failed_ = false;
    std::unique_ptr<Block> filling_;
};

}  // namespace crumple
