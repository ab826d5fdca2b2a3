// Candidates of small hard soups: the backend, however it works, against brute force in rational numbers.

#include <gtest/gtest.h>

#include <set>

#include "candidates/compare_candidates.h"
#include "features/agreeing.h"
#include "features/listed_soups.h"
#include "rounds.h"

namespace crumple::test {
namespace {

/// On the way to the end, at rest at the start, and welded.
template <class Scalar>
void expect_candidates(const MovingSoup<Scalar>& soup, const CandidateQuery& question) {
    const auto expect = [&](bool step) {
        const auto find = [&](Detector& detector) -> const Candidates& {
            return step ? detector.find(soup.view().moving_to(soup.end_view()), question)
                        : detector.find(soup.view(), question);
        };
        const Candidates& expected = find(reference());
        for (const auto& [name, detector] : tested()) {
            SCOPED_TRACE(name);
            ASSERT_TRUE(same_candidates(find(*detector), expected));
        }
    };
    expect(true);
    expect(false);
}

/// Of all kinds, and of those that impacts are among.
template <class Scalar>
void expect_candidates(const MovingSoup<Scalar>& soup, double inflation, bool weld = false) {
    expect_candidates(soup, {.kinds = all_candidate_kinds(), .inflation = inflation, .weld = weld});
    if (!testing::Test::HasFailure()) expect_candidates(soup, {.inflation = inflation, .weld = weld});
}

template <class Scalar>
class CandidateAgreement : public testing::Test {
   protected:
    void expect_all(double inflation, bool weld = false) {
        SCOPED_TRACE(testing::Message() << "inflation " << inflation);
        // Where most features overlap a soup of few triangles tells as much.
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

TYPED_TEST(CandidateAgreement, OfBoxesAsTheyAre) { this->expect_all(0); }
TYPED_TEST(CandidateAgreement, OfWeldedSoups) { this->expect_all(0, true); }
TYPED_TEST(CandidateAgreement, OfBoxesThatGrow) {
    for (const double inflation : {1e-3, 0.5, 1.0, 7.0}) this->expect_all(inflation);
}
TYPED_TEST(CandidateAgreement, OfBoxesThatHoldEverything) { this->expect_all(1e9); }

TYPED_TEST(CandidateAgreement, OfListedEdgesAndPoints) {
    unsigned seed = 0;
    for (const NamedMove<TypeParam>& move : soups_to_try<TypeParam>(0.5, 1))
        for (int i = 0; i < 4; ++i, ++seed) {
            SCOPED_TRACE(testing::Message() << move.name << ", lists " << seed);
            expect_candidates(with_lists(move.soup, seed), 0, i == 3);
            if (this->HasFailure()) return;
        }
}

/// Growth that is not the soup's size: far below an ulp, and far beyond all.
TYPED_TEST(CandidateAgreement, OfAnyGrowth) {
    const auto soup = rounded<TypeParam>(moving_grid(3, 16, 12, 5));
    for (const double inflation :
         {0x1p-1074, 1e-300, 1e-20, 0x1p-53, 0x1p-24, 1e300, std::numeric_limits<double>::max()})
        expect_candidates(soup, inflation);
}

TEST(CandidateKinds, AreListedAsAskedFor) {
    const MovingSoup<> soup = moving_grid(4, 30, 24, 3);
    Detector detector({.backend = tested_backend, .threads = 2, .leaf_size = 8});
    const Candidates all =
        detector.find(soup.view().moving_to(soup.end_view()), CandidateQuery{.kinds = all_candidate_kinds()});
    for (unsigned chosen = 1; chosen < 64; ++chosen) {
        CandidateQuery question{.kinds = {}};
        for (const CandidateKind kind : all_candidate_kinds())
            if (chosen >> static_cast<unsigned>(kind) & 1) question.kinds.push_back(kind);
        const Candidates& some = detector.find(soup.view().moving_to(soup.end_view()), question);
        for (const CandidateKind kind : all_candidate_kinds()) {
            const bool asked = chosen >> static_cast<unsigned>(kind) & 1;
            EXPECT_EQ(some.listed[static_cast<std::size_t>(kind)], asked);
            EXPECT_GT(all[kind].pairs.size(), 0U);
            EXPECT_TRUE(same_pairs(some[kind].pairs.span(), asked ? all[kind].pairs.span() : std::span<const Pair>()));
        }
    }
}

TEST(CandidateGroups, AreThoseOfTheLowestTriangle) {
    MovingSoup<> soup = in_general(80, 0.5, 0.3, 4);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
        soup.groups.push_back(static_cast<std::int32_t>(t % 5));
        if (t > 0) soup.triangles[t][0] = soup.triangles[t - 1][1];
    }
    CandidateQuery question{.kinds = all_candidate_kinds(), .inflation = 0.01};
    question.filter.excluded_groups = {{0, 1}, {2, 2}};
    for (const PairScope wanted : {PairScope::between, PairScope::within}) {
        question.filter.groups = wanted;
        expect_candidates(soup, question);
    }
}

/// What touches on the way has boxes that overlap on the way.
TEST(CandidatesAndImpacts, EveryImpactIsACandidate) {
    for (const NamedMove<double>& move : soups_to_try<double>(1, 1)) {
        SCOPED_TRACE(move.name);
        Detector& detector = *tested()[1].detector;
        const Impacts& impacts = detector.find(move.soup.view().moving_to(move.soup.end_view()), ImpactQuery());
        const Candidates& candidates =
            detector.find(move.soup.view().moving_to(move.soup.end_view()), CandidateQuery());
        for (const auto& [kind, of] : {std::pair(FeatureKind::vertex_face, CandidateKind::vertex_face),
                                       std::pair(FeatureKind::edge_edge, CandidateKind::edge_edge)}) {
            const auto& pairs = candidates[of].pairs;
            for (const Pair& pair : impacts[kind].pairs)
                EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), pair)) << testing::PrintToString(pair);
        }
    }
}

}  // namespace
}  // namespace crumple::test
