#pragma once

#include <gtest/gtest.h>

#include <mutex>
#include <string>

namespace crumple::test {

/// Thread-safe list of the failures of ranks, which are threads: these must not use GoogleTest's expectations.
class RankFailures {
   public:
    void add(int rank, const testing::AssertionResult& result) {
        const std::lock_guard lock(mutex_);
        if (!result) text_ += "rank " + std::to_string(rank) + ": " + result.message() + "; ";
    }
    testing::AssertionResult all() const {
        return text_.empty() ? testing::AssertionSuccess() : testing::AssertionFailure() << text_;
    }

   private:
    std::mutex mutex_;
    std::string text_;
};

}  // namespace crumple::test
