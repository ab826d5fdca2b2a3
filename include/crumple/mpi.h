#pragma once

// Detector that searches one scene with many MPI processes (docs/distributed.md). Link the target crumple::mpi, which
// is built with -DCRUMPLE_MPI=ON.

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

/// Searches a scene that is distributed over ranks: each provides local triangles or bodies. The rows of all ranks,
/// merged, are the same bytes as those of crumple::Detector::find, for any number of ranks and any distribution. Caches
/// parts and centres between calls: if only vertices have moved, little more than their coordinates is sent.
///
/// The constructor, find(), any() and close() are collective: all ranks of the communicator make these calls, in the
/// same order, with the same query and options. If a call throws on one rank, it throws the same crumple::Error on all
/// (Error::rank), and leaves the detectors usable. A stop that is requested on one rank ends the call on all. A process
/// that dies ends the job, as usual with MPI. On each rank one thread makes all calls. If MPI was initialised with less
/// than MPI_THREAD_SERIALIZED, that must be the thread that initialised MPI; with MPI_THREAD_SINGLE, the detector
/// itself must also be limited to one thread (Options::threads).
class CRUMPLE_API Detector {
   public:
    /// Works on a duplicate of the communicator, so that its messages are never mixed up with others.
    explicit Detector(MPI_Comm communicator, const DistributedOptions& options = {});
    /// Does not communicate. Unless close() was called, MPI_Finalize frees the duplicate.
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    /// Frees the duplicate communicator and all memory. No call may follow.
    void close();

    /// Finds everything that the query describes, as crumple::Detector::find does. Each rank gets the rows whose first
    /// triangle, feature or body it has provided, in order; valid until the next call. `Local` is LocalMesh or
    /// LocalWorld; the query is an IntersectionQuery, ImpactQuery, ProximityQuery or OverlapQuery.
    ///
    /// With less output than pairs no rows are sent; Output::any_by_world is the same as Output::any. A moving mesh has
    /// its end positions in MeshView::end; codimensional edges and points (MeshView::edges, MeshView::points) are
    /// ignored. Parts are cached for the last query only: a call with a different minimum distance or radius, or with
    /// another type of query, makes new parts. The pair filter may filter by bodies (including Body::self) or by
    /// groups, not by both, except in an OverlapQuery. Throws Error (invalid_argument) for what ranks do not support:
    /// `index`, `triangle_pairs`, `radii`, `rest`, `rings`, `least`; for meshes, excluded bodies; for worlds,
    /// Body::world other than 0, poses in device memory, and shapes with codimensional edges or points, radii, or a
    /// rest shape. Error::index of an error about a body (Element::body) counts bodies over all ranks. Exception:
    /// without `body_ids`, errors about anything but coordinates or triangles count the bodies of the rank that failed.
    ///
    /// Overlaps: a rank searches whole pairs of bodies, and the bodies that it lacks are sent to it in each call. The
    /// overlap of a LocalMesh with itself is one row, on the rank of triangle 0 (rank 0 if there is no triangle). All
    /// ranks search for triangles that intersect; then that rank gets the whole mesh and computes the row alone, so it
    /// needs memory for the whole mesh.
    template <class Query = IntersectionQuery, class Local>
    const typename Query::DistributedResult& find(const Local& local, const Query& query = {},
                                                  std::stop_token stop = {});
    /// True if find() would find anything on any rank. Each rank stops at its first pair.
    template <class Query = IntersectionQuery, class Local>
    bool any(const Local& local, const Query& query = {}, std::stop_token stop = {});

    /// Calls `poll` at the beginning of each phase, and about every 20 ms while this rank searches, in the thread that
    /// made the call. An exception from `poll` ends the call on all ranks: an Error is thrown on all of them; any other
    /// exception is thrown on this rank, and Error (cancelled) on the others. Not collective. `poll` must not call this
    /// detector.
    void set_poll(std::function<void()> poll);

    /// Calls `show`, in the thread that made the call, at the beginning of each phase on this rank and after the search
    /// of each part. Phases come in their order, each at most once; phases that a call does not need are skipped.
    /// Exceptions are handled as those of `poll`. Not collective. `show` must not call this detector. An empty function
    /// stops the calls.
    void set_progress(std::function<void(const DistributedProgress&)> show);

    /// Returns counts and times of the last call on this rank.
    const DistributedStatistics& statistics() const;
    /// Returns the options, with the number of threads and the device that this rank uses.
    const DistributedOptions& options() const;
    /// Returns the rank of this process in the communicator, from 0.
    int rank() const;
    /// Returns the number of ranks of the communicator.
    int ranks() const;

   private:
    struct Implementation;
    Implementation& open() const;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace crumple::mpi
