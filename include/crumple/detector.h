#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string_view>
#include <utility>
#include <vector>

#include "crumple/candidates.h"
#include "crumple/clustering.h"
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
/// Queries that can be made about one part of a scene (Detector::partition).
template <class Query>
concept PartQuery = OneOf<Query, IntersectionQuery, ImpactQuery, ProximityQuery, OverlapQuery>;
/// Queries that Detector::any takes.
template <class Query>
concept FlagQuery = PartQuery<Query>;
/// Queries whose results can be left on a device (Detector::launch).
template <class Query>
concept LaunchQuery = OneOf<Query, IntersectionQuery, ImpactQuery, ProximityQuery, CandidateQuery>;
/// Queries whose rows can be delivered in blocks (Detector::stream).
template <class Query>
concept BlockQuery = LaunchQuery<Query> || OneOf<Query, OverlapQuery>;
/// Queries that Detector::find takes: all.
template <class Query>
concept AnyQuery = BlockQuery<Query> || OneOf<Query, DistanceQuery, FirstImpactQuery, FreeStepQuery>;

template <LaunchQuery Query>
class LaunchTicket;

/// Searches scenes, exactly and completely. The type of the query selects what is searched for and the type of the
/// result: IntersectionQuery (the default), ImpactQuery, FirstImpactQuery, FreeStepQuery, ProximityQuery,
/// CandidateQuery, DistanceQuery, OverlapQuery. A detector caches buffers and cluster centres between calls, so one
/// detector for all frames of a simulation is faster than a new one per frame. The topology may change from frame to
/// frame.
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
    /// Worlds: in searches for intersections, a body whose shape has a name (Shape::name) and whose box overlaps no
    /// other body's box costs one box test; for Output::any, any_by_world and body_pairs, the search between two such
    /// bodies stops at the first hit. A world of one body with Body::self has the same rows as the body's mesh. The
    /// cuda backend uploads posed bodies in each call and searches many worlds at once; if the poses are in device
    /// memory (World::device_poses), the bodies stay cached on the device and only the poses are read anew. For queries
    /// about features (vertices, edges and faces: impacts, first impacts, free steps, proximities and candidates), the
    /// arrays of a world other than its poses must be in host memory. For all queries but intersections, two meshes are
    /// handled as a world of two bodies.
    ///
    /// Meshes in device memory: all arrays, including those of the query, must be in the memory of the mesh. For
    /// queries about features, triangles and codimensional edges and points (MeshView::edges and MeshView::points) are
    /// downloaded once, and again whenever they change. All arrays are downloaded in each call that uses `weld`,
    /// triangle pairs, a free step, closest points, least distances, or a filter of groups together with codimensional
    /// edges or points.
    ///
    /// Parts: returns those rows of the whole scene's result that the part owns, in the same order; exactly one part
    /// owns each row. Rows have the indices of the whole meshes. Costs as much as a mesh of the part's size. Offsets,
    /// hit flags and least distances are indexed by position in the part's lists: offsets[i] belongs to triangle
    /// part.mesh.ids[i]. `first` and `any` are those of the part; edges and points are empty, as the part has its own
    /// (PartFeatures). A part that did not come from partition() is validated; an Error then counts vertices and
    /// triangles within the part. For an OverlapQuery, the result has the pairs of triangles that the part owns instead
    /// of rows (Overlaps::part_pairs), whatever the output; combine() makes the rows from the results of all parts.
    ///
    /// Throws Error (invalid_argument) if supports() is false for the scene and the query.
    template <AnyQuery Query = IntersectionQuery>
    const typename Query::Result& find(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// True if find() takes queries of this type about this scene. The result depends on the kind of scene, its memory,
    /// and the backend (table in docs/supported.md), and on no option of the query but IntersectionQuery::containment.
    /// Reads no arrays and does not check sizes.
    template <AnyQuery Query = IntersectionQuery>
    bool supports(const Scene& scene, const Query& query = {}) const;

    /// True if find() would find anything. Stops at the first pair found; the cuda backend finds many at a time.
    /// Ignores Query::output. If the result for an ImpactQuery is false, the step is free. Throws Error
    /// (invalid_argument) for an OverlapQuery about a part, as a part alone does not determine which bodies overlap.
    template <FlagQuery Query = IntersectionQuery>
    bool any(const Scene& scene, const Query& query = {}, std::stop_token stop = {});

    /// Calls `take(block)` with one block of the result after another, for results that exceed memory, and returns the
    /// statistics of the call. A block is valid until `take` returns. Only the cpu and the reference backend support
    /// this call; for an OverlapQuery all backends do. The scene must be in host memory and must not be a part.
    ///
    /// A block has `block_rows` (1 to 2^40) rows, counted over all its lists; the last block may have fewer. Rows have
    /// their bodies, and their contacts if these are requested. For one or two meshes and an IntersectionQuery, `count`
    /// is the number of rows of the block; otherwise it is the number of rows delivered so far, those of this block
    /// included. Edges and points are those of the whole result. Everything else is empty: offsets, flags, first
    /// impact. All blocks together have the rows of the whole result. Worlds are in order, but the rows of a world come
    /// leaf by leaf (a leaf is a small cluster of triangles that is searched as a unit), not sorted by feature or
    /// triangle. This order does not depend on threads; like the leaves, it depends on the memory limit and on earlier
    /// calls.
    ///
    /// For an OverlapQuery a row is a pair of bodies, and rows come in the order of the whole result. A block has the
    /// lists of its rows (curves, regions, ...), whose offsets begin at 0, and `skipped`, `body_volume` and `is_solid`
    /// of the whole result; if there is no row but one of these lists, a block without rows is delivered. Such a call
    /// searches a large world piece by piece, and computes overlaps of bodies with themselves twice if they have a row.
    ///
    /// Memory: that of find() without its lists, plus about three blocks. Under a memory limit the search runs on one
    /// thread. Cost: that of find(); for queries about features of several worlds, each world's scene is prepared
    /// twice. Any thread of the detector may call `take`, one at a time. `take` must not call this detector; an
    /// exception that it throws ends the call, and so does a stop; some blocks may have been delivered by then. Throws
    /// Error (invalid_argument) for options that blocks do not support: `triangle_pairs`, `least`, `index` of queries
    /// about features, and less output than pairs (of overlaps: than body_pairs).
    template <BlockQuery Query = IntersectionQuery>
    Statistics stream(const Scene& scene, const Query& query,
                      FunctionRef<void(const typename Query::Result& block)> take,
                      std::int64_t block_rows = std::int64_t{1} << 18, std::stop_token stop = {});

    /// Cuts a scene of one mesh, or of two for intersections and overlaps, into `count` (1 to 262,144) parts for
    /// queries of this type: intersections, impacts, proximities or overlaps. The parts depend on the arguments only,
    /// so machines that have the same meshes make the same parts. A part for impacts or proximities contains the
    /// query's radii and rest shape; it can be searched only with the same `weld` and `rings`, and with distances up to
    /// those of this query. It takes about twice as much memory as a part for intersections, and does not support
    /// triangle pairs. Parts for intersections and for overlaps are the same, and the members of the query do not
    /// matter.
    ///
    /// For intersections and overlaps, meshes in device memory are downloaded first; for impacts and proximities,
    /// meshes must be in host memory. Cost: up to 64 distances for each triangle and level (PartLevel), on all threads
    /// of the cpu backend, and the copies of the triangles. Parts, and the memory to make them, are not counted by the
    /// memory limit. A stop has no effect after the meshes have been read.
    template <PartQuery Query = IntersectionQuery>
    std::vector<Part> partition(const Scene& scene, const Query& query, int count, std::stop_token stop = {});

    /// Returns the clusters and leaves into which the next find() would divide this scene for an IntersectionQuery, and
    /// the frames in which it would sweep the leaves. Does not change the detector: the next call starts from the same
    /// cluster centres as without this call.
    ///
    /// For one mesh or two in host memory, with the cpu backend; throws Error (invalid_argument) for other scenes and
    /// backends. A search under a memory limit that it exceeds uses other clusters than those returned. Cost: the
    /// stages `bounds` and `subdivide` of find(), and the arrays. Their memory is not counted by the memory limit.
    Clustering cluster(const Scene& scene, std::stop_token stop = {});

    /// Finds the overlaps of a mesh with itself, or of two meshes, from the results of find() for all parts of the same
    /// meshes, in any order: the same bytes as find(scene, query). `parts`: one result for each part of one partition,
    /// found with the same `self_overlaps`; other members of the query may differ. Only the search for triangles that
    /// intersect is shared by the parts. This call computes the rest: winding numbers, sums and rows, and needs the
    /// whole meshes.
    ///
    ///     std::vector<Overlaps> found;
    ///     for (const Part& part : detector.partition(scene, OverlapQuery(), 8)) {
    ///         detector.find(part, query);
    ///         found.push_back(detector.take_result<Overlaps>());
    ///     }
    ///     const Overlaps& overlaps = detector.combine(scene, query, found);
    ///
    /// `parts` must not contain the detector's own result; take it out first (take_result). Throws Error
    /// (invalid_argument) if a part is missing or occurs twice, if a result has triangles that the meshes lack or the
    /// pair of another result, or for a world. Results of other meshes with at least as many triangles are not
    /// recognised. Cost: that of find() without the search, and O(pairs) to join the pairs.
    const Overlaps& combine(const Scene& scene, const OverlapQuery& query, std::span<const Overlaps> parts,
                            std::stop_token stop = {});

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

    /// Sets a function that each later call of the detector calls about every 20 ms, in the thread that made the call;
    /// calls that take less time do not call it. An exception from `poll` ends the call and is rethrown; the detector
    /// stays usable. `poll` must not call this detector. Meant for bindings to languages that must handle signals in
    /// the calling thread. An empty function stops polling.
    void set_poll(std::function<void()> poll);

    /// Starts a query on arrays in device memory and returns at once; wait() of the ticket returns the result:
    ///
    ///     auto launched = detector.launch(mesh.moving_to(end), ImpactQuery());
    ///     const DeviceImpacts& impacts = launched.wait();
    ///
    /// Supports intersections of meshes and of worlds with World::device_poses, and impacts, proximities and candidates
    /// of one mesh; with the cuda backend only. Runs on the stream of the (first) mesh or of the poses; all arrays,
    /// including those of the query, must be ready on that stream. A launch with arrays of the same sizes as the
    /// previous one runs as a single CUDA graph, after which the host reads one struct of counters. Arrays must stay
    /// unchanged until the corresponding wait() returns, shapes and bodies of a world until launch() returns.
    ///
    /// At most two launches of any kind may be in flight, on one stream or two; wait for them in their order. A third
    /// throws Error (invalid_argument) and leaves them in flight. Launches share scratch lists on the device, so the
    /// device runs one after the other. Any other call of the detector that uses the device, except those of tickets,
    /// first completes the launches in flight and discards their results.
    ///
    /// On a stream that is being captured, the query becomes part of the caller's graph, and each replay repeats the
    /// query on the current contents of the arrays. First make two calls outside of the capture, with the same query
    /// and with meshes of the same sizes, or the same bodies: they allocate the lists. Without them launch() throws
    /// Error (invalid_argument), and the capture goes on. Lists cannot grow in a replay; wait() then reports an
    /// incomplete result. The graph may be replayed until the next call of the detector (except those of the ticket),
    /// which may move or free memory that the graph uses; no call may be made during a replay. A capture can hold only
    /// one launch of each detector. The streams of two meshes must take part in the same capture.
    ///
    /// Queries about features: a launch waits for the stream if it is the first for a mesh, or if the number of
    /// vertices, triangles, codimensional edges or points has changed, because the host then has to download the
    /// triangles and find the edges. If triangles, or codimensional edges or points, have changed in content but not in
    /// number, wait() downloads them and repeats the search; after a launch in a capture, where the features are fixed,
    /// the result is incomplete instead. Throws Error (invalid_argument) for the options for which find() downloads all
    /// arrays in each call. Ignores `index`.
    ///
    /// Worlds: each call compares bodies, shapes and the filter with those of the previous call (a named shape by its
    /// name and groups, an unnamed one by its contents), and uploads them if they have changed. A call that uploads
    /// takes as long as a first one; any other call is one CUDA graph. All worlds are one scene: at most 65,535 worlds
    /// with two or more triangles, and if there are several, at most 2^24 triangles in total, where bodies that are in
    /// all worlds count in each. Throws Error (invalid_argument) if there are more (find() has no such limit), for
    /// Output::body_pairs, and for `index`. Cost: that of a mesh with the triangles of all worlds, whatever the output;
    /// the host compares bodies in some nanoseconds each.
    template <LaunchQuery Query = IntersectionQuery>
    LaunchTicket<Query> launch(const Scene& scene, const Query& query = {});

    /// Returns the options that the detector was made with.
    const Options& options() const;

    /// Returns the backend in use: Options::backend, or the choice of Backend::automatic.
    Backend backend() const;

    /// Returns the reason, in one line, why Backend::automatic chose the cpu backend although this build has the cuda
    /// backend; else an empty string. Valid while the detector lives.
    std::string_view fallback() const;

   private:
    template <LaunchQuery Query>
    friend class LaunchTicket;
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

/// Ticket of a launch (Detector::launch): a value that is cheap to copy. Its functions are calls of the detector, which
/// must be alive; the detector may have been moved in the meantime.
template <LaunchQuery Query>
class CRUMPLE_API LaunchTicket {
   public:
    /// Waits for the launch and returns its complete result, in device memory. Throws Error on bad input, with a
    /// message that names the body. If a list was too short, grows it and runs the query again. Decides on the host
    /// what the device cannot decide, such as cases that need rational arithmetic. The result is valid until the second
    /// launch after this one, or the detector's next call that is neither a launch nor one of a ticket. (If memory, or
    /// Options::memory_limit, cannot hold two results: until the next launch or wait().) Throws Error (memory_limit or
    /// device) if memory cannot hold all worlds at once.
    ///
    /// After a launch in a capture: returns the result of the last replay, whose stream the caller has synchronized;
    /// valid until the next replay. If a list was too short, does not run the query again, and sets `complete` of the
    /// result to false; a call outside of a capture then grows the lists, for a new capture. May be called again after
    /// each replay, also after bad input.
    ///
    /// Throws Error (invalid_argument), and leaves launches in flight, if an older launch is in flight; if this launch
    /// has been waited for before, successfully or not; if another call has ended it; and in a capture if there was no
    /// replay since the capture or the last wait(). If wait() throws because of bad input of its launch, the other
    /// launch stays in flight; an Error (memory_limit or device) ends both. A stop that was requested before the call
    /// leaves this launch in flight.
    const typename Query::DeviceResult& wait(std::stop_token stop = {}) const;

    /// Downloads the intersections of meshes that the last wait() has returned. The result is valid as long as one of
    /// Detector::find. Throws Error (invalid_argument) if there was another call or launch since that wait().
    const Intersections& download() const requires std::same_as<Query, IntersectionQuery>;

   private:
    friend class Detector;
    LaunchTicket(Detector::Implementation& detector, std::uint64_t number) : detector_(&detector), number_(number) {}

    Detector::Implementation* detector_;
    std::uint64_t number_;
};

}  // namespace crumple
