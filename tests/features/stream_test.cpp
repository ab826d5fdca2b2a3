// Answers about features in blocks: together they are the answer of find, byte for byte, whatever the blocks' size.

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

// What views name outlives the call: soups and questions are captured by reference.
template <class Scalar>
Asked<Impacts> impacts(const MovingSoup<Scalar>& soup, const ImpactQuery& question) {
    return {[&, question](Detector& by) -> const Impacts& {
                return by.find(soup.view().moving_to(soup.end_view()), question);
            },
            [&, question](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                return by.stream(soup.view().moving_to(soup.end_view()), question, take, rows, std::move(stop));
            }};
}
template <class Scalar>
Asked<Proximities> near(const MovingSoup<Scalar>& soup, const ProximityQuery& question) {
    return {[&, question](Detector& by) -> const Proximities& { return by.find(soup.view(), question); },
            [&, question](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                return by.stream(soup.view(), question, take, rows, std::move(stop));
            }};
}
template <class Scalar>
Asked<Candidates> candidates(const MovingSoup<Scalar>& soup, bool step, const CandidateQuery& question) {
    return {[&, step, question](Detector& by) -> const Candidates& {
                return step ? by.find(soup.view().moving_to(soup.end_view()), question)
                            : by.find(soup.view(), question);
            },
            [&, step, question](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                return step ? by.stream(soup.view().moving_to(soup.end_view()), question, take, rows, std::move(stop))
                            : by.stream(soup.view(), question, take, rows, std::move(stop));
            }};
}

/// Detectors that go from soup to soup.
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
Detector& by_brute_force() {
    static Detector detector({.backend = Backend::reference});
    return detector;
}

template <class Answer>
void expect_blocks(const Asked<Answer>& asked, bool reference = false) {
    const Answer expected = asked.find(plain());
    auto detectors = streaming();
    if (reference) detectors = {&by_brute_force()};
    for (std::size_t d = 0; d < detectors.size(); ++d) {
        SCOPED_TRACE(testing::Message() << "detector " << d);
        for (const std::int64_t size : {std::int64_t{1}, std::int64_t{7}, std::int64_t{1000}, std::int64_t{1} << 30}) {
            if (size == 1000 && expected.count <= 7) continue;
            expect_blocks<Answer>(asked, expected, *detectors[d], size);
            if (testing::Test::HasFailure()) return;
        }
    }
}

template <class Scalar>
class StreamOfFeatures : public testing::Test {
   protected:
    template <class Work>
    void for_each_soup(double part, Work work) {
        for (const NamedMove<Scalar>& move : moving_soups<Scalar>(part * more_or_less(10) / 10)) {
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

TYPED_TEST(StreamOfFeatures, Impacts) {
    this->for_each_soup(0.4, [](const auto& move) {
        expect_blocks(impacts(move.soup, {}));
        if (move.unit > 1e100) return;
        expect_blocks(impacts(move.soup, {.min_distance = 0.1 * move.unit, .weld = true}));
    });
}

TYPED_TEST(StreamOfFeatures, NearPairs) {
    this->for_each_soup(0.4, [](const auto& move) {
        if (move.unit > 1e100) return;
        expect_blocks(near(move.soup, {.radius = 0.5 * move.unit, .closest = true}));
        expect_blocks(near(move.soup, {.radius = 0.7 * move.unit, .strict = true, .weld = true, .rings = 1}));
    });
}

TYPED_TEST(StreamOfFeatures, CandidateChunk) {
    this->for_each_soup(0.3, [](const auto& move) {
        expect_blocks(candidates(move.soup, true, {}));
        expect_blocks(candidates(move.soup, false, {.kinds = all_candidate_kinds(), .weld = true}));
    });
}

TYPED_TEST(StreamOfFeatures, NearPairsWithRadiiAndARestShape) {
    const auto soup = rounded<TypeParam>(moving_grid(5, 60, 70, 3));
    std::vector<double> radii;
    for (std::size_t v = 0; v < soup.start.size(); ++v) radii.push_back(0.1 * static_cast<double>(v % 7));
    const ProximityQuery question{.radii = radii, .closest = true, .rest = soup.end_view(), .rest_radius = 1.5};
    const Asked<Proximities> asked = near(soup, question);
    EXPECT_GT(asked.find(plain()).count, 300);
    expect_blocks(asked);
}

TYPED_TEST(StreamOfFeatures, OfListedEdgesAndPoints) {
    unsigned seed = 0;
    this->for_each_soup(0.25, [&](const auto& move) {
        if (move.unit > 1e100) return;
        const auto soup = with_lists(move.soup, seed++);
        expect_blocks(impacts(soup, {.min_distance = 0.1 * move.unit}));
        expect_blocks(near(soup, {.radius = 0.5 * move.unit, .closest = true}));
        expect_blocks(candidates(soup, true, {.kinds = all_candidate_kinds()}));
    });
}

TYPED_TEST(StreamOfFeatures, OfTheReferenceBackend) {
    this->for_each_soup(0.15, [](const auto& move) {
        if (move.unit > 1e100) return;
        expect_blocks(impacts(move.soup, {}), true);
        expect_blocks(near(move.soup, {.radius = 0.5 * move.unit, .closest = true}), true);
        expect_blocks(candidates(move.soup, true, {.kinds = all_candidate_kinds()}), true);
    });
}

TEST(StreamOfFeatures, HasGroupsAndRules) {
    MovingSoup<> soup = in_general(150, 0.5, 0.4, 3);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) soup.groups.push_back(static_cast<std::int32_t>(t % 5));
    ImpactQuery question;
    question.filter.groups = PairScope::between;
    question.filter.excluded_groups = {{0, 1}, {2, 4}};
    const Asked<Impacts> asked = impacts(soup, question);
    EXPECT_GT(asked.find(plain()).count, 500);
    expect_blocks(asked);
}

// One vertex, and with it two edges and a face, is near everything: more rows of one feature than a block holds.
TEST(StreamOfFeatures, CutsTheRowsOfOneFeature) {
    const MovingSoup<> soup = giant_under_many(300, 4, 40);
    std::vector<double> radii(soup.start.size(), 0.0);
    radii[150] = 30;
    const Asked<Proximities> asked = near(soup, {.radii = radii, .closest = true});
    const Proximities expected = asked.find(plain());
    std::vector<int> of_vertex(soup.start.size()), of_edge(expected.edges.size());
    for (const Pair& pair : expected.vertex_faces().pairs) ++of_vertex[static_cast<std::size_t>(pair.a)];
    for (const Pair& pair : expected.edge_edges().pairs) ++of_edge[static_cast<std::size_t>(pair.a)];
    ASSERT_GT(*std::max_element(of_vertex.begin(), of_vertex.end()), 200);
    ASSERT_GT(*std::max_element(of_edge.begin(), of_edge.end()), 500);
    const Asked<Candidates> boxes = candidates(soup, true, {.kinds = {CandidateKind::face_face}});
    const Candidates listed = boxes.find(plain());
    ASSERT_GT(listed.count, 1000);  // 200 of the giant
    for (Detector* detector : streaming())
        for (const std::int64_t size : {30, 90}) {
            expect_blocks<Proximities>(asked, expected, *detector, size);
            expect_blocks<Candidates>(boxes, listed, *detector, size);
        }
}

TEST(StreamOfFeatures, OfWorlds) {
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
        const IntersectionQuery drawn = random_question(seed, kind.bodies);
        const auto expect = [&](auto asked) {
            rows += asked.find(plain()).count;
            expect_blocks(asked);
        };
        ImpactQuery motion{.min_distance = 0.02, .weld = drawn.weld};
        motion.filter = drawn.filter;
        expect(Asked<Impacts>{[&](Detector& by) -> const Impacts& { return by.find(step, motion); },
                              [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                  return by.stream(step, motion, take, rows, std::move(stop));
                              }});
        ProximityQuery nearness{.radius = 0.1, .closest = true, .rings = static_cast<std::int32_t>(seed % 3)};
        nearness.filter = drawn.filter;
        expect(Asked<Proximities>{[&](Detector& by) -> const Proximities& { return by.find(still, nearness); },
                                  [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                      return by.stream(still, nearness, take, rows, std::move(stop));
                                  }});
        CandidateQuery boxes{.kinds = all_candidate_kinds(), .inflation = 0.01};
        boxes.filter = drawn.filter;
        expect(Asked<Candidates>{[&](Detector& by) -> const Candidates& { return by.find(step, boxes); },
                                 [&](Detector& by, auto take, std::int64_t rows, std::stop_token stop) {
                                     return by.stream(step, boxes, take, rows, std::move(stop));
                                 }});
        if (HasFailure()) return;
    }
    EXPECT_GT(rows, 5000);
}

TEST(StreamOfFeatures, OfNothingHasNoBlocks) {
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

template <class Answer>
void expect_to_end(const Asked<Answer>& asked, Detector& detector) {
    const Answer expected = asked.find(plain());
    ASSERT_GT(expected.count, 400);
    int blocks = 0;
    const auto refuse = [&](const Answer&) {
        if (++blocks == 3) throw std::runtime_error("full");
    };
    EXPECT_THROW(asked.blocks(detector, refuse, 50), std::runtime_error);
    EXPECT_EQ(blocks, 3);
    std::stop_source stop;
    const auto ask = [&](const Answer&) { stop.request_stop(); };
    const auto stopped = [&] { asked.blocks(detector, ask, 50, stop.get_token()); };
    EXPECT_EQ(error_of(stopped).code, ErrorCode::cancelled);
    EXPECT_EQ(error_of(stopped).code, ErrorCode::cancelled) << "before it begins";
    expect_blocks<Answer>(asked, expected, detector, 1000);
    EXPECT_EQ(asked.find(detector).count, expected.count);
}

TEST(StreamOfFeatures, EndsByWhatABlockThrowsAndByAStop) {
    const MovingSoup<> soup = in_general(600, 0.4, 0.3, 5);
    for (Detector* detector : streaming()) {
        expect_to_end(impacts(soup, {}), *detector);
        expect_to_end(near(soup, {.radius = 0.05}), *detector);
        expect_to_end(candidates(soup, true, {}), *detector);
    }
    const MovingSoup<> small = moving_grid(3, 20, 30, 5);
    expect_to_end(impacts(small, {}), by_brute_force());
}

template <class Answer>
void expect_within_limit(const Asked<Answer>& asked) {
    const std::int64_t count = asked.find(plain()).count;
    const auto limit_of = [&](auto call) { return sufficient_limit({.threads = 2}, call, 4); };
    const std::int64_t whole = limit_of([&](Detector& by) { asked.find(by); });
    const Soup<float> other = random_soup(800, 0.2);
    const auto caller = std::this_thread::get_id();
    std::int64_t rows = 0;
    const auto take = [&](const Answer& block) {
        EXPECT_EQ(std::this_thread::get_id(), caller) << "one thread does it all";
        for (const auto& list : block.lists) rows += static_cast<std::int64_t>(list.pairs.size());
    };
    const auto stream = [&](Detector& by, std::int64_t size) {
        rows = 0;
        return asked.blocks(by, take, size).peak_memory_bytes;
    };
    const std::int64_t limit = limit_of([&](Detector& by) { stream(by, 1000); });
    EXPECT_LT(limit, whole / 2);
    Detector enough({.threads = 2, .memory_limit = limit});
    for (int round = 0; round < 2; ++round) {
        EXPECT_EQ(error_of([&] { asked.find(enough); }).code, ErrorCode::memory_limit);
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

TEST(StreamOfFeatures, FitsALimitThatTheAnswerDoesNotFitOrNamesOne) {
    const MovingSoup<> soup = in_general(700, 0.7, 0.4, 6);
    expect_within_limit(impacts(soup, {}));
    expect_within_limit(near(soup, {.radius = 0.05, .closest = true}));
    expect_within_limit(candidates(soup, true, {}));
}

// A worker's rows are in a block before the next one is searched; what a limit counts does not depend on who
// found it.
TEST(StreamOfFeatures, PeaksFarBelowTheWholeAnswer) {
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

TEST(StreamOfFeatures, RefusesWhatBlocksHaveNot) {
    const MovingSoup<> soup = in_general(10, 0.4, 0.3, 5);
    const auto ignore = [](const auto&) {};
    const auto expect = [&](const std::string& word, auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_EQ(error.element, Element::option);
        EXPECT_EQ(std::string(error.what()).find(word), 0U) << error.what();
    };
    for (const ImpactQuery& question :
         {ImpactQuery{.index = true}, ImpactQuery{.triangle_pairs = true}, ImpactQuery{.output = Output::first}})
        expect(question.index            ? "index"
               : question.triangle_pairs ? "triangle_pairs"
                                         : "output",
               [&] { Detector().stream(soup.view().moving_to(soup.end_view()), question, ignore); });
    for (const ProximityQuery& question :
         {ProximityQuery{.index = true}, ProximityQuery{.least = true}, ProximityQuery{.output = Output::any}})
        expect(question.index   ? "index"
               : question.least ? "least"
                                : "output",
               [&] { Detector().stream(soup.view(), question, ignore); });
    expect("kinds", [&] { Detector().stream(soup.view(), CandidateQuery{.kinds = {}}, ignore); });
    for (const std::int64_t size : {std::int64_t{0}, (std::int64_t{1} << 40) + 1})
        expect("block_rows", [&] { Detector().stream(soup.view(), CandidateQuery(), ignore, size); });
    expect("radii of a world", [&] {
        const std::vector<double> radii{1};
        Detector().stream(World(), ProximityQuery{.radii = radii}, ignore);
    });
}

}  // namespace
}  // namespace crumple::test
