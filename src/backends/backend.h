#pragma once

// The seam that a backend fills in. The detector checks the input, prepares the scene, and asks.

#include <memory>
#include <span>
#include <vector>

#include "backends/device_feature_calls.h"
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

/// What a backend remembers of one scene, for who asks about several in turn, over and over.
struct SceneMemory {
    virtual ~SceneMemory() = default;
};

/// Pairs are wanted by the query's rules, or by those of the world that the scene is made of (PreparedScene::bodies).
/// A backend with threads lends them by overriding parallel_for(). Its calls check the cancellation they are given.
class BackendBase : public ParallelFor {
   public:
    /// Fills `result.pairs` (sorted, unique), offsets, hit flags, contacts if asked for, and the statistics' counts and
    /// stage times. `part`: what the scene is made of, so that its levels tell which pairs it owns; null: all. Throws
    /// MemoryMeter::Exceeded if not even work in chunks fits the limit, with what is needed at least.
    virtual void find(const PreparedScene& scene, const IntersectionQuery& query, const Part* part,
                      Intersections& result) = 0;

    /// True if this backend is what others are compared with: searches leave nothing out for it.
    virtual bool by_brute_force() const { return false; }

    /// Whether there is any pair. Stops at the first, or soon after it.
    virtual bool any(const PreparedScene& scene, const IntersectionQuery& query) = 0;

    /// How many worlds a scene may have side by side (PreparedScene::worlds) in find(), any() and any_by_world(). Those
    /// do not work in chunks if there are several: they throw MemoryMeter::Exceeded where memory does not suffice.
    virtual int worlds_at_once() const { return 1; }

    /// Sets the flag of each world in which there is a pair; the others are 0 and stay so. Whoever takes several worlds
    /// counts what it did.
    virtual void any_by_world(const PreparedScene& scene, const IntersectionQuery& query, std::span<std::uint8_t> flags,
                              Statistics&) {
        flags[0] = any(scene, query);
    }

    /// Gives all pairs, as `find` names them, to a stream (Detector::stream). A call that throws may have given some.
    virtual void stream(const PreparedScene& scene, const IntersectionQuery& query, PairStream& to,
                        Statistics& statistics);

    /// All pairs, in any order, some at a time from any thread, or all at once: for work that goes on with them.
    virtual void visit(const PreparedScene& scene, const IntersectionQuery& query,
                       FunctionRef<void(const Array<Pair>& some)> take, Statistics& statistics);

    /// Pairs of features of a scene of one mesh. Fills rows, counts and stage times.
    virtual void find(const PreparedScene& scene, const FeatureRequest& request, FeatureResult& result) = 0;

    /// The same, as a stream.
    virtual void stream(const PreparedScene& scene, const FeatureRequest& request, FeatureStream& to,
                        Statistics& statistics);

    /// The same for meshes in device memory (b null: one), which the backend checks itself. Only cuda can.
    virtual void find(const MeshView& a, const MeshView* b, const IntersectionQuery& query, Intersections& result);
    virtual bool any(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
    virtual std::vector<Part> partition(const MeshView& a, const MeshView* b, int count);
    /// Detector::launch, and wait and download of its ticket; of worlds, too.
    virtual LaunchNumber launch(const MeshView& a, const MeshView* b, const IntersectionQuery& query);
    virtual const DeviceIntersections& wait(LaunchNumber launch);
    virtual void download(LaunchNumber launch, Intersections& result);
    /// The same for questions about features.
    virtual DeviceFeatureCalls& features_there();
    /// The same for worlds whose poses lie in device memory. find: false if it cannot take all worlds at once; it
    /// throws MemoryMeter::Exceeded if memory does not hold them. Then the host asks about what poses_of() gives.
    virtual bool find(const World& world, const IntersectionQuery& question, Intersections& result);
    virtual std::vector<Pose> poses_of(const DevicePoses& poses);
    virtual LaunchNumber launch(const World& world, const IntersectionQuery& question);
    /// Whether what is kept between calls outlives the error that one of these has thrown: a caller's graph needs it.
    virtual bool keeps_after(const Error&) const { return false; }

    /// Kernels for sums over overlaps, or null: then these are made without.
    virtual const OverlapKernels* overlap_kernels() const { return nullptr; }

    /// Exchanges what is remembered of the scene of the call before for what `memory` holds of another, or null.
    virtual void swap_memory(std::unique_ptr<SceneMemory>&) {}

    /// Drops what is kept between calls, memory and centres alike.
    virtual void release() = 0;
};

std::unique_ptr<BackendBase> make_reference_backend(const Options& options, MemoryMeter& meter,
                                                    Cancellation& cancellation);
/// Whether this build has more of the cuda backend than what stands in for it.
bool has_cuda_backend();
std::unique_ptr<BackendBase> make_cuda_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation);
/// One on each of Options::devices, of which there is one at least.
std::unique_ptr<BackendBase> make_devices_backend(const Options& options, MemoryMeter& meter,
                                                  Cancellation& cancellation);
std::unique_ptr<BackendBase> make_cpu_backend(const Options& options, MemoryMeter& meter, Cancellation& cancellation);

}  // namespace crumple
