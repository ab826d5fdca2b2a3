#pragma once

// Results of brute force that all parameters of a test share.

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <string>

namespace crumple::test {

/// Results of brute force for a test that searches the same scenes for each of its parameters, such as numbers of
/// threads. The first run of the test computes the results, and later runs reuse them in the same order. A member of
/// the test's fixture.
template <class Result>
class SharedResults {
   public:
    /// Returns the next result, from compute() if no run of the test has needed it before.
    template <class Compute>
    const Result& next(Compute compute) {
        if (used_ == results_.size()) results_.push_back(compute());
        return results_[used_++];
    }

   private:
    static std::deque<Result>& results_of_current_test() {
        static std::map<std::string, std::deque<Result>> results;
        const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
        const std::string name = std::string(test.test_suite_name()) + '.' + test.name();
        return results[name.substr(0, name.rfind('/'))];  // without the parameter
    }

    std::deque<Result>& results_ = results_of_current_test();
    std::size_t used_ = 0;
};

}  // namespace crumple::test
