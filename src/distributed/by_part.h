#pragma once

// Offsets of groups of rows in a list of rows that ranks exchange. A group has the rows of one part from or for one
// rank; groups are ordered by rank, then by part.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace crumple::distribute {

class ByPart {
   public:
    /// Appends a group of rows.
    void add(std::int64_t rows) { first_.push_back(first_.back() + rows); }
    std::int64_t rows() const { return first_.back(); }

    /// Splits rows [begin, begin + n) of the list into pieces of one group each. Calls visit(group, first, row, count)
    /// for each piece: `group` is the index of the group, `first` the piece's first row within the group, and `row` its
    /// first row counted from `begin`.
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
