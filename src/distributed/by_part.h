#pragma once

// Offsets of rows that are exchanged between ranks, ordered by rank, then by part.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace crumple::distribute {

class ByPart {
   public:
    void add(std::int64_t rows) { first_.push_back(first_.back() + rows); }
    std::int64_t rows() const { return first_.back(); }

    /// Splits rows [begin, begin + n) by part: calls visit(number of the add() call, first row of that part, first of
    /// the n rows, count) for each piece.
    template <class Visit>
    void visit(std::int64_t begin, std::size_t n, Visit visit) const {
        std::int64_t at = begin;
        const std::int64_t end = begin + static_cast<std::int64_t>(n);
        auto part = static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), at) - first_.begin()) - 1;
        for (; at < end; ++part) {
            const std::int64_t some = std::min(end, first_[part + 1]) - at;
            if (some > 0)
                visit(part, at - first_[part], static_cast<std::size_t>(at - begin), static_cast<std::size_t>(some));
            at += some;
        }
    }

   private:
    std::vector<std::int64_t> first_{0};
};

}  // namespace crumple::distribute
