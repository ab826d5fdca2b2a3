#pragma once

// crumple::mpi::Detector for Python: releases the GIL, and makes a call fail on all ranks if Python code (a signal
// handler, a callback) raises an exception on one rank. All ranks learn of it at the next collective error check, an
// exchange that all of them make.

#include <cstdint>
#include <exception>
#include <optional>
#include <stop_token>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/mpi.h"
#include "mpi/local_world.h"

namespace crumple::python {

class RankDetector;

/// View of the local mesh of a rank. Construct and destroy it with the GIL.
struct BorrowedLocalMesh {
    /// `mesh` is a crumple.Mesh. Throws Error if the detector cannot read the memory of the arrays.
    BorrowedLocalMesh(const RankDetector& detector, const nanobind::tuple& mesh, nanobind::handle triangle_ids,
                      nanobind::handle vertex_ids);
    LocalMesh view() const {
        return {end ? mesh.view().moving_to(end->view()) : mesh.view(), triangle_ids.view(), vertex_ids.view()};
    }

    const BorrowedMesh mesh;
    std::optional<BorrowedEnd> end;
    const BorrowedIds triangle_ids, vertex_ids;
};

/// Detector of one rank. Refuses a call while another is in progress, from another thread or a signal handler.
class RankDetector {
   public:
    /// Collective, like all following functions except set_progress and detector. `communicator`: MPI handle as a
    /// number, as mpi4py represents it.
    RankDetector(std::uintptr_t communicator, const DistributedOptions& options);

    template <class Local, class Query>
    typename Query::DistributedResult find(const Local& local, const Query& query);
    template <class Local, class Query>
    bool any(const Local& local, const Query& query);
    /// Call on a rank that has failed, with `exception`, before it could make a call that the other ranks make: all
    /// ranks throw the same Error. If `exception` is not a crumple.Error, this function returns on this rank, and the
    /// caller must raise `exception`; the other ranks throw.
    void fail(nanobind::handle exception);
    void close();
    /// Sets a Python function that is called as show(phase, parts done, parts) during calls; None: no function. An
    /// exception from `show` ends the call. Not collective.
    void set_progress(nanobind::object show);

    const mpi::Detector& detector() const { return detector_; }

   private:
    template <class Work>
    auto run_exclusively(Work work);
    void poll();
    void show(const DistributedProgress& progress);

    mpi::Detector detector_;
    bool calling_ = false;       ///< true while a call is in progress; guarded by the GIL
    std::exception_ptr failed_;  ///< error given to fail(), thrown at the first collective error check of its call
    std::optional<nanobind::python_error> raised_;  ///< exception of a signal handler or of show_ during the call
    nanobind::object show_;
};

void bind_rank_detector(nanobind::module_& module);

}  // namespace crumple::python
