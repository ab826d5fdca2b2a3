#pragma once

// Detectors on the cpu that work in many ways, and shall agree with brute force in every one.

#include <memory>

#include "questions/features/compare_features.h"
#include "questions/features/moving_soups.h"

namespace crumple::test {

/// Detectors that shall all agree; they go from soup to soup, and from question to question.
struct Tested {
    std::string name;
    std::unique_ptr<Detector> detector;
};

inline const std::vector<Tested>& tested() {
    static const std::vector<Tested> all = [] {
        std::vector<Tested> list;
        const auto add = [&](const std::string& name, Options options) {
            options.backend = Backend::cpu;
            try {
                list.push_back({name, std::make_unique<Detector>(options)});
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
            }
        };
        add("one thread", {.threads = 1});
        add("small leaves", {.threads = 2, .leaf_size = 8});
        add("seven clusters", {.threads = 5, .clusters = 7, .leaf_size = 8});
        add("one cluster", {.threads = 2, .clusters = 1, .leaf_size = 8});
        add("many clusters", {.threads = 1, .clusters = 64, .leaf_size = 1});
        for (const Simd simd : {Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon})
            add("instruction set " + std::to_string(static_cast<int>(simd)), {.threads = 1, .simd = simd});
        return list;
    }();
    return all;
}
inline Detector& reference() {
    static Detector detector({.backend = Backend::reference});
    return detector;
}

template <class Scalar>
void expect_impacts(const MovingSoup<Scalar>& soup, const Motion& asked, std::span<const Tested> by = tested()) {
    Motion question = asked;
    question.index = true;
    const Impacts& expected = reference().find_impacts(soup.view(), soup.end_view(), question);
    const FirstImpact first = first_listed(expected);
    EXPECT_EQ(expected.any, first.found);
    EXPECT_TRUE(same_first(expected.first, first)) << "listed with all";
    for (const auto& [name, detector] : by) {
        SCOPED_TRACE(name);
        const Impacts& found = detector->find_impacts(soup.view(), soup.end_view(), question);
        ASSERT_TRUE(same_features(found, expected));
        if (&detector != &tested()[1].detector) continue;  // others are as slow, and no different
        EXPECT_TRUE(same_first(detector->time_of_first_impact(soup.view(), soup.end_view(), question), first));
        EXPECT_EQ(detector->is_free(soup.view(), soup.end_view(), question), !first.found);
    }
}

template <class Scalar>
void expect_near(const MovingSoup<Scalar>& soup, const Near& asked) {
    Near question = asked;
    question.index = true;
    const Nearby& expected = reference().find_near(soup.view(), question);
    Near any = question;
    any.wants = NearWants::any;
    for (const auto& [name, detector] : tested()) {
        SCOPED_TRACE(name);
        ASSERT_TRUE(same_features(detector->find_near(soup.view(), question), expected));
        EXPECT_EQ(detector->find_near(soup.view(), any).any, expected.count > 0);
    }
}

}  // namespace crumple::test
