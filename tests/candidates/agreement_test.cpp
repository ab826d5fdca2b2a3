// Compares candidates of small hard soups, for each of the tested detectors, with brute force in rational numbers.

#include <gtest/gtest.h>

#include <set>

#include "candidates/compare_candidates.h"
#include "features/listed_soups.h"
#include "features/tested_detectors.h"
#include "rounds.h"

namespace crumple::test {
namespace {

/// Compares candidates of the step, and of the start positions alone.
template <class Scalar>
void expect_candidates(const MovingSoup<Scalar>& soup, const CandidateQuery& query) {
    const auto expect = [&](bool step) {
        const auto find = [&](Detector& detector) -> const Candidates& {
            return step ? detector.find(soup.view().moving_to(soup.end_view()), query)
                        : detector.find(soup.view(), query);
        };
        const Candidates& expected = find(reference());
        for (const TestedDetector* const by : detectors_in_turn()) {
            SCOPED_TRACE(by->name);
            ASSERT_TRUE(same_candidates(find(*by->detector), expected));
        }
    };
    expect(true);
    expect(false);
}

/// Compares candidates of all kinds, and of the default kinds, which are those of impacts; with the cpu backend also
/// those of all kinds with neighbours.
template <class Scalar>
void expect_candidates(const MovingSoup<Scalar>& soup, double inflation, bool weld = false) {
    expect_candidates(soup, {.kinds = all_candidate_kinds(), .inflation = inflation, .weld = weld});
    if (!testing::Test::HasFailure()) expect_candidates(soup, {.inflation = inflation, .weld = weld});
    if (testing::Test::HasFailure() || tested_backend == Backend::cuda) return;
    expect_candidates(soup, {.kinds = all_candidate_kinds(), .inflation = inflation, .weld = weld, .neighbours = true});
}

template <class Scalar>
class CandidateAgreement : public testing::Test {
   protected:
    void expect_all(double inflation, bool weld = false) {
        SCOPED_TRACE(testing::Message() << "inflation " << inflation);
        // At large inflations most features overlap, so soups with a quarter of the triangles suffice.
        for (const NamedMove<Scalar>& move : soups_to_try<Scalar>(inflation > 0.1 ? 0.25 : 1, 0.5)) {
            if (inflation * move.unit > std::numeric_limits<double>::max()) continue;
            SCOPED_TRACE(move.name);
            expect_candidates(move.soup, inflation * move.unit, weld);
            if (this->HasFailure()) return;
        }
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(CandidateAgreement, Precisions, PrecisionNames);

TYPED_TEST(CandidateAgreement, uninflated_boxes_match_brute_force) { this->expect_all(0); }
TYPED_TEST(CandidateAgreement, welded_soups_match_brute_force) { this->expect_all(0, true); }
TYPED_TEST(CandidateAgreement, inflated_boxes_match_brute_force) {
    for (const double inflation : {1e-3, 0.5, 1.0, 7.0}) this->expect_all(inflation);
}
TYPED_TEST(CandidateAgreement, inflation_beyond_the_scene_matches_brute_force) { this->expect_all(1e9); }

TYPED_TEST(CandidateAgreement, codimensional_edges_and_points_match_brute_force) {
    unsigned seed = 0;
    for (const NamedMove<TypeParam>& move : soups_to_try<TypeParam>(0.5, 1))
        for (int i = 0; i < 4; ++i, ++seed) {
            SCOPED_TRACE(testing::Message() << move.name << ", lists " << seed);
            expect_candidates(with_lists(move.soup, seed), 0, i == 3);
            if (this->HasFailure()) return;
        }
}

/// Inflations far below an ulp of the coordinates, and far beyond the soup's extent.
TYPED_TEST(CandidateAgreement, extreme_inflations_match_brute_force) {
    const auto soup = rounded<TypeParam>(moving_grid(3, 16, 12, 5));
    for (const double inflation :
         {0x1p-1074, 1e-300, 1e-20, 0x1p-53, 0x1p-24, 1e300, std::numeric_limits<double>::max()})
        expect_candidates(soup, inflation);
}

TEST(CandidateKinds, only_requested_kinds_are_listed) {
    const MovingSoup<> soup = moving_grid(4, 30, 24, 3);
    Detector detector({.backend = tested_backend, .threads = 2, .leaf_size = 8});
    const Candidates all =
        detector.find(soup.view().moving_to(soup.end_view()), CandidateQuery{.kinds = all_candidate_kinds()});
    for (unsigned chosen = 1; chosen < 64; ++chosen) {
        CandidateQuery query{.kinds = {}};
        for (const CandidateKind kind : all_candidate_kinds())
            if (chosen >> static_cast<unsigned>(kind) & 1) query.kinds.push_back(kind);
        const Candidates& some = detector.find(soup.view().moving_to(soup.end_view()), query);
        for (const CandidateKind kind : all_candidate_kinds()) {
            const bool requested = chosen >> static_cast<unsigned>(kind) & 1;
            EXPECT_EQ(some.listed[static_cast<std::size_t>(kind)], requested);
            EXPECT_GT(all[kind].pairs.size(), 0U);
            EXPECT_TRUE(
                same_pairs(some[kind].pairs.span(), requested ? all[kind].pairs.span() : std::span<const Pair>()));
        }
    }
}

TEST(CandidateGroups, group_filters_match_brute_force) {
    MovingSoup<> soup = in_general(80, 0.5, 0.3, 4);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
        soup.groups.push_back(static_cast<std::int32_t>(t % 5));
        if (t > 0) soup.triangles[t][0] = soup.triangles[t - 1][1];
    }
    CandidateQuery query{.kinds = all_candidate_kinds(), .inflation = 0.01};
    query.filter.excluded_groups = {{0, 1}, {2, 2}};
    for (const PairScope scope : {PairScope::between, PairScope::within}) {
        query.filter.groups = scope;
        expect_candidates(soup, query);
    }
}

/// Features that touch during the step have swept boxes that overlap.
TEST(CandidatesAndImpacts, every_impact_is_a_candidate) {
    std::size_t compared = 0;
    for (const NamedMove<double>& move : soups_to_try<double>(1, 1)) {
        SCOPED_TRACE(move.name);
        Detector& detector = *tested()[1].detector;
        const Impacts& impacts = detector.find(move.soup.view().moving_to(move.soup.end_view()), ImpactQuery());
        const Candidates& candidates =
            detector.find(move.soup.view().moving_to(move.soup.end_view()), CandidateQuery());
        for (const auto& [kind, of] : {std::pair(FeatureKind::vertex_face, CandidateKind::vertex_face),
                                       std::pair(FeatureKind::edge_edge, CandidateKind::edge_edge)}) {
            const auto& pairs = candidates[of].pairs;
            compared += impacts[kind].pairs.size();
            for (const Pair& pair : impacts[kind].pairs)
                EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), pair)) << testing::PrintToString(pair);
        }
    }
    EXPECT_TRUE(sanitized || compared > 0) << "sanitizers leave out most soups";
}

}  // namespace
}  // namespace crumple::test
