#pragma once

// Ranges of ids one behind the other, each as long as its share of an answer fits a block.

#include <algorithm>
#include <cstdint>

namespace crumple::cpu {

/// Ids [begin, end).
struct IdRange {
    std::int64_t begin = 0, end = 0;
    std::int64_t size() const { return end - begin; }
    bool has(std::int64_t id) const { return id >= begin && id < end; }
};

/// Cuts ids into ranges. answer(range) is the number of pairs, or more than `most` if they were too many; one(id)
/// answers an id that has too many by itself.
template <class Answer, class One>
void for_each_range(IdRange ids, std::int64_t most, Answer answer, One one) {
    std::int64_t length = ids.size();
    while (ids.begin < ids.end) {
        const IdRange range{ids.begin, std::min(ids.end, ids.begin + length)};
        const std::int64_t pairs = answer(range);
        if (pairs > most) {
            length = range.size() / 2;
            if (length > 0) continue;
            one(range.begin);
            length = 1;
        } else {
            // Three quarters full, if the next ids are like these.
            const std::int64_t longest = 16 * range.size();
            const double share =
                0.75 * static_cast<double>(most) / static_cast<double>(std::max<std::int64_t>(pairs, 1));
            const double next = share * static_cast<double>(range.size());
            length = next < static_cast<double>(longest) ? std::max<std::int64_t>(1, static_cast<std::int64_t>(next))
                                                         : longest;
        }
        ids.begin = range.end;
    }
}

}  // namespace crumple::cpu
