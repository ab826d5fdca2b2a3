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

/// Finds all pairs of triangles that intersect, of a scene of which each rank brings a share. The rows of all ranks,
/// merged, are the bytes of crumple::Detector::find_self, for any number of ranks and any distribution. Keeps parts and
/// centres between calls: where only vertices have moved, little more than their coordinates travels.
///
/// Every call but the destructor is collective: all ranks of the communicator make the same calls, in the same order,
/// with the same question and options. A call throws the same crumple::Error on all ranks, if it throws on one
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

    /// All colliding pairs: on each rank those whose first triangle it has brought, in order. Valid until the next
    /// call.
    const DistributedCollisions& find_self(const MeshShare& share, const Query& query = {}, std::stop_token stop = {});
    /// How many pairs there are over all ranks; no rows travel. The time of find_self, less that of rows.
    std::int64_t count(const MeshShare& share, const Query& query = {}, std::stop_token stop = {});
    /// Whether there is any pair over all ranks. Each rank stops at its first.
    bool has_collision(const MeshShare& share, const Query& query = {}, std::stop_token stop = {});

    /// What touches what on the way to `end`, where each of the rank's vertices is at the end of the step; as
    /// crumple::Detector::find_impacts. For Motion::wants `earliest` and `any` no rows travel. Throws Error
    /// (invalid_argument) for what ranks have not: `triangle_pairs`, `index`, excluded bodies. Listed edges and points
    /// (MeshView::edges) are not read. Parts are made for one question: another separation, or a question of another
    /// kind, begins them anew.
    const DistributedImpacts& find_impacts(const MeshShare& share, const VertexView& end, const Motion& question = {},
                                           std::stop_token stop = {});
    /// What is near what; as crumple::Detector::find_near, but for `radii`, `rest`, `rings`, `least` and `index`.
    const DistributedNearby& find_near(const MeshShare& share, const Near& question, std::stop_token stop = {});
    /// Of bodies that each rank brings, as crumple::Detector answers for a world; pairs, impacts and near pairs lie
    /// with the rank of their first body. Rules speak of bodies (Body::self, too) or of groups, not of both. Throws
    /// Error (invalid_argument), beside what calls on triangles have not, for `index`, Body::world other than 0, poses
    /// on a device, and shapes with listed edges or points, radii, or a shape at rest. Wants::any_by_world is as
    /// Wants::any. An Error about a body has its number over all ranks (Element::body); where there are no ids, and it
    /// is not about coordinates or triangles, the rank's own.
    const DistributedWorldCollisions& find(const WorldShare& share, const Intersect& question = {},
                                           std::stop_token stop = {});
    const DistributedImpacts& find_impacts(const WorldShare& share, const Motion& question = {},
                                           std::stop_token stop = {});
    const DistributedNearby& find_near(const WorldShare& share, const Near& question, std::stop_token stop = {});
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
