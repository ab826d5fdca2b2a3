#pragma once

// One scene on many processes of MPI. Link crumple::mpi, which -DCRUMPLE_MPI=ON builds. docs/distributed.md

#ifndef OMPI_SKIP_MPICXX
#define OMPI_SKIP_MPICXX 1
#endif
#ifndef MPICH_SKIP_MPICXX
#define MPICH_SKIP_MPICXX 1
#endif
#include <mpi.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "crumple/distributed.h"
#include "crumple/error.h"
#include "crumple/export.h"

namespace crumple::mpi {

/// Searches a scene of which each rank brings a share. The rows of all ranks, merged, are the bytes of
/// crumple::Detector::find, for any number of ranks and any distribution. Keeps parts and
/// centres between calls: where only vertices have moved, little more than their coordinates travels.
///
/// Every call but the destructor is collective: all ranks of the communicator make the same calls, in the same order,
/// with the same query and options. A call throws the same crumple::Error on all ranks, if it throws on one
/// (Error::rank), and leaves the detectors usable. A stop that is requested on one rank ends the call on all. A process
/// that dies ends the job, as MPI does. One thread makes the calls; if MPI was initialised with less than
/// MPI_THREAD_SERIALIZED, the one that initialised it, and with MPI_THREAD_SINGLE only a detector of one thread works.
class CRUMPLE_API Detector {
   public:
    /// Of a duplicate of the communicator, so that messages of others never get mixed up with these.
    explicit Detector(MPI_Comm communicator, const DistributedOptions& options = {});
    /// Does not communicate; the duplicate is left to MPI_Finalize unless close() has freed it.
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    /// Frees the communicator and all memory. No call may follow.
    void close();

    /// Finds everything that the query describes, as crumple::Detector::find does. On each rank those rows whose first
    /// triangle, or first feature, or first body, it has brought, in order. Valid until the next call. A share is a
    /// MeshShare or a WorldShare, a query one of intersections, impacts or proximities.
    ///
    /// For less output than pairs no rows travel; Output::any_by_world is as Output::any. A mesh that moves says where
    /// to (MeshView::moving_to); listed edges and points are not read. Parts are made for one query: another minimum
    /// distance, or a query of another kind, begins them anew. A filter of bodies speaks of these (Body::self, too) or
    /// of groups, not of both. Throws Error (invalid_argument) for what ranks have not: `index`, `triangle_pairs`,
    /// `radii`, `rest`, `rings`, `least`; of triangles, excluded bodies; of bodies, Body::world other than 0, poses on
    /// a device, and shapes with listed edges or points, radii, or a rest shape. An Error about a body has its number
    /// over all ranks (Element::body); where there are no ids, and it is not about coordinates or triangles, the rank's
    /// own.
    template <class Query = IntersectionQuery, class Share>
    const typename Query::DistributedResult& find(const Share& share, const Query& query = {},
                                                  std::stop_token stop = {});
    /// True if there is anything to find, over all ranks. Each rank stops at its first.
    template <class Query = IntersectionQuery, class Share>
    bool any(const Share& share, const Query& query = {}, std::stop_token stop = {});

    /// Has `poll` called at the beginning of each phase, and about every 20 ms while this rank searches, in the thread
    /// that made the call. What it throws ends the call on all ranks: an Error is thrown on all of them, anything else
    /// as it is here, and as an Error (cancelled) elsewhere. Not collective; it must not call this detector.
    void set_poll(std::function<void()> poll);

    /// Has `show` called, in the thread that made the call, as each phase begins on this rank, and as each part has
    /// been searched. Phases come in their order, each once at most; what a call does not need is left out. What it
    /// throws ends the call as it does in a poll. Not collective; it must not call this detector. An empty one: no
    /// calls.
    void set_progress(std::function<void(const DistributedProgress&)> show);

    /// What the last call did on this rank.
    const DistributedStatistics& statistics() const;
    /// With the number of threads that it has come to.
    const DistributedOptions& options() const;
    int rank() const;
    int ranks() const;

   private:
    struct Implementation;
    Implementation& open() const;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace crumple::mpi
