// Runs an executable's tests like GoogleTest's main, with three more options, which tests/CMakeLists.txt passes:
//   --without=CASES=REASON   excludes cases, as --gtest_filter=-CASES does, and prints the reason
//   --only=CASES=REASON      runs these cases only
//   --expect=CASES           only checks that such cases exist
// Each option fails if a pattern of CASES matches no case: a case was renamed, and some build would run or skip the
// wrong ones.

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

/// True if each of the patterns, which colons separate, matches a case. Prints the first that matches none.
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
    // Detectors use no more threads than are allowed in the process; tests request up to 16, on any machine.
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
