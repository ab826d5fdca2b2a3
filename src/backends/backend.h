#pragma once

// Interface of a backend. The detector checks the input, prepares the scene, and sends requests to the backend.

#include <memory>
#include <span>
#include <vector>

#include "backends/device_feature_calls.h"
#include "backends/overlap_device.h"
#include "backends/overlap_kernels.h"
#include "base/cancellation.h"
#include "base/parallel_for.h"
#include "crumple/array.h"
#include "crumple/detector.h"
#include "crumple/function_ref.h"
#include "crumple/intersections.h"
#include "crumple/options.h"
#include "queries/feature_request.h"
#include "queries/row_stream.h"
#include "scene/prepared_scene.h"

namespace crumple {

/// Per-scene cache, for callers that cycle through several scenes.
struct SceneMemory {
    virtual ~SceneMemory() = default;
};

/// Base class of all backends. Searches find only pairs that the pair filter keeps: the query's filter or, for a scene
/// made of a world, the world's filter (PreparedScene::bodies). A backend with threads overrides parallel_for() to
/// provide them. All calls check the Cancellation that the backend was made with.
class BackendBase : public ParallelFor {
   public:
    /// Fills `result.pairs` (sorted, unique), offsets, hit flags, contacts if requested, and the statistics' counts and
    /// stage times. `part`: the part that the scene is made of, whose levels decide which pairs it owns; null: the
    /// scene owns all. Throws MemoryMeter::Exceeded, with a lower bound on the bytes needed, if even a search in chunks
    /// does not fit the limit.
    virtual void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                      Intersections& result) = 0;

    /// Fills `result` as find() does for an IntersectionQuery without options, but may also include pairs that need
    /// exact arithmetic, for callers that decide pairs themselves.
    virtual void find_possible(const PreparedScene& scene, Intersections& result) {
        find(scene, IntersectionQuery(), nullptr, result);
    }

    /// True for the reference, which tests compare other backends with. Searches then pass whole scenes to the backend,
    /// without leaving out beforehand what is too far from everything else.
    virtual bool by_brute_force() const { return false; }

    /// Returns true if there is any pair. Stops at the first one, or soon after it.
    virtual bool any(const PreparedScene& scene, const IntersectionQuery& query) = 0;

    /// Returns the maximum number of worlds side by side in one scene (PreparedScene::worlds) for find(), any() and
    /// any_by_world(). For a scene of several worlds, these calls do not search in chunks: they throw
    /// MemoryMeter::Exceeded if memory does not suffice.
    virtual int worlds_at_once() const { return 1; }

    /// Sets the flag of each world that has a pair; all flags are 0 before. Overrides for several worlds fill in the
    /// statistics, this one for a single world does not.
    virtual void any_by_world(const PreparedScene& scene, const IntersectionQuery& query, std::span<std::uint8_t> flags,
                              Statistics&) {
        flags[0] = any(scene, query);
    }

    /// Delivers all pairs, numbered as by `find`, to a stream (Detector::stream). If the call throws, some pairs may
    /// have been delivered.
    virtual void stream(const PreparedScene& scene, const IntersectionQuery& query, PairStream& to,
                        Statistics& statistics);

    /// Passes all pairs, in any order, to `take`, in one array or in several. Calls of `take` may come from any thread,
    /// but never two at a time.
    virtual void visit(const PreparedScene& scene, const IntersectionQuery& query,
                       FunctionRef<void(const Array<Pair>& some)> take, Statistics& statistics);

    /// Finds pairs of features of a scene of one mesh. Fills rows, counts and stage times.
    virtual void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) = 0;

    /// Delivers the rows that find() fills in for the same request, to a stream.
    virtual void stream(const PreparedScene& scene, const FeatureRequest& request, FeatureStream& to,
                        Statistics& statistics);

    /// Calls for meshes in device memory; `b` is null for a single mesh. The backend validates these meshes itself. All
    /// backends but cuda throw Error (invalid_argument).
    virtual void find(const MeshView& a, const MeshView* b, const IntersectionQuery& query, Intersections& result);
    virtual bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
    virtual std::vector<Part> partition(const MeshView& a, const MeshView* b, int count);
    /// Implement Detector::launch, LaunchTicket::wait and LaunchTicket::download. wait() serves launches of worlds,
    /// too.
    virtual LaunchNumber launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
    virtual const DeviceIntersections& wait(LaunchNumber launch);
    virtual void download(LaunchNumber launch, Intersections& result);
    /// Returns the calls for feature queries on meshes in device memory.
    virtual DeviceFeatureCalls& device_feature_calls();
    /// Calls for worlds whose poses lie in device memory. find() returns false if one scene cannot hold all worlds, and
    /// throws MemoryMeter::Exceeded if memory does not suffice. In both cases the caller downloads the poses by
    /// poses_of() and searches the world with poses on the host.
    virtual bool find(const World& world, const IntersectionQuery& query, Intersections& result);
    virtual std::vector<Pose> poses_of(const DevicePoses& poses);
    virtual LaunchNumber launch(const World& world, const IntersectionQuery& query);
    /// True if cached data must outlive an error that a launch or a wait has thrown, because a caller's graph or a
    /// launch in flight needs it.
    virtual bool keeps_after(const Error&) const { return false; }

    /// Divides the scene as find() would for an IntersectionQuery (Detector::cluster). All backends but cpu throw Error
    /// (invalid_argument).
    virtual Clustering cluster(const PreparedScene& scene);

    /// True if a search since the last call of this function may have lost pairs (Method::membership).
    virtual bool may_have_lost_pairs() { return false; }

    /// Returns the kernels for sums over overlaps, or null if the backend has none.
    virtual const OverlapKernels* overlap_kernels() const { return nullptr; }

    /// Returns the device for overlaps, or null if the backend has none.
    virtual OverlapDevice* overlap_device() { return nullptr; }

    /// Swaps the cache of the previous call's scene with `memory`, which holds that of another scene or is null.
    virtual void swap_memory(std::unique_ptr<SceneMemory>&) {}

    /// Frees everything that is cached between calls: memory, and the cluster centres from which the next call would
    /// start.
    virtual void release() = 0;
};

std::unique_ptr<BackendBase> make_reference_backend(const Options& options, MemoryMeter& meter,
                                                    Cancellation& cancellation);
/// Returns true if this build has the cuda backend, not only its stand-in.
bool has_cuda_backend();
std::unique_ptr<BackendBase> make_cuda_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation);
/// Makes a backend that divides the work among the cuda devices of Options::devices, of which there must be at least
/// one.
std::unique_ptr<BackendBase> make_devices_backend(const Options& options, MemoryMeter& meter,
                                                  Cancellation& cancellation);
std::unique_ptr<BackendBase> make_cpu_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation);

}  // namespace crumple
