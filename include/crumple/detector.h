#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "crumple/candidates.h"
#include "crumple/device_features.h"
#include "crumple/distances.h"
#include "crumple/export.h"
#include "crumple/function_ref.h"
#include "crumple/impacts.h"
#include "crumple/intersections.h"
#include "crumple/mesh.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/part.h"
#include "crumple/proximities.h"
#include "crumple/scene.h"
#include "crumple/world.h"

namespace crumple {

template <class Query, class... Of>
concept OneOf = (std::same_as<Query, Of> || ...);
/// Queries with one row for each pair, which can be cut short, and answered part by part.
template <class Query>
concept PairQuery = OneOf<Query, IntersectionQuery, ImpactQuery, ProximityQuery>;
/// Queries that can be asked whether there is anything.
template <class Query>
concept FlagQuery = PairQuery<Query> || OneOf<Query, OverlapQuery>;
/// Queries whose rows can be delivered in blocks, and left on a device.
template <class Query>
concept RowQuery = PairQuery<Query> || OneOf<Query, CandidateQuery>;
template <class Query>
concept AnyQuery = RowQuery<Query> || OneOf<Query, DistanceQuery, OverlapQuery, FirstImpactQuery, FreeStepQuery>;

template <RowQuery Query>
class LaunchTicket;

/// Searches scenes, exactly and completely. The type of a query says what is searched for, and gives the type of the
/// result: IntersectionQuery, ImpactQuery, FirstImpactQuery, FreeStepQuery, ProximityQuery, CandidateQuery,
/// DistanceQuery, OverlapQuery; without a type it is about intersections. Keeps buffers and cluster centres between
/// calls, so a detector that is fed the frames of a simulation is faster than a new one for each; the topology may
/// change freely.
///
/// A detector is used by one thread at a time; different detectors work at the same time. Results are references to
/// what the detector owns, valid until its next call, move or destruction. Every call throws crumple::Error on bad
/// input, which names mesh, body or shape, and leaves the detector usable. Where a query cannot be asked of a scene, or
/// not with this backend, that is an Error (invalid_argument).
///
/// A call that is given a std::stop_token ends soon after a stop is requested, from any thread: it throws Error
/// (cancelled) within some milliseconds, or returns its result if that was all but there. A request that was made
/// before the call ends it at once.
class CRUMPLE_API Detector {
   public:
    explicit Detector(const Options& options = {});
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    /// Finds everything that the query describes.
    ///
    /// Worlds: bodies whose shapes are named cost next to nothing while they are clear of others; flags for such bodies
    /// end at the first hit. One body with Body::self gives the rows of its mesh. The cuda backend searches copies on
    /// its device, many worlds at once; where poses lie there (World::device_poses), only they are new in a call, and
    /// what the bodies are stays there. For features, arrays of a world lie in host memory. Two meshes are a world of
    /// two bodies for queries about features and distances.
    ///
    /// Meshes in device memory: all arrays, also those of the query, lie where the mesh does. For features, triangles,
    /// and listed edges and points, are copied to the host once, and again where they are others than in the call
    /// before; all arrays are in each call that welds, asks for triangle pairs, a free step, closest points or least
    /// distances, or filters groups beside lists of edges or points.
    ///
    /// Parts: the rows of the whole result that the part owns, with the ids of the meshes, in their order; each row is
    /// owned by one part. It costs what a mesh of the part's size does. Offsets, hit flags and least distances count by
    /// position in the part's lists: offsets[i] belongs to triangle part.mesh.ids[i]. `first` and `any` are those of
    /// the part; edges and points are empty, for a part knows its own (PartFeatures). A part that did not come from
    /// partition() is checked, and an Error's vertex or triangle is a position in the part.
    ///
    /// Throws Error (invalid_argument), with the sentence that supports() is about, where that is false.
    template <AnyQuery Query = IntersectionQuery>
    const typename Query::Result& find(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// True if find() takes queries of this type about such a scene: by what it is, where it lies, and the backend that
    /// works. docs/supported.md has the table. Of options only IntersectionQuery::containment matters; says nothing of
    /// sizes, and looks at no array.
    template <AnyQuery Query = IntersectionQuery>
    bool supports(const Scene& scene, const Query& query = {}) const;

    /// True if there is anything to find: of intersections, impacts, proximities and overlaps. Stops at the first pair
    /// found; the cuda backend at those found at the same time. Query::output does not matter, if the query has it. A
    /// step is free if there is no impact.
    template <FlagQuery Query = IntersectionQuery>
    bool any(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// Calls `take(block)` with one block of the result after another, for results that exceed memory; a block is gone
    /// when `take` returns. Of intersections, impacts, proximities and candidates, with the cpu and the reference
    /// backend, of scenes in host memory that are no parts.
    ///
    /// A block has `block_rows` (1 to 2^40) rows of all its lists together, the last one fewer; their bodies, and
    /// contacts if those are asked for. Of worlds and of features, `count` is the number of rows so far, with the
    /// block's own. Edges and points are as in the whole result. There is nothing else: no offsets, no flags, no first
    /// impact. All blocks together have the rows of the whole result, world by world, but in another order: leaf by
    /// leaf. That does not depend on threads; like the leaves, it does on the memory limit and on calls before.
    ///
    /// Memory is that of find() without its lists, and of about three blocks; under a memory limit on one thread. Cost:
    /// that of find(); of several worlds, the scene of each is made twice for features. `take` is called from any
    /// thread of the detector, by one at a time, and must not call this detector; what it throws ends the call, as a
    /// stop does, and then some blocks have been delivered. Throws Error (invalid_argument) for what blocks have not:
    /// `index`, `triangle_pairs`, `least`, and less output than pairs.
    template <RowQuery Query = IntersectionQuery>
    Statistics stream(const Scene& scene, const Query& query,
                      FunctionRef<void(const typename Query::Result& block)> take,
                      std::int64_t block_rows = std::int64_t{1} << 18, std::stop_token stop = {});

    /// Cuts a scene of one mesh, or of two for intersections, into `count` (1 to 262,144) parts for queries of this
    /// type: of intersections, impacts and proximities. Depends only on the arguments, so that several machines that
    /// are given the same meshes make the same parts. Parts for queries about features answer for no more distance than
    /// this query asks for, with the radii, the rest shape and the welding of this query; they are about twice as
    /// large, and know no triangle pairs. For intersections the members of the query do not matter.
    ///
    /// Meshes of a device are copied to the host first, for intersections; for features they lie in host memory.
    /// O(triangles times 64 a level) and the copies; on all threads of the cpu backend. The memory limit counts neither
    /// parts nor what it takes to make them. What is done after the meshes were read is not cut short by a stop.
    template <PairQuery Query = IntersectionQuery>
    std::vector<Part> partition(const Scene& scene, const Query& query, int count, std::stop_token stop = {});

    /// Swaps the last result of this type with `other`, which outlives the detector and its next call, and is no longer
    /// counted by the memory limit. The detector's own result is empty afterwards; what `other` held is dropped, but
    /// its storage serves the next result, unless there is a memory limit. Swaps pointers, copies nothing.
    template <class Result>
    void swap_result(Result& other);
    /// Returns the result by value; pass an old one to reuse its storage.
    template <class Result>
    Result take_result(Result spare = {}) {
        swap_result(spare);
        return spare;
    }

    /// Has `poll` called about every 20 ms while a call runs, in the thread that made the call; shorter calls do not
    /// poll. What it throws ends the call and leaves it, as an Error does; it must not call this detector. For
    /// languages whose signals must be looked at in the calling thread. Empty: none.
    void set_poll(std::function<void()> poll);

    /// Starts a query on arrays in device memory and returns at once; wait() of the ticket gives the result:
    ///
    ///     auto launched = detector.launch(mesh.moving_to(end), ImpactQuery());
    ///     const DeviceImpacts& impacts = launched.wait();
    ///
    /// Takes intersections of meshes and of worlds whose poses lie there (World::device_poses), and impacts,
    /// proximities and candidates of one mesh. Only with the cuda backend. On the stream of the mesh (of the first), or
    /// of the poses, which all arrays, also those of the query, have to be ready on. Consecutive frames of one shape
    /// run as one CUDA graph each, and the host reads one struct of counters after it. The arrays must stay as they are
    /// until the wait() for it returns; shapes and bodies of a world until this returns.
    ///
    /// Two launches of any kind may be in flight before a wait(), on one stream or two; they are waited for in their
    /// order. A third throws Error (invalid_argument), and leaves them. Passes share their lists, so that they run one
    /// after the other. Any call but launches, and those of tickets, forgets what is in flight, after it has waited
    /// for it.
    ///
    /// On a stream that is being captured, the query becomes part of the caller's graph, and each replay of that is a
    /// query, of what the arrays then hold. Two calls before it, outside of the capture, with meshes of the same shape
    /// or the same bodies, and the same query, make the lists; without them it throws Error (invalid_argument), and the
    /// capture goes on. Lists cannot grow in a replay: wait() then says that the result is not complete. The graph may
    /// be replayed until the next call but those of the ticket, which may move or free what it works on; and no call
    /// may be made while a replay runs. One launch to a capture and detector; the streams of two meshes both take part.
    ///
    /// Features: the first launch for a mesh, and one whose mesh has other numbers of vertices, triangles, listed edges
    /// or points than the one before, waits for the stream: the host has to see which edges there are. So does a wait
    /// where triangles or lists turn out to be others; in a capture, where they stay what they were, the result is then
    /// not complete. Throws Error (invalid_argument) for what find() copies the mesh to the host for. `index` does not
    /// matter.
    ///
    /// Worlds: bodies and shapes are read and uploaded when they are not those of the call before (a named shape by its
    /// name and groups, another by its contents, which are compared in each call), as is the filter. Such a call takes
    /// what a first one does; other calls are one CUDA graph. All worlds are one scene: without those that have fewer
    /// than two triangles at most 65,535, and 2^24 triangles together where there are several, bodies that are in all
    /// worlds counted in each. Throws Error (invalid_argument) for more, which find() takes; for Output::body_pairs and
    /// for `index`. Cost: that of a mesh of the triangles of all worlds together, whatever the output; the host
    /// compares bodies, some nanoseconds each.
    template <RowQuery Query = IntersectionQuery>
    LaunchTicket<Query> launch(const Scene& scene, const Query& query = {});

    const Options& options() const;

    /// The backend that works: what Options::backend asks for, or what Backend::automatic has chosen.
    Backend backend() const;

    /// Why Backend::automatic took the cpu backend although this build has the cuda backend, in one line; else empty.
    /// Valid while the detector lives.
    std::string_view fallback() const;

   private:
    template <RowQuery Query>
    friend class LaunchTicket;
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Ticket of a launch, as Detector::launch returns it: a value that is cheap to copy. Its calls are calls of the
/// detector, which must be alive; the detector may be moved in the meantime.
template <RowQuery Query>
class CRUMPLE_API LaunchTicket {
   public:
    /// Waits for the launch and returns where its result lies on the device. Reports bad input, which names its body;
    /// makes room and runs again where a list was too short, and does what only the host can: the result is complete.
    /// Valid until the second launch after this one, or the detector's next call that is neither a launch nor one of a
    /// ticket. (Where memory, or Options::memory_limit, does not hold two results: until the next launch or wait().)
    /// Where memory does not hold all worlds at once: Error (memory_limit or device).
    ///
    /// After a launch in a capture: returns the result of the last replay, whose stream the caller has waited for;
    /// valid until the next replay. It does not run again what did not fit (`complete`): a call outside of a capture
    /// makes longer lists, for a new one. May be called again after each replay, also after bad input.
    ///
    /// Throws Error (invalid_argument), and leaves what is in flight, if an older launch is in flight; if this one was
    /// waited for before, whatever came of it; if another call has come and ended it; and in a capture if there was no
    /// replay since then, or since the last wait(). Bad input of one launch leaves another in flight, an Error
    /// (memory_limit or device) ends both. A stop that was requested before the call leaves this launch in flight.
    const typename Query::DeviceResult& wait(std::stop_token stop = {}) const;

    /// Copies the intersections of meshes that wait() has returned to the host. Valid as any result of the detector.
    /// Throws Error (invalid_argument) if another call, or a launch, has come after that wait().
    const Intersections& download() const requires std::same_as<Query, IntersectionQuery>;

   private:
    friend class Detector;
    LaunchTicket(Detector::Implementation& detector, std::uint64_t number) : detector_(&detector), number_(number) {}

    Detector::Implementation* detector_;
    std::uint64_t number_;
};

}  // namespace crumple
