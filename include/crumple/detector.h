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

/// True if `Query` is one of the types `Of`.
template <class Query, class... Of>
concept OneOf = (std::same_as<Query, Of> || ...);
/// Queries whose result has one row per pair, and that search parts (Detector::partition).
template <class Query>
concept PairQuery = OneOf<Query, IntersectionQuery, ImpactQuery, ProximityQuery>;
/// Queries that Detector::any takes.
template <class Query>
concept FlagQuery = PairQuery<Query> || OneOf<Query, OverlapQuery>;
/// Queries whose rows can be delivered in blocks (Detector::stream) or left on a device (Detector::launch).
template <class Query>
concept RowQuery = PairQuery<Query> || OneOf<Query, CandidateQuery>;
/// Queries that Detector::find takes: all.
template <class Query>
concept AnyQuery = RowQuery<Query> || OneOf<Query, DistanceQuery, OverlapQuery, FirstImpactQuery, FreeStepQuery>;

template <RowQuery Query>
class LaunchTicket;

/// Searches scenes, exactly and completely. The type of the query selects what is searched for and the type of the
/// result: IntersectionQuery (the default), ImpactQuery, FirstImpactQuery, FreeStepQuery, ProximityQuery,
/// CandidateQuery, DistanceQuery, OverlapQuery. A detector caches buffers and cluster centres between calls, so one
/// detector for all frames of a simulation is faster than a new one per frame; the topology may change freely.
///
/// A detector is used by one thread at a time; different detectors may work at the same time. Results are references to
/// data of the detector, valid until its next call, move or destruction. Every call throws crumple::Error on bad input,
/// with a message that names mesh, body or shape, and leaves the detector usable. A query that the scene or the backend
/// does not support throws Error (invalid_argument).
///
/// With a std::stop_token, a call ends soon after any thread requests a stop: it throws Error (cancelled) within some
/// milliseconds, or returns its result if that was nearly complete. A stop that was requested before the call ends it
/// at once.
class CRUMPLE_API Detector {
   public:
    /// Makes the backend and starts its threads. Throws Error: invalid_argument for an invalid option,
    /// backend_unavailable if a backend is requested by name and is not available.
    explicit Detector(const Options& options = {});
    ~Detector();
    Detector(Detector&&) noexcept;
    Detector& operator=(Detector&&) noexcept;

    /// Finds everything that the query describes.
    ///
    /// Worlds: a body whose shape is named costs next to nothing while it is clear of others, and for Output::any,
    /// any_by_world and body_pairs the search of such bodies stops at the first hit where possible. One body with
    /// Body::self has the rows of its mesh. The cuda backend uploads posed bodies in each call and searches many worlds
    /// at once; if the poses are in device memory (World::device_poses), the bodies stay cached on the device and only
    /// the poses are read anew. For queries about features, arrays of a world must be in host memory, except for poses.
    /// For all queries but intersections, two meshes are handled as a world of two bodies.
    ///
    /// Meshes in device memory: all arrays, including those of the query, must be in the memory of the mesh. For
    /// queries about features, triangles and codimensional edges and points are downloaded once, and again whenever
    /// they change. All arrays are downloaded in each call with `weld`, triangle pairs, a free step, closest points,
    /// least distances, or a filter of groups together with codimensional edges or points.
    ///
    /// Parts: returns the rows of the whole result that the part owns, with the ids of the meshes, in the same order;
    /// exactly one part owns each row. Costs as much as a mesh of the part's size. Offsets, hit flags and least
    /// distances are indexed by position in the part's lists: offsets[i] belongs to triangle part.mesh.ids[i]. `first`
    /// and `any` are those of the part; edges and points are empty, as the part has its own (PartFeatures). A part that
    /// did not come from partition() is validated; an Error then counts vertices and triangles within the part.
    ///
    /// Throws Error (invalid_argument) where supports() is false.
    template <AnyQuery Query = IntersectionQuery>
    const typename Query::Result& find(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// True if find() takes queries of this type about this scene: depends on the kind of scene, its memory, and the
    /// backend (table in docs/supported.md). Of the query's options only IntersectionQuery::containment matters. Reads
    /// no arrays and does not check sizes.
    template <AnyQuery Query = IntersectionQuery>
    bool supports(const Scene& scene, const Query& query = {}) const;

    /// True if find() would find anything. Stops at the first pair found; the cuda backend finds many at a time.
    /// Ignores Query::output. A step without an impact is free.
    template <FlagQuery Query = IntersectionQuery>
    bool any(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// Calls `take(block)` with one block of the result after another, for results that exceed memory, and returns the
    /// statistics of the call. A block is valid until `take` returns. For intersections, impacts, proximities and
    /// candidates, with the cpu and the reference backend, of scenes in host memory that are not parts.
    ///
    /// A block has `block_rows` (1 to 2^40) rows of all its lists together (the last block fewer), with their bodies,
    /// and contacts if these are requested. For worlds and features, `count` is the number of rows up to and including
    /// this block. Edges and points are those of the whole result. Everything else is empty: offsets, flags, first
    /// impact. All blocks together have the rows of the whole result, world by world, but leaf by leaf within a world.
    /// This order does not depend on threads; like the leaves, it depends on the memory limit and on earlier calls.
    ///
    /// Memory: that of find() without its lists, plus about three blocks; a memory limit means one thread. Cost: that
    /// of find(); for features of several worlds, each world's scene is prepared twice. Any thread of the detector may
    /// call `take`, one at a time. `take` must not call this detector; an exception that it throws ends the call, as a
    /// stop does, after some blocks have been delivered. Throws Error (invalid_argument) for options that blocks do not
    /// support: `index`, `triangle_pairs`, `least`, and less output than pairs.
    template <RowQuery Query = IntersectionQuery>
    Statistics stream(const Scene& scene, const Query& query,
                      FunctionRef<void(const typename Query::Result& block)> take,
                      std::int64_t block_rows = std::int64_t{1} << 18, std::stop_token stop = {});

    /// Cuts a scene of one mesh, or of two for intersections, into `count` (1 to 262,144) parts for queries of this
    /// type: intersections, impacts or proximities. Depends on the arguments only, so machines that have the same
    /// meshes make the same parts. Parts for queries about features are limited to the distance, the radii, the rest
    /// shape, the rings and the welding of this query; they are about twice as large, and do not support triangle
    /// pairs. For intersections the members of the query do not matter.
    ///
    /// For intersections, meshes in device memory are downloaded first; for features meshes must be in host memory.
    /// Cost: O(triangles times 64) per level, on all threads of the cpu backend, and the copies. The memory limit does
    /// not count parts and the memory to make them. A stop is ignored once the meshes have been read.
    template <PairQuery Query = IntersectionQuery>
    std::vector<Part> partition(const Scene& scene, const Query& query, int count, std::stop_token stop = {});

    /// Swaps the last result of this type with `other`. Afterwards `other` outlives the detector's next call and the
    /// detector, and the memory limit no longer counts it. The detector's result is empty; it reuses the old storage of
    /// `other` for the next result, unless there is a memory limit. Swaps pointers; copies nothing.
    template <class Result>
    void swap_result(Result& other);
    /// Returns the result by value; pass an old one to reuse its storage.
    template <class Result>
    Result take_result(Result spare = {}) {
        swap_result(spare);
        return spare;
    }

    /// Calls `poll` about every 20 ms during a call, in the thread that made the call; not in shorter calls. An
    /// exception from `poll` ends the call and is rethrown; the detector stays usable. `poll` must not call this
    /// detector. For languages that must handle signals in the calling thread. An empty function stops polling.
    void set_poll(std::function<void()> poll);

    /// Starts a query on arrays in device memory and returns at once; wait() of the ticket returns the result:
    ///
    ///     auto launched = detector.launch(mesh.moving_to(end), ImpactQuery());
    ///     const DeviceImpacts& impacts = launched.wait();
    ///
    /// Takes intersections of meshes and of worlds with World::device_poses, and impacts, proximities and candidates of
    /// one mesh. Only with the cuda backend. Runs on the stream of the (first) mesh or of the poses; all arrays,
    /// including those of the query, must be ready on that stream. Consecutive frames of the same sizes run as one CUDA
    /// graph each, after which the host reads one struct of counters. Arrays must stay unchanged until the
    /// corresponding wait() returns, shapes and bodies of a world until launch() returns.
    ///
    /// At most two launches of any kind may be in flight, on one stream or two; wait for them in their order. A third
    /// throws Error (invalid_argument) and leaves them in flight. Launches share lists on the device, so they run one
    /// after the other. Any other call of the detector, except those of tickets, first completes the launches in flight
    /// and discards their results.
    ///
    /// On a stream that is being captured, the query becomes part of the caller's graph, and each replay repeats the
    /// query on the current contents of the arrays. First make two calls outside of the capture, with the same query
    /// and with meshes of the same sizes, or the same bodies: they allocate the lists. Without them launch() throws
    /// Error (invalid_argument), and the capture goes on. Lists cannot grow in a replay; wait() then reports an
    /// incomplete result. The graph may be replayed until the next call of the detector (except those of the ticket),
    /// which may move or free memory that the graph uses; no call may be made during a replay. One launch per capture
    /// and detector; the streams of two meshes both take part.
    ///
    /// Features: a launch waits for the stream if it is the first for a mesh, or if the number of vertices, triangles,
    /// codimensional edges or points has changed, because the host has to find the edges. wait() does so if it turns
    /// out that triangles or lists have changed; in a capture, where the features are fixed, the result is then
    /// incomplete. Throws Error (invalid_argument) for options for which find() downloads all arrays. `index` does not
    /// matter.
    ///
    /// Worlds: bodies, shapes and the filter are read and uploaded if they have changed since the previous call (a
    /// named shape is compared by its name and groups, another by its contents in each call). Such a call takes as long
    /// as a first one; other calls are one CUDA graph. All worlds are one scene: at most 65,535 worlds with two or more
    /// triangles, and if there are several, at most 2^24 triangles in total, where bodies that are in all worlds count
    /// in each. Throws Error (invalid_argument) for more, which find() takes; for Output::body_pairs and for `index`.
    /// Cost: that of a mesh with the triangles of all worlds, whatever the output; the host compares bodies in some
    /// nanoseconds each.
    template <RowQuery Query = IntersectionQuery>
    LaunchTicket<Query> launch(const Scene& scene, const Query& query = {});

    /// Returns the options that the detector was made with.
    const Options& options() const;

    /// Returns the backend in use: Options::backend, or the choice of Backend::automatic.
    Backend backend() const;

    /// Returns the reason, in one line, why Backend::automatic chose the cpu backend although this build has the cuda
    /// backend; else an empty string. Valid while the detector lives.
    std::string_view fallback() const;

   private:
    template <RowQuery Query>
    friend class LaunchTicket;
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Ticket of a launch (Detector::launch): a value that is cheap to copy. Its functions are calls of the detector, which
/// must be alive; the detector may have been moved in the meantime.
template <RowQuery Query>
class CRUMPLE_API LaunchTicket {
   public:
    /// Waits for the launch and returns its complete result, in device memory. Throws Error on bad input, with a
    /// message that names the body. If a list was too short, grows it and runs the query again. Also does steps that
    /// only the host can do. The result is valid until the second launch after this one, or the detector's next call
    /// that is neither a launch nor one of a ticket. (If memory, or Options::memory_limit, cannot hold two results:
    /// until the next launch or wait().) Throws Error (memory_limit or device) if memory cannot hold all worlds at
    /// once.
    ///
    /// After a launch in a capture: returns the result of the last replay, whose stream the caller has synchronized;
    /// valid until the next replay. Does not rerun an overflowed query (see `complete`): a call outside of a capture
    /// grows the lists, for a new capture. May be called again after each replay, also after bad input.
    ///
    /// Throws Error (invalid_argument), and leaves launches in flight, if an older launch is in flight; if this launch
    /// has been waited for before, successfully or not; if another call has ended it; and in a capture if there was no
    /// replay since the capture or the last wait(). Bad input of one launch leaves the other in flight; an Error
    /// (memory_limit or device) ends both. A stop that was requested before the call leaves this launch in flight.
    const typename Query::DeviceResult& wait(std::stop_token stop = {}) const;

    /// Downloads the intersections of meshes that wait() has returned. The result is valid as long as one of
    /// Detector::find. Throws Error (invalid_argument) if there was another call or launch since that wait().
    const Intersections& download() const requires std::same_as<Query, IntersectionQuery>;

   private:
    friend class Detector;
    LaunchTicket(Detector::Implementation& detector, std::uint64_t number) : detector_(&detector), number_(number) {}

    Detector::Implementation* detector_;
    std::uint64_t number_;
};

}  // namespace crumple
