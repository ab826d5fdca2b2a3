#include "feature_streams.h"

#include <memory>
#include <optional>
#include <stop_token>
#include <utility>

#include "blocks.h"
#include "candidates.h"
#include "feature_answer.h"
#include "feature_search.h"
#include "world_search.h"

namespace nb = nanobind;

namespace crumple::python {
namespace {

// What Python shows of a block counts its own rows.
template <class Block>
std::shared_ptr<Block> counted(std::shared_ptr<Block> block) {
    block->count = 0;
    for (const auto& list : block->lists) block->count += static_cast<std::int64_t>(list.pairs.size());
    return block;
}

ImpactsAnswer answer_of(std::shared_ptr<Impacts> block, const ImpactQuery& question, bool of_world) {
    ImpactsAnswer answer{counted(std::move(block)), question.output, of_world};
    answer.is_block = true;
    return answer;
}
NearbyAnswer answer_of(std::shared_ptr<Proximities> block, const ProximityQuery& question, bool of_world) {
    NearbyAnswer answer{counted(std::move(block)), question.output, of_world};
    answer.has_closest = question.closest;
    answer.is_block = true;
    return answer;
}
CandidatesAnswer answer_of(std::shared_ptr<Candidates> block, const CandidateQuery& question, bool of_world) {
    return {counted(std::move(block)), question.kinds, of_world, false};
}

// stream(detector, sink, stop) in a turn of its own.
template <class Block, class Question, class Stream>
Statistics take_blocks(SharedDetector& detector, nb::handle take, const Question& question, bool of_world,
                       Stream stream) {
    const auto make = [&](std::shared_ptr<Block> block) { return answer_of(std::move(block), question, of_world); };
    return hand_over_blocks<Block>(detector, take, make, stream);
}

}  // namespace

Statistics stream_impacts(nb::handle self, nb::handle take, const nb::tuple& mesh, nb::handle end,
                          const ImpactQuery& question, const nb::tuple& lists, nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    const BorrowedEnd at_end(end, start.mesh);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    return take_blocks<Impacts>(detector, take, question, false, [&](Detector& by, auto& sink, std::stop_token stop) {
        return by.stream(start.view.moving_to(at_end.view()), question, sink, rows, std::move(stop));
    });
}

Statistics stream_impacts_in_world(nb::handle self, nb::handle take, nb::handle world, nb::handle poses,
                                   nb::handle end_poses, const ImpactQuery& question, nb::handle excluded,
                                   nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<ImpactQuery> asked(world, question, excluded);
    const Bodies& bodies = *asked.bodies;
    const BorrowedPoses start(poses, bodies), end(end_poses, bodies, BorrowedPoses::When::end);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    const World view = moving_world(bodies, start, end, detector);
    return take_blocks<Impacts>(detector, take, question, true, [&](Detector& by, auto& sink, std::stop_token stop) {
        return by.stream(view, asked.question, sink, rows, std::move(stop));
    });
}

Statistics stream_near(nb::handle self, nb::handle take, const nb::tuple& mesh, const ProximityQuery& asked,
                       nb::handle radii, nb::handle rest, const nb::tuple& lists, nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh given(detector, mesh, lists);
    const AskedOfVertices vertices(asked, given.mesh, radii, rest);
    const ProximityQuery& question = vertices.question;
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    return take_blocks<Proximities>(detector, take, question, false,
                                    [&](Detector& by, auto& sink, std::stop_token stop) {
                                        return by.stream(given.view, question, sink, rows, std::move(stop));
                                    });
}

Statistics stream_near_in_world(nb::handle self, nb::handle take, nb::handle world, nb::handle poses,
                                const ProximityQuery& question, nb::handle excluded, nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<ProximityQuery> asked(world, question, excluded);
    const BorrowedPoses at(poses, *asked.bodies);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    const World view = posed_world(*asked.bodies, at, detector);
    return take_blocks<Proximities>(detector, take, question, true,
                                    [&](Detector& by, auto& sink, std::stop_token stop) {
                                        return by.stream(view, asked.question, sink, rows, std::move(stop));
                                    });
}

Statistics stream_candidates(nb::handle self, nb::handle take, const nb::tuple& mesh, nb::handle end,
                             const CandidateQuery& question, const nb::tuple& lists, nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfMesh start(detector, mesh, lists);
    std::optional<BorrowedEnd> at_end;
    if (!end.is_none()) at_end.emplace(end, start.mesh);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    return take_blocks<Candidates>(detector, take, question, false,
                                   [&](Detector& by, auto& sink, std::stop_token stop) {
                                       return by.stream(at_end ? start.view.moving_to(at_end->view()) : start.view,
                                                        question, sink, rows, std::move(stop));
                                   });
}

Statistics stream_candidates_in_world(nb::handle self, nb::handle take, nb::handle world, nb::handle poses,
                                      nb::handle end_poses, const CandidateQuery& question, nb::handle excluded,
                                      nb::handle block_rows) {
    SharedDetector& detector = detector_of(self);
    const AskedOfWorld<CandidateQuery> asked(world, question, excluded);
    const Bodies& bodies = *asked.bodies;
    const BorrowedPoses start(poses, bodies), end(end_poses, bodies, BorrowedPoses::When::end);
    const std::int64_t rows = integer<std::int64_t>("block_rows", block_rows);
    const SharedDetector::Turn turn(detector);
    const World view = moving_world(bodies, start, end, detector);
    return take_blocks<Candidates>(detector, take, question, true, [&](Detector& by, auto& sink, std::stop_token stop) {
        return by.stream(view, asked.question, sink, rows, std::move(stop));
    });
}

}  // namespace crumple::python
