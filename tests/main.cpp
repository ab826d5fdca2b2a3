// Runs an executable's tests as GoogleTest's main does, with three options more, which tests/CMakeLists.txt gives:
//   --without=CASES=REASON   leaves cases out, as --gtest_filter=-CASES does, and says why
//   --only=CASES=REASON      runs these alone
//   --expect=CASES           only asks whether there are such cases
// Each fails if a pattern of CASES fits no case: one was renamed, and another build would run it, or not.

#include <fnmatch.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#ifdef CRUMPLE_TESTS_WITH_TBB
#include <tbb/global_control.h>
#endif

namespace {

std::vector<std::string> names_of_cases() {
    std::vector<std::string> names;
    const testing::UnitTest& all = *testing::UnitTest::GetInstance();
    for (int i = 0; i < all.total_test_suite_count(); ++i) {
        const testing::TestSuite& suite = *all.GetTestSuite(i);
        for (int k = 0; k < suite.total_test_count(); ++k)
            names.push_back(std::string(suite.name()) + '.' + suite.GetTestInfo(k)->name());
    }
    return names;
}

/// Asks whether each pattern fits a case; colons stand between patterns.
bool fit(const std::string& cases) {
    static const std::vector<std::string> names = names_of_cases();
    std::istringstream patterns(cases);
    for (std::string pattern; std::getline(patterns, pattern, ':');) {
        const auto fits = [&](const std::string& name) { return fnmatch(pattern.c_str(), name.c_str(), 0) == 0; };
        if (std::any_of(names.begin(), names.end(), fits)) continue;
        std::cerr << "error: no case is called " << pattern << ", as its CMakeLists.txt says\n";
        return false;
    }
    return true;
}

}  // namespace

int main(int argc, char** argv) {
#ifdef CRUMPLE_TESTS_WITH_TBB
    // Detectors use no more threads than are allowed in the process; tests ask for up to 16, on any machine.
    const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 16);
#endif
    testing::InitGoogleTest(&argc, argv);
    std::string& filter = testing::GTEST_FLAG(filter);
    for (int i = 1; i < argc; ++i) {
        const std::string_view option = argv[i];
        const std::size_t equals = option.find('=');
        if (equals == option.npos) continue;
        const std::string_view value = option.substr(equals + 1);
        const std::string cases(value.substr(0, value.find('=')));
        if (!fit(cases)) return 2;
        const std::string_view name = option.substr(0, equals);
        if (name == "--only")
            filter = cases;
        else if (name == "--without")
            filter += (filter.find('-') == filter.npos ? "-" : ":") + cases;
        else
            continue;
        std::cout << name.substr(2) << ' ' << cases << ": " << value.substr(std::min(value.size(), cases.size() + 1))
                  << '\n';
    }
    return RUN_ALL_TESTS();
}
