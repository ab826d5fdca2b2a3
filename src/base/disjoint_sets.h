#pragma once

// Disjoint sets of the numbers 0 to n - 1. Each set is represented by its least number.

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace crumple {

class DisjointSets {
   public:
    /// Makes n sets of one number each.
    explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::int32_t{0}); }

    /// Returns the least number of the set of x.
    std::int32_t find(std::int32_t x) {
        while (parent(x) != x) x = parent(x) = parent(parent(x));
        return x;
    }
    void join(std::int32_t x, std::int32_t y) {
        x = find(x), y = find(y);
        parent(x < y ? y : x) = x < y ? x : y;
    }

   private:
    std::int32_t& parent(std::int32_t x) { return parent_[static_cast<std::size_t>(x)]; }

    std::vector<std::int32_t> parent_;
};

}  // namespace crumple
