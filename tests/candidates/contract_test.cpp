// Boundary cases of the definition of a candidate, errors and the detector's state after them, and ownership of
// results.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stop_token>

#include "candidates/compare_candidates.h"
#include "error_of.h"
#include "features/compare_features.h"
#include "features/moving_soups.h"
#include "memory_limit.h"

namespace crumple::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
constexpr double most = std::numeric_limits<double>::max();

class Candidacy : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{Options{.backend = GetParam(), .threads = 2}};

    /// True if two points (degenerate triangles) are a candidate pair when their coordinates are `low` and `high` on
    /// one axis and equal on the others.
    bool listed(double low, double high, double r, int axis) {
        MovingSoup<> soup;
        for (const double at : {low, high}) {
            PointOf<double> p{1, 1, 1};
            p[static_cast<std::size_t>(axis)] = at;
            const std::int32_t v = soup.vertex(p, p);
            soup.triangles.push_back({v, v, v});
        }
        const Candidates& found =
            detector_.find(soup.view(), CandidateQuery{.kinds = all_candidate_kinds(), .inflation = r});
        // Pairs of the two vertices, of each vertex with the other's face, and of the two faces; no edges.
        const bool any = found.count > 0;
        EXPECT_EQ(found[CandidateKind::vertex_vertex].pairs.size(), any ? 1U : 0U);
        EXPECT_EQ(found[CandidateKind::vertex_face].pairs.size(), any ? 2U : 0U);
        EXPECT_EQ(found[CandidateKind::face_face].pairs.size(), any ? 1U : 0U);
        EXPECT_EQ(found.count, any ? 4 : 0);
        return any;
    }
    void expect_edge(double low, double high, double r) {
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_TRUE(listed(low, high, r, axis)) << low << ' ' << high << ' ' << r;
            EXPECT_TRUE(listed(high, low, r, axis)) << low << ' ' << high << ' ' << r;
            EXPECT_FALSE(listed(low, std::nextafter(high, inf), r, axis)) << low << ' ' << high << ' ' << r;
            EXPECT_FALSE(listed(std::nextafter(high, inf), low, r, axis)) << low << ' ' << high << ' ' << r;
        }
    }
};

TEST_P(Candidacy, gap_may_be_twice_the_inflation_but_no_ulp_more) {
    expect_edge(0, 0, 0);
    expect_edge(3, 3, 0);
    expect_edge(1, 2, 0.5);
    expect_edge(-1, 1, 1);
    expect_edge(0.1, 0.1, 0);
    expect_edge(1e300, 3e300, 1e300);
    expect_edge(0x1p-1074, 3 * 0x1p-1074, 0x1p-1074);
    expect_edge(-0x1p-1074, 0x1p-1074, 0x1p-1074);
    expect_edge(0x1p52, 0x1p52 + 1, 0.5);
    expect_edge(-0x1p1023, 0x1p1023, 0x1p1023);
}
/// Compares sums of coordinates and inflation that differ but round to the same float64 number.
TEST_P(Candidacy, gaps_are_compared_without_rounding_error) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_TRUE(listed(1, 1 + 0x1p-52, 0x1p-53, axis));
        EXPECT_FALSE(listed(1, 1 + 0x1p-52, std::nextafter(0x1p-53, 0), axis));
        EXPECT_TRUE(listed(-1, 0x1p-60, 0.5 + 0x1p-53, axis));
        EXPECT_FALSE(listed(-1, 0x1p-60, 0.5, axis));
        EXPECT_TRUE(listed(-1, -0x1p-60, 0.5, axis));
        EXPECT_FALSE(listed(-1, 0x1p-1074, 0.5, axis));
        EXPECT_TRUE(listed(-most, most, most, axis)) << "sums overflow";
        EXPECT_FALSE(listed(-most, most, std::nextafter(most, 0), axis));
        EXPECT_FALSE(listed(-most, 0x1p-1074, most / 2, axis));
        EXPECT_TRUE(listed(-most, -0x1p-1074, most / 2, axis));
        EXPECT_TRUE(listed(-most, 0, most / 2, axis));
        EXPECT_FALSE(listed(-0x1p1023, 0x1p-1074, 0x1p1022, axis));
    }
}
TEST_P(Candidacy, boxes_hold_whole_trajectories) {
    MovingSoup<> soup;
    const auto point = [&](PointOf<double> from, PointOf<double> to) {
        const std::int32_t v = soup.vertex(from, to);
        soup.triangles.push_back({v, v, v});
    };
    point({0, 0, 0}, {4, 4, 0});  // its trajectory is a diagonal, its box a square
    point({0, 4, 0}, {0, 4, 0});  // static, at a corner of that box
    point({5, 4, 0}, {5, 4, 0});
    const auto pairs = [&](double r, bool step) {
        const CandidateQuery query{.kinds = {CandidateKind::vertex_vertex}, .inflation = r};
        const Candidates& found =
            step ? detector_.find(soup.view().moving_to(soup.end_view()), query) : detector_.find(soup.view(), query);
        return std::vector<Pair>(found[CandidateKind::vertex_vertex].pairs.begin(),
                                 found[CandidateKind::vertex_vertex].pairs.end());
    };
    EXPECT_EQ(pairs(0, true), (std::vector<Pair>{{0, 1}}));
    EXPECT_EQ(pairs(0.5, true), (std::vector<Pair>{{0, 1}, {0, 2}}));
    EXPECT_EQ(pairs(2, false), (std::vector<Pair>{{0, 1}}));
    EXPECT_EQ(pairs(1, false), (std::vector<Pair>{}));
}

TEST_P(Candidacy, static_mesh_and_step_have_different_candidates) {
    const MovingSoup<> soup = moving_grid(3, 14, 10, 1);
    const Candidates of_static_mesh = detector_.find(soup.view(), CandidateQuery());
    EXPECT_GT(of_static_mesh.count, 0);
    EXPECT_TRUE(same_candidates(detector_.find(soup.view(), CandidateQuery()), of_static_mesh));
    EXPECT_FALSE(
        same_candidates(detector_.find(soup.view().moving_to(soup.end_view()), CandidateQuery()), of_static_mesh));
}

TEST_P(Candidacy, features_of_one_triangle_can_be_candidates) {
    const std::vector<std::array<double, 3>> vertices{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}};
    const auto count = [&](double r) {
        const Candidates& found = detector_.find(MeshView(vertices, triangles),
                                                 CandidateQuery{.kinds = all_candidate_kinds(), .inflation = r});
        EXPECT_EQ(found.count, static_cast<std::int64_t>(found[CandidateKind::vertex_vertex].pairs.size() +
                                                         found[CandidateKind::vertex_edge].pairs.size()));
        return std::pair(found[CandidateKind::vertex_vertex].pairs.size(),
                         found[CandidateKind::vertex_edge].pairs.size());
    };
    EXPECT_EQ(count(0), std::pair(std::size_t{0}, std::size_t{1})) << "the corner lies in the box of the slope";
    EXPECT_EQ(count(0.5), std::pair(std::size_t{0}, std::size_t{1}));
    EXPECT_EQ(count(1), std::pair(std::size_t{3}, std::size_t{3}));
}

TEST_P(Candidacy, neighbours_are_listed_on_request) {
    // Two triangles with a common edge, 1-2. Points 0 and 3 are far from each other.
    const std::vector<std::array<double, 3>> vertices{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {9, 0, 0}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {1, 3, 2}};
    const auto found = [&](bool neighbours, CandidateKind kind) {
        const auto& pairs =
            detector_
                .find(MeshView(vertices, triangles), CandidateQuery{.kinds = {kind}, .neighbours = neighbours})[kind]
                .pairs;
        return std::vector<Pair>(pairs.begin(), pairs.end());
    };
    for (const CandidateKind kind :
         {CandidateKind::vertex_face, CandidateKind::edge_face, CandidateKind::face_face, CandidateKind::vertex_vertex})
        EXPECT_EQ(found(false, kind), std::vector<Pair>{});
    EXPECT_EQ(found(true, CandidateKind::vertex_face),
              (std::vector<Pair>{{0, 0}, {1, 0}, {1, 1}, {2, 0}, {2, 1}, {3, 1}}));
    EXPECT_EQ(found(true, CandidateKind::face_face), (std::vector<Pair>{{0, 1}}));
    // Edges: 0: 0-1, 1: 0-2, 2: 1-2, 3: 1-3, 4: 2-3.
    EXPECT_EQ(found(false, CandidateKind::edge_edge), (std::vector<Pair>{{0, 4}, {1, 3}}));
    EXPECT_EQ(found(true, CandidateKind::edge_edge),
              (std::vector<Pair>{{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}}));
    EXPECT_EQ(found(true, CandidateKind::edge_face),
              (std::vector<Pair>{{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0}, {2, 1}, {3, 0}, {3, 1}, {4, 0}, {4, 1}}));
    EXPECT_EQ(found(true, CandidateKind::vertex_vertex), std::vector<Pair>{});
}

INSTANTIATE_TEST_SUITE_P(, Candidacy, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& info) { return std::string(backend_name(info.param)); });

class CandidateErrors : public testing::TestWithParam<Backend> {
   protected:
    Detector detector_{Options{.backend = GetParam(), .threads = 2}};
    const MovingSoup<> soup_ = moving_grid(3, 14, 10, 1);

    /// Returns the error of a call. Expects the call to empty the result that the detector holds, and not to affect
    /// later calls.
    template <class Call>
    Error refused(Call call) {
        const Candidates& held = detector_.find(soup_.view().moving_to(soup_.end_view()), CandidateQuery());
        EXPECT_GT(held.count, 0);
        const Error error = error_of(call);
        EXPECT_TRUE(held.count == 0 && held.edges.empty() && held[CandidateKind::vertex_face].pairs.empty() &&
                    held[CandidateKind::edge_edge].pairs.empty() && held.listed == Candidates().listed)
            << "holds an empty result";
        Detector fresh(detector_.options());
        EXPECT_TRUE(same_candidates(detector_.find(soup_.view().moving_to(soup_.end_view()), CandidateQuery()),
                                    fresh.find(soup_.view().moving_to(soup_.end_view()), CandidateQuery())));
        return error;
    }
    Error refused(const CandidateQuery& query) {
        return refused([&] { detector_.find(soup_.view().moving_to(soup_.end_view()), query); });
    }
};

TEST_P(CandidateErrors, invalid_inflation_is_rejected) {
    for (const double wrong : {nan, inf, -inf, -1.0, -0x1p-1074}) {
        const Error error = refused({.inflation = wrong});
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_EQ(error.element, Element::option);
        EXPECT_STREQ(error.what(), "inflation must be finite and 0 or more");
    }
}
TEST_P(CandidateErrors, missing_and_unknown_kinds_are_rejected) {
    EXPECT_STREQ(refused({.kinds = {}}).what(), "kinds must have at least one kind of candidates");
    EXPECT_STREQ(refused({.kinds = {static_cast<CandidateKind>(6)}}).what(), "kinds must be values of CandidateKind");
}
TEST_P(CandidateErrors, invalid_end_positions_are_rejected) {
    const auto at = [&](const VertexView& end) {
        return refused([&] { detector_.find(soup_.view().moving_to(end), CandidateQuery()); });
    };
    VertexView end = soup_.end_view();
    end.rows = 13;
    EXPECT_EQ(at(end).code, ErrorCode::invalid_argument);
    auto soup = soup_;
    soup.end[11][2] = nan;
    EXPECT_STREQ(at(soup.end_view()).what(), "at the end: vertex 11 is not finite");
}
TEST_P(CandidateErrors, meshes_with_invalid_indices_or_device_memory_are_rejected) {
    auto soup = soup_;
    soup.triangles[4][1] = 14;
    EXPECT_STREQ(refused([&] { detector_.find(soup.view(), CandidateQuery()); }).what(),
                 "triangle 4 names vertex 14 of 14");
    MeshView mesh = soup_.view();
    mesh.memory = MemorySpace::cuda;
    EXPECT_EQ(refused([&] { detector_.find(mesh, CandidateQuery()); }).code, ErrorCode::invalid_argument);
}
TEST_P(CandidateErrors, call_stopped_before_its_start_reports_cancellation) {
    std::stop_source stop;
    stop.request_stop();
    const auto call = [&] { detector_.find(soup_.view(), CandidateQuery(), stop.get_token()); };
    EXPECT_EQ(refused(call).code, ErrorCode::cancelled);
}

INSTANTIATE_TEST_SUITE_P(, CandidateErrors, testing::Values(Backend::reference, Backend::cpu),
                         [](const auto& info) { return std::string(backend_name(info.param)); });

TEST(CandidateCalls, cuda_backend_refuses_neighbours) {
    if (tested_backend != Backend::cuda) GTEST_SKIP() << "there is no cuda backend";
    const MovingSoup<> soup = moving_grid(4, 30, 24, 3);
    Detector detector({.backend = Backend::cuda});
    EXPECT_STREQ(error_of([&] { detector.find(soup.view(), CandidateQuery{.neighbours = true}); }).what(),
                 "neighbours must be false with the cuda backend; use the cpu backend (Options::backend)");
}

TEST(CandidateCalls, swap_result_moves_the_result_without_copying) {
    const MovingSoup<> soup = moving_grid(4, 30, 24, 3);
    Detector detector({.backend = Backend::cpu, .threads = 2}), fresh({.backend = Backend::cpu});
    const Candidates& held = detector.find(soup.view(), CandidateQuery{.inflation = 1});
    const Pair* const storage = held[CandidateKind::edge_edge].pairs.data();
    const Pair* const vertex_faces = held[CandidateKind::vertex_face].pairs.data();
    const auto* const edges = held.edges.data();
    Candidates taken;
    detector.swap_result(taken);
    EXPECT_EQ(taken[CandidateKind::edge_edge].pairs.data(), storage) << "nothing is copied";
    EXPECT_EQ(taken[CandidateKind::vertex_face].pairs.data(), vertex_faces);
    EXPECT_EQ(taken.edges.data(), edges);
    EXPECT_TRUE(held.count == 0 && held[CandidateKind::edge_edge].pairs.empty() && held.edges.empty());
    detector.find(soup.view(), CandidateQuery());
    EXPECT_TRUE(same_candidates(taken, fresh.find(soup.view(), CandidateQuery{.inflation = 1})));
}

TEST(CandidateCalls, results_do_not_depend_on_earlier_calls) {
    const std::vector<MovingSoup<>> soups{moving_grid(3, 20, 20, 4), in_general(60, 0.3, 0.2, 5), {}};
    Detector warm({.backend = Backend::cpu, .threads = 2, .leaf_size = 8});
    for (int round = 0; round < 2; ++round)
        for (const MovingSoup<>& soup : soups) {
            Detector fresh({.backend = Backend::cpu, .threads = 2, .leaf_size = 8});
            const CandidateQuery query{.kinds = all_candidate_kinds(), .inflation = 0.1 * round};
            ASSERT_TRUE(same_candidates(warm.find(soup.view().moving_to(soup.end_view()), query),
                                        fresh.find(soup.view().moving_to(soup.end_view()), query)));
            ASSERT_TRUE(same_features(warm.find(soup.view(), ProximityQuery{.radius = 0.1}),
                                      fresh.find(soup.view(), ProximityQuery{.radius = 0.1})));
            ASSERT_TRUE(same_result(warm.find(soup.view()), fresh.find(soup.view())));
        }
}

class CandidateMemory : public testing::TestWithParam<int> {};

TEST_P(CandidateMemory, limited_call_gives_same_result_or_names_larger_limit) {
    const MovingSoup<> soup = in_general(1500, 0.07, 0.06, 6);
    const Options options{.backend = Backend::cpu, .threads = GetParam(), .leaf_size = 40};
    const auto find = [&](Detector& detector) -> const Candidates& {
        return detector.find(soup.view().moving_to(soup.end_view()), CandidateQuery{.kinds = all_candidate_kinds()});
    };
    Detector free(options);
    const Candidates expected = find(free);
    bool refused = false;
    for (std::int64_t limit = expected.statistics.peak_memory_bytes; limit > 10'000; limit = limit * 3 / 5) {
        SCOPED_TRACE(limit);
        Options tight = options;
        tight.memory_limit = limit;
        Detector limited(tight);
        try {
            EXPECT_TRUE(same_candidates(find(limited), expected));
            EXPECT_LE(find(limited).statistics.peak_memory_bytes, limit);
        } catch (const Error& error) {
            refused = true;
            ASSERT_EQ(error.code, ErrorCode::memory_limit) << error.what();
            EXPECT_GT(error.bytes_needed, limit);
            tight.memory_limit = sufficient_limit(tight, find);
            for (int again = 0; again < 3; ++again) {
                Detector enough(tight);
                EXPECT_TRUE(same_candidates(find(enough), expected));
            }
        }
    }
    EXPECT_TRUE(refused) << "no limit was too small";
}
INSTANTIATE_TEST_SUITE_P(Threads, CandidateMemory, testing::Values(1, 2, 5));

}  // namespace
}  // namespace crumple::test
