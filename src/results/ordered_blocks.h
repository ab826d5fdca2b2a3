#pragma once

// Blocks of a result, filled in the order of the units of work that produce its rows, whichever unit finishes first.
//
//     unit 0   finished
//     unit 1   piece, piece, ...   <-- current: its pieces go into the block at once
//     unit 2   piece, piece        queued until it is current; while too many rows are queued, its worker waits
//     unit 3   not begun
//
// A unit is a leaf, or a tile of a large one (backends/cpu/order.h). Units are begun in ascending order, so the current
// unit has a worker that does not wait: there is no deadlock. Pieces depend on their unit alone, so blocks do not
// depend on threads.

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
    /// Operations on blocks. All but `make` and `size` are called by one thread at a time, but not always the same.
    struct Work {
        std::function<std::unique_ptr<Block>()> make;  ///< returns an empty block
        std::function<std::size_t(const Block&)> size;
        /// Appends rows [begin, end) of a piece.
        std::function<void(Block& to, Block& piece, std::size_t begin, std::size_t end)> append;
        std::function<void(Block&)> take;  ///< consumes a full block, or the last; if it throws, delivery ends
        std::function<void(Block&)> clear;
    };

    /// `most`: rows per block, and limit of the rows that are queued for later units.
    OrderedBlocks(std::int64_t most, Cancellation& cancellation, Work work)
        : most_(static_cast<std::size_t>(most)),
          cancellation_(cancellation),
          work_(std::move(work)),
          filling_(work_.make()) {}

    /// Returns an empty piece.
    std::unique_ptr<Block> make() const { return work_.make(); }

    /// Consumes a piece of an unfinished unit; called by the worker of that unit only. Waits while too many rows are
    /// queued.
    void add(std::int64_t unit, std::unique_ptr<Block> piece) {
        const std::size_t rows = work_.size(*piece);
        if (rows == 0) return;
        std::unique_lock lock(mutex_);
        unit += first_;
        wait(lock, [&] { return unit == current_unit_ ? !busy_ : queued_rows_ + rows <= most_; });
        if (failed_) return;
        if (unit == current_unit_) return deliver(lock, *piece);
        units_[unit].pieces.push_back(std::move(piece));
        queued_rows_ += rows;
    }

    /// Ends a unit: it has no further pieces.
    void finish(std::int64_t unit) {
        std::unique_lock lock(mutex_);
        unit += first_;
        units_[unit].finished = true;
        wait(lock,
             [&] { return unit != current_unit_ || !busy_; });  // until no thread delivers queued pieces of this unit
        if (unit != current_unit_) return;                      // another thread finishes this unit when it is current
        while (!failed_ && units_.contains(current_unit_)) {
            Unit& current_unit = units_[current_unit_];
            for (auto& piece : std::exchange(current_unit.pieces, {})) {
                queued_rows_ -= work_.size(*piece);
                deliver(lock, *piece);
                if (failed_) return;
            }
            if (!current_unit.finished) break;
            units_.erase(current_unit_++);
        }
        changed_.notify_all();
    }

    /// Ends delivery after an error: no thread waits any longer, and nothing is delivered.
    void fail() {
        const std::lock_guard lock(mutex_);
        failed_ = true;
        changed_.notify_all();
    }

    /// Begins the next scene, whose units are numbered from 0 again. All units of the previous scene must be finished.
    void next_scene() { first_ = current_unit_; }

    /// Delivers the last block, unless it is empty.
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

    // Waits until ready() returns true or fail() was called, and checks regularly for cancellation.
    template <class Ready>
    void wait(std::unique_lock<std::mutex>& lock, Ready ready) {
        while (!failed_ && !ready()) {
            changed_.wait_for(lock, std::chrono::milliseconds(20));
            lock.unlock();
            cancellation_.check();
            lock.lock();
        }
    }

    // Delivers a piece without the lock, so that other threads can queue pieces meanwhile.
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
    std::condition_variable changed_;  ///< signals that current_unit_, busy_, failed_ or queued_rows_ changed
    std::map<std::int64_t, Unit> units_;
    // Numbers of units, counted over all scenes: that of unit 0 of the current scene, and that of the current unit.
    std::int64_t first_ = 0, current_unit_ = 0;
    std::size_t queued_rows_ = 0;  ///< number of queued rows: those of units that are not current yet
    bool busy_ = false;            ///< true while a thread is in deliver()
    bool failed_ = false;
    std::unique_ptr<Block> filling_;
};

}  // namespace crumple
