#pragma once

// Answers about features in blocks: the calls of feature_search.h and candidates.h, each of whose blocks `take` gets.

#include <nanobind/nanobind.h>

#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/proximities.h"

namespace crumple::python {

Statistics stream_impacts(nanobind::handle self, nanobind::handle take, const nanobind::tuple& mesh,
                          nanobind::handle end, const ImpactQuery& question, const nanobind::tuple& lists,
                          nanobind::handle block_rows);
Statistics stream_impacts_in_world(nanobind::handle self, nanobind::handle take, nanobind::handle world,
                                   nanobind::handle poses, nanobind::handle end_poses, const ImpactQuery& question,
                                   nanobind::handle excluded, nanobind::handle block_rows);
Statistics stream_near(nanobind::handle self, nanobind::handle take, const nanobind::tuple& mesh,
                       const ProximityQuery& question, nanobind::handle radii, nanobind::handle rest,
                       const nanobind::tuple& lists, nanobind::handle block_rows);
Statistics stream_near_in_world(nanobind::handle self, nanobind::handle take, nanobind::handle world,
                                nanobind::handle poses, const ProximityQuery& question, nanobind::handle excluded,
                                nanobind::handle block_rows);
Statistics stream_candidates(nanobind::handle self, nanobind::handle take, const nanobind::tuple& mesh,
                             nanobind::handle end, const CandidateQuery& question, const nanobind::tuple& lists,
                             nanobind::handle block_rows);
Statistics stream_candidates_in_world(nanobind::handle self, nanobind::handle take, nanobind::handle world,
                                      nanobind::handle poses, nanobind::handle end_poses,
                                      const CandidateQuery& question, nanobind::handle excluded,
                                      nanobind::handle block_rows);

}  // namespace crumple::python
