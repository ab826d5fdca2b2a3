#pragma once

// crumple::mpi::Detector for Python: the GIL released, and ranks that fail in Python fail together.

#include <cstdint>
#include <exception>
#include <optional>
#include <stop_token>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/mpi.h"
#include "mpi/world_share.h"

namespace crumple::python {

class RankDetector;

/// What one rank brings, in place. Needs the GIL to come and go.
struct BorrowedShare {
    /// `mesh` is a crumple.Mesh. Throws where the detector cannot read the memory that the arrays lie in.
    BorrowedShare(const RankDetector& detector, const nanobind::tuple& mesh, nanobind::handle triangle_ids,
                  nanobind::handle vertex_ids);
    MeshShare view() const {
        return {end ? mesh.view().moving_to(end->view()) : mesh.view(), triangle_ids.view(), vertex_ids.view()};
    }

    const BorrowedMesh mesh;
    std::optional<BorrowedEnd> end;
    const BorrowedIds triangle_ids, vertex_ids;
};

/// One call at a time; where a signal handler or another thread makes a second one, that is refused.
class RankDetector {
   public:
    /// Collective, as all that follows but set properties. `communicator`: MPI's handle, as mpi4py tells it.
    RankDetector(std::uintptr_t communicator, const DistributedOptions& options);

    template <class Share, class Query>
    typename Query::DistributedResult find(const Share& share, const Query& query);
    template <class Share, class Query>
    bool any(const Share& share, const Query& query);
    /// A call for a rank that failed before its own: all ranks raise the same. Returns, here alone, if `exception` is
    /// none of crumple's, for the caller to raise it.
    void fail(nanobind::handle exception);
    void close();
    /// Not collective. show(phase, parts done, parts) is called within calls; None: nothing is. What it raises ends the
    /// call.
    void set_progress(nanobind::object show);

    const mpi::Detector& detector() const { return detector_; }

   private:
    template <class Work>
    auto alone(Work work);
    void poll();
    void show(const DistributedProgress& progress);

    mpi::Detector detector_;
    bool calling_ = false;                          ///< guarded by the GIL
    std::exception_ptr failed_;                     ///< before the call: thrown where ranks agree first
    std::optional<nanobind::python_error> raised_;  ///< by a signal handler or by show_, within the call
    nanobind::object show_;
};

void bind_rank_detector(nanobind::module_& module);

}  // namespace crumple::python
