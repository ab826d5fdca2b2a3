#pragma once

// Candidates: what is asked, the calls that answer it, and the answer as NumPy arrays without a copy.

#include <memory>
#include <vector>

#include <nanobind/nanobind.h>

#include "crumple/candidates.h"

namespace crumple::python {

/// What a crumple.Candidates shows. Its arrays hold it, but not the result, which holds them.
struct CandidatesAnswer {
    std::shared_ptr<Candidates> storage;
    std::vector<CandidateKind> kinds;  ///< that were asked for
    bool of_world = false;             ///< else of one mesh, which has no bodies
    bool copy = false;                 ///< the result shows writable copies

    const Candidates& found() const { return *storage; }
};

/// `end`: None at rest.
CandidatesAnswer find_candidates(nanobind::handle self, const nanobind::tuple& mesh, nanobind::handle end,
                                 const CandidateQuery& question, nanobind::handle copy, const nanobind::tuple& lists);
CandidatesAnswer find_candidates_in_world(nanobind::handle self, nanobind::handle world, nanobind::handle poses,
                                          nanobind::handle end_poses, const CandidateQuery& question,
                                          nanobind::handle excluded, nanobind::handle copy);

void bind_candidates(nanobind::module_& module);

}  // namespace crumple::python
