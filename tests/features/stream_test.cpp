// Tests of feature results in blocks: together the blocks are the result of find(), byte by byte, for any block size.

#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>

#include "error_of.h"
#include "features/joined_blocks.h"
#include "features/listed_soups.h"
#include "features/moving_worlds.h"
#include "memory_limit.h"
#include "rounds.h"

namespace crumple::test {
namespace {

// Captures soups by reference: they outlive the calls.
template <class Scalar>
BothCalls<Impacts> impacts(const MovingSoup<Scalar>& soup, const ImpactQuery& query) {
    return {
        [&, query](Detector& by) -> const Impacts& { return by.find(soup.view().moving_to(soup.end_view()), query); },
        [&, query](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
            return by.stream(soup.view().moving_to(soup.end_view()), query, take, rows, std::move(stop));
        }};
}
template <class Scalar>
BothCalls<Proximities> near(const MovingSoup<Scalar>& soup, const ProximityQuery& query) {
    return {[&, query](Detector& by) -> const Proximities& { return by.find(soup.view(), query); },
            [&, query](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                return by.stream(soup.view(), query, take, rows, std::move(stop));
            }};
}
template <class Scalar>
BothCalls<Candidates> candidates(const MovingSoup<Scalar>& soup, bool step, const CandidateQuery& query) {
    return {[&, step, query](Detector& by) -> const Candidates& {
                return step ? by.find(soup.view().moving_to(soup.end_view()), query) : by.find(soup.view(), query);
            },
            [&, step, query](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                return step ? by.stream(soup.view().moving_to(soup.end_view()), query, take, rows, std::move(stop))
                            : by.stream(soup.view(), query, take, rows, std::move(stop));
            }};
}

/// Detectors that are reused from soup to soup.
Detector& plain() {
    static Detector detector({.backend = Backend::cpu, .threads = 1});
    return detector;
}
std::vector<Detector*> streaming() {
    static Detector one({.backend = Backend::cpu, .threads = 1, .leaf_size = 20});
    static Detector three({.backend = Backend::cpu, .threads = 3, .clusters = 5, .leaf_size = 8});
    static Detector limited({.backend = Backend::cpu, .threads = 2, .memory_limit = 1 << 24, .leaf_size = 30});
    return {&one, &three, &limited};
}
Detector& brute_force() {
    static Detector detector({.backend = Backend::reference});
    return detector;
}

template <class Result>
void expect_blocks(const BothCalls<Result>& calls, bool reference = false) {
    const Result expected = calls.find(plain());
    auto detectors = streaming();
    if (reference) detectors = {&brute_force()};
    for (std::size_t d = 0; d < detectors.size(); ++d) {
        SCOPED_TRACE(testing::Message() << "detector " << d);
        for (const std::int64_t size : {std::int64_t{1}, std::int64_t{7}, std::int64_t{1000}, std::int64_t{1} << 30}) {
            if (size == 1000 && expected.count <= 7) continue;
            expect_blocks<Result>(calls, expected, *detectors[d], size);
            if (testing::Test::HasFailure()) return;
        }
    }
}

template <class Scalar>
class StreamOfFeatures : public testing::Test {
   protected:
    template <class Work>
    void for_each_soup(double part, Work work) {
        for (const NamedMove<Scalar>& move : moving_soups<Scalar>(part * scaled_rounds(10) / 10)) {
            SCOPED_TRACE(move.name);
            work(move);
            if (this->HasFailure()) return;
        }
    }
};
class PrecisionNames {
   public:
    template <class Scalar>
    static std::string GetName(int) {
        return sizeof(Scalar) == 4 ? "float32" : "float64";
    }
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(StreamOfFeatures, Precisions, PrecisionNames);

TYPED_TEST(StreamOfFeatures, blocks_of_impacts_hold_all_rows) {
    this->for_each_soup(0.4, [](const auto& move) {
        expect_blocks(impacts(move.soup, {}));
        if (move.unit > 1e100) return;
        expect_blocks(impacts(move.soup, {.min_distance = 0.1 * move.unit, .weld = true}));
    });
}

TYPED_TEST(StreamOfFeatures, blocks_of_proximities_hold_all_rows) {
    this->for_each_soup(0.4, [](const auto& move) {
        if (move.unit > 1e100) return;
        expect_blocks(near(move.soup, {.radius = 0.5 * move.unit, .closest = true}));
        expect_blocks(near(move.soup, {.radius = 0.7 * move.unit, .strict = true, .weld = true, .rings = 1}));
    });
}

TYPED_TEST(StreamOfFeatures, blocks_of_candidates_hold_all_rows) {
    this->for_each_soup(0.3, [](const auto& move) {
        expect_blocks(candidates(move.soup, true, {}));
        expect_blocks(candidates(move.soup, false, {.kinds = all_candidate_kinds(), .weld = true}));
    });
}

TYPED_TEST(StreamOfFeatures, blocks_with_radii_and_rest_shape_hold_all_rows) {
    const auto soup = rounded<TypeParam>(moving_grid(5, 60, 70, 3));
    std::vector<double> radii;
    for (std::size_t v = 0; v < soup.start.size(); ++v) radii.push_back(0.1 * static_cast<double>(v % 7));
    const ProximityQuery query{.radii = radii, .closest = true, .rest = soup.end_view(), .rest_radius = 1.5};
    const BothCalls<Proximities> calls = near(soup, query);
    EXPECT_GT(calls.find(plain()).count, 300);
    expect_blocks(calls);
}

TYPED_TEST(StreamOfFeatures, blocks_of_codimensional_features_hold_all_rows) {
    unsigned seed = 0;
    this->for_each_soup(0.25, [&](const auto& move) {
        if (move.unit > 1e100) return;
        const auto soup = with_lists(move.soup, seed++);
        expect_blocks(impacts(soup, {.min_distance = 0.1 * move.unit}));
        expect_blocks(near(soup, {.radius = 0.5 * move.unit, .closest = true}));
        expect_blocks(candidates(soup, true, {.kinds = all_candidate_kinds()}));
    });
}

TYPED_TEST(StreamOfFeatures, blocks_of_the_reference_backend_hold_all_rows) {
    this->for_each_soup(0.15, [](const auto& move) {
        if (move.unit > 1e100) return;
        expect_blocks(impacts(move.soup, {}), true);
        expect_blocks(near(move.soup, {.radius = 0.5 * move.unit, .closest = true}), true);
        expect_blocks(candidates(move.soup, true, {.kinds = all_candidate_kinds()}), true);
    });
}

TEST(StreamOfFeatures, blocks_respect_group_filters) {
    MovingSoup<> soup = in_general(150, 0.5, 0.4, 3);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 5));
    ImpactQuery query;
    query.filter.groups = PairScope::between;
    query.filter.excluded_groups = {{0, 1}, {2, 4}};
    const BothCalls<Impacts> calls = impacts(soup, query);
    EXPECT_GT(calls.find(plain()).count, 500);
    expect_blocks(calls);
}

// One vertex, and thus two edges and a face, is near everything: one feature has more rows than a block holds.
TEST(StreamOfFeatures, rows_of_one_feature_may_span_blocks) {
    const MovingSoup<> soup = giant_under_many(300, 4, 40);
    std::vector<double> radii(soup.start.size(), 0.0);
    radii[150] = 30;
    const BothCalls<Proximities> calls = near(soup, {.radii = radii, .closest = true});
    const Proximities expected = calls.find(plain());
    std::vector<int> of_vertex(soup.start.size()), of_edge(expected.edges.size());
    for (const Pair& pair : expected.vertex_faces().pairs) ++of_vertex[static_cast<std::size_t>(pair.a)];
    for (const Pair& pair : expected.edge_edges().pairs) ++of_edge[static_cast<std::size_t>(pair.a)];
    ASSERT_GT(*std::max_element(of_vertex.begin(), of_vertex.end()), 200);
    ASSERT_GT(*std::max_element(of_edge.begin(), of_edge.end()), 500);
    const BothCalls<Candidates> boxes = candidates(soup, true, {.kinds = {CandidateKind::face_face}});
    const Candidates listed = boxes.find(plain());
    ASSERT_GT(listed.count, 1000);  // 200 of them with the giant triangle
    for (Detector* detector : streaming())
        for (const std::int64_t size : {30, 90}) {
            expect_blocks<Proximities>(calls, expected, *detector, size);
            expect_blocks<Candidates>(boxes, listed, *detector, size);
        }
}

TEST(StreamOfFeatures, blocks_of_worlds_hold_all_rows) {
    std::int64_t rows = 0;
    for (unsigned seed = 0; seed < 24; ++seed) {
        SCOPED_TRACE(seed);
        WorldKind kind{.bodies = static_cast<int>(seed % 7), .worlds = 1 + static_cast<int>(seed % 3), .triangles = 12};
        kind.everywhere = seed % 5 == 0 ? 1 : 0.3;
        const auto moving = moving_world(seed, kind);
        std::vector<std::vector<Edge>> edges;
        std::vector<std::vector<std::int32_t>> points;
        for (Shape& shape : moving->world->shapes) {
            if (shape.vertices.rows < 3 || seed % 2 == 0) continue;
            shape.edges = edges.emplace_back(std::vector<Edge>{{0, 1}, {2, 1}});
            shape.points = points.emplace_back(std::vector<std::int32_t>{2, 0, 0});
        }
        const World step = moving->view(), still{step.shapes, step.bodies, step.poses};
        const IntersectionQuery drawn = random_query(seed, kind.bodies);
        const auto expect = [&](auto calls) {
            rows += calls.find(plain()).count;
            expect_blocks(calls);
        };
        ImpactQuery motion{.min_distance = 0.02, .weld = drawn.weld};
        motion.filter = drawn.filter;
        expect(BothCalls<Impacts>{[&](Detector& by) -> const Impacts& { return by.find(step, motion); },
                                  [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                      return by.stream(step, motion, take, rows, std::move(stop));
                                  }});
        ProximityQuery nearness{.radius = 0.1, .closest = true, .rings = static_cast<std::int32_t>(seed % 3)};
        nearness.filter = drawn.filter;
        expect(BothCalls<Proximities>{[&](Detector& by) -> const Proximities& { return by.find(still, nearness); },
                                      [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                          return by.stream(still, nearness, take, rows, std::move(stop));
                                      }});
        CandidateQuery boxes{.kinds = all_candidate_kinds(), .inflation = 0.01};
        boxes.filter = drawn.filter;
        expect(BothCalls<Candidates>{[&](Detector& by) -> const Candidates& { return by.find(step, boxes); },
                                     [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                         return by.stream(step, boxes, take, rows, std::move(stop));
                                     }});
        if (HasFailure()) return;
    }
    EXPECT_GT(rows, 5000);
}

TEST(StreamOfFeatures, empty_results_have_no_blocks) {
    const auto never = [](const auto&) { FAIL(); };
    for (Detector* detector : streaming()) {
        EXPECT_EQ(detector->stream(World(), ImpactQuery(), never).pairs, 0);
        EXPECT_EQ(detector->stream(World(), ProximityQuery(), never).pairs, 0);
        EXPECT_EQ(detector->stream(World(), CandidateQuery(), never).pairs, 0);
        EXPECT_EQ(detector->stream(MeshView(), CandidateQuery(), never).pairs, 0);
        EXPECT_EQ(detector->stream(MeshView(), ProximityQuery{.radius = 1}, never).pairs, 0);
        const auto one = in_general(1, 0.1, 0.1, 1);
        EXPECT_EQ(detector->stream(one.view().moving_to(one.end_view()), ImpactQuery(), never).triangles, 1);
    }
}

template <class Result>
void expect_to_end(const BothCalls<Result>& calls, Detector& detector) {
    const Result expected = calls.find(plain());
    ASSERT_GT(expected.count, 400);
    int blocks = 0;
    const auto refuse = [&](const Result&) {
        if (++blocks == 3) throw std::runtime_error("full");
    };
    EXPECT_THROW(calls.blocks(detector, refuse, 50), std::runtime_error);
    EXPECT_EQ(blocks, 3);
    std::stop_source stop;
    int before_stop = 0;
    const auto request_stop = [&](const Result&) { ++before_stop, stop.request_stop(); };
    const auto stopped = [&] { calls.blocks(detector, request_stop, 50, stop.get_token()); };
    EXPECT_EQ(error_of(stopped).code, ErrorCode::cancelled);
    EXPECT_EQ(error_of(stopped).code, ErrorCode::cancelled) << "before it begins";
    EXPECT_EQ(before_stop, 1) << "no block follows a stop request";
    expect_blocks<Result>(calls, expected, detector, 1000);
    EXPECT_EQ(calls.find(detector).count, expected.count);
}

TEST(StreamOfFeatures, exception_or_stop_request_ends_the_stream) {
    const MovingSoup<> soup = in_general(600, 0.4, 0.3, 5);
    for (Detector* detector : streaming()) {
        expect_to_end(impacts(soup, {}), *detector);
        expect_to_end(near(soup, {.radius = 0.05}), *detector);
        expect_to_end(candidates(soup, true, {}), *detector);
    }
    const MovingSoup<> small = moving_grid(3, 20, 30, 5);
    expect_to_end(impacts(small, {}), brute_force());
}

template <class Result>
void expect_within_limit(const BothCalls<Result>& calls) {
    const std::int64_t count = calls.find(plain()).count;
    const auto limit_of = [&](auto call) { return sufficient_limit({.threads = 2}, call, 4); };
    const std::int64_t whole = limit_of([&](Detector& by) { calls.find(by); });
    const Soup<float> other = random_soup(800, 0.2);
    const auto caller = std::this_thread::get_id();
    std::int64_t rows = 0;
    const auto take = [&](const Result& block) {
        EXPECT_EQ(std::this_thread::get_id(), caller) << "one thread does it all";
        for (const auto& list : block.lists) rows += static_cast<std::int64_t>(list.pairs.size());
    };
    const auto stream = [&](Detector& by, std::int64_t size) {
        rows = 0;
        return calls.blocks(by, take, size).peak_memory_bytes;
    };
    const std::int64_t limit = limit_of([&](Detector& by) { stream(by, 1000); });
    EXPECT_LT(limit, whole / 2);
    Detector enough({.threads = 2, .memory_limit = limit});
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(error_of([&] { calls.find(enough); }).code, ErrorCode::memory_limit);
        EXPECT_TRUE(enough.any(other.view())) << "whose memory is kept";
        EXPECT_LE(stream(enough, 1000), limit);
        EXPECT_EQ(rows, count);
    }
    const Error error = error_of([&] { stream(enough, 1 << 20); });
    EXPECT_EQ(error.code, ErrorCode::memory_limit);
    EXPECT_GT(error.bytes_needed, limit);
    sufficient_limit({.memory_limit = limit}, [&](Detector& more) {
        stream(more, 1 << 20);
        EXPECT_EQ(rows, count);
    });
}

TEST(StreamOfFeatures, stream_fits_a_limit_too_small_for_the_whole_result) {
    const MovingSoup<> soup = in_general(700, 0.7, 0.4, 6);
    expect_within_limit(impacts(soup, {}));
    expect_within_limit(near(soup, {.radius = 0.05, .closest = true}));
    expect_within_limit(candidates(soup, true, {}));
}

// A worker moves its rows into a block before it continues the search, so only few rows are in memory at any time.
TEST(StreamOfFeatures, candidate_blocks_need_under_a_quarter_of_the_memory_of_a_list) {
    const MovingSoup<> soup = in_general(1500, 0.5, 0.3, 7);
    Detector find({.threads = 1}), stream({.threads = 1});
    const std::int64_t whole =
        find.find(soup.view().moving_to(soup.end_view()), CandidateQuery()).statistics.peak_memory_bytes;
    const auto ignore = [](const Candidates&) {};
    const Statistics statistics =
        stream.stream(soup.view().moving_to(soup.end_view()), CandidateQuery(), ignore, 20'000);
    EXPECT_EQ(statistics.pairs, find.find(soup.view().moving_to(soup.end_view()), CandidateQuery()).count);
    EXPECT_LT(statistics.peak_memory_bytes, whole / 4) << statistics.pairs;
}

TEST(StreamOfFeatures, unsupported_options_of_blocks_are_rejected) {
    const MovingSoup<> soup = in_general(10, 0.4, 0.3, 5);
    const auto ignore = [](const auto&) {};
    const auto expect = [&](const std::string& word, auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_EQ(error.element, Element::option);
        EXPECT_EQ(std::string(error.what()).find(word), 0U) << error.what();
    };
    for (const ImpactQuery& query :
         {ImpactQuery{.index = true}, ImpactQuery{.triangle_pairs = true}, ImpactQuery{.output = Output::first}})
        expect(query.index            ? "index"
               : query.triangle_pairs ? "triangle_pairs"
                                      : "output",
               [&] { Detector().stream(soup.view().moving_to(soup.end_view()), query, ignore); });
    for (const ProximityQuery& query :
         {ProximityQuery{.index = true}, ProximityQuery{.least = true}, ProximityQuery{.output = Output::any}})
        expect(query.index   ? "index"
               : query.least ? "least"
                             : "output",
               [&] { Detector().stream(soup.view(), query, ignore); });
    expect("kinds", [&] { Detector().stream(soup.view(), CandidateQuery{.kinds = {}}, ignore); });
    for (const std::int64_t size : {std::int64_t{0}, (std::int64_t{1} << 40) + 1})
        expect("block_rows", [&] { Detector().stream(soup.view(), CandidateQuery(), ignore, size); });
    expect("radii must be empty for a world", [&] {
        const std::vector<double> radii{1};
        Detector().stream(World(), ProximityQuery{.radii = radii}, ignore);
    });
}

}  // namespace
}  // namespace crumple::test
