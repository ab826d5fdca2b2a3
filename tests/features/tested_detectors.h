#pragma once

// Detectors on the tested backend with various options, each of which must agree with brute force.

#include <memory>
#include <vector>

#include "features/compare_features.h"
#include "features/moving_soups.h"
#include "rounds.h"
#include "tested_backend.h"

namespace crumple::test {

/// Returns soups to try, see moving_soups(). `part` scales their sizes, and under sanitizers `if_sanitized` as well,
/// since brute force takes quadratic time. On an emulated device the soups are fewer and smaller.
template <class Scalar>
std::vector<NamedMove<Scalar>> soups_to_try(double part, double if_sanitized) {
    std::vector<NamedMove<Scalar>> all = moving_soups<Scalar>((played ? 0.2 : sanitized ? if_sanitized : 1) * part);
    std::size_t i = 0;
    if (played) std::erase_if(all, [&](const auto&) { return i++ % (sanitized ? 21 : 7) != 0; });
    return all;
}

/// Names of the instances of typed tests, whose type parameter is the scalar type: "float32" or "float64".
class PrecisionNames {
   public:
    template <class Scalar>
    static std::string GetName(int) {
        return sizeof(Scalar) == 4 ? "float32" : "float64";
    }
};

/// One of the detectors that must all agree. Detectors are reused from soup to soup and from query to query.
struct TestedDetector {
    std::string name;
    std::unique_ptr<Detector> detector;
};

inline const std::vector<TestedDetector>& tested() {
    static const std::vector<TestedDetector> all = [] {
        std::vector<TestedDetector> list;
        const auto add = [&](const std::string& name, Options options) {
            options.backend = tested_backend;
            try {
                list.push_back({name, std::make_unique<Detector>(options)});
            } catch (const Error& error) {
                EXPECT_EQ(error.code, ErrorCode::backend_unavailable);
            }
        };
        add("one thread", {.threads = 1});
        add("small leaves", {.threads = 2, .leaf_size = 8});
        add("seven clusters", {.threads = 5, .clusters = 7, .leaf_size = 8});
        if (played) return list;
        add("one cluster", {.threads = 2, .clusters = 1, .leaf_size = 8});
        add("many clusters", {.threads = 1, .clusters = 64, .leaf_size = 1});
        for (const Simd simd : {Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon})
            add("instruction set " + std::to_string(static_cast<int>(simd)), {.threads = 1, .simd = simd});
        return list;
    }();
    return all;
}
/// Returns three of the tested detectors, others for each call, as most of the time goes into exact decisions, which
/// all detectors share; or all of them if thorough() is true. The first is always the one of small leaves.
inline std::vector<const TestedDetector*> detectors_in_turn() {
    const std::vector<TestedDetector>& all = tested();
    std::vector<const TestedDetector*> list{&all[1]};
    static std::size_t next = 0;
    while (list.size() < (thorough() ? all.size() : played ? 2 : 3)) {
        if (next % all.size() != 1) list.push_back(&all[next % all.size()]);
        ++next;
    }
    return list;
}
inline Detector& reference() {
    static Detector detector({.backend = Backend::reference});
    return detector;
}

template <class Scalar>
void expect_impacts(const MovingSoup<Scalar>& soup, const ImpactQuery& given,
                    const std::vector<const TestedDetector*>& by = detectors_in_turn()) {
    ImpactQuery query = given;
    query.index = true;
    const Impacts& expected = reference().find(soup.view().moving_to(soup.end_view()), query);
    const FirstImpact first = first_listed(expected);
    EXPECT_EQ(expected.any, first.found);
    EXPECT_TRUE(same_first(expected.first, first)) << "listed with all";
    for (const TestedDetector* const tested_by : by) {
        SCOPED_TRACE(tested_by->name);
        Detector* const detector = tested_by->detector.get();
        const Impacts& found = detector->find(soup.view().moving_to(soup.end_view()), query);
        ASSERT_TRUE(same_features(found, expected));
        if (tested_by != &tested()[1]) continue;  // other detectors would take as long and add nothing
        EXPECT_TRUE(same_first(detector->find(soup.view().moving_to(soup.end_view()), FirstImpactQuery{query}), first));
        EXPECT_EQ(!detector->any(soup.view().moving_to(soup.end_view()), query), !first.found);
    }
}

template <class Scalar>
void expect_near(const MovingSoup<Scalar>& soup, const ProximityQuery& given) {
    ProximityQuery query = given;
    query.index = true;
    const Proximities& expected = reference().find(soup.view(), query);
    ProximityQuery any = query;
    any.output = Output::any;
    for (const TestedDetector* const by : detectors_in_turn()) {
        SCOPED_TRACE(by->name);
        ASSERT_TRUE(same_features(by->detector->find(soup.view(), query), expected));
        EXPECT_EQ(by->detector->find(soup.view(), any).any, expected.count > 0);
    }
}

}  // namespace crumple::test
