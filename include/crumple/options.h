#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "crumple/executor.h"

namespace crumple {

/// Backend that runs the queries. `automatic` chooses cuda if it was built and a device is available
/// (Detector::fallback() has the reason if not), else cpu. If a backend is requested by name and is not available, the
/// constructor throws Error (backend_unavailable).
enum class Backend : std::uint8_t { automatic, reference, cpu, cuda };

/// Instruction sets for the cpu backend. `automatic` chooses the best that the machine supports.
enum class Simd : std::uint8_t { automatic, scalar, sse4, avx2, avx512, neon };

/// Parameters of fuzzy C-means, which places the centres of clusters; only researchers should need to change them. [MZ]
/// is D. Mainzer and G. Zachmann, Collision Detection Based on Fuzzy Scene Subdivision; see its sec. 4.
struct FuzzyCMeans {
    double fuzziness = 2.0;    ///< t of [MZ] eq. 2, above 1
    int max_iterations = 2;    ///< most iterations of a call that is warm-started from the previous centres
    int first_iterations = 5;  ///< most iterations of a first frame, which has no centres to start from
    /// Iteration stops when no centre moves further than this in any coordinate, in units of the scene's extent rounded
    /// up to a power of two.
    double stop = 1e-2;
    double first_stop = 1e-4;  ///< as `stop`, for a first frame

    friend bool operator==(const FuzzyCMeans&, const FuzzyCMeans&) = default;
};

/// Direction along which leaves are swept: the first principal component of the members' centroids ([MZ] sec. 3), a
/// coordinate axis, or Method::direction.
enum class SweepDirection : std::uint8_t { pca, x, y, z, given };

/// Rule by which triangles join clusters and leaves (docs/subdivide.md). Each triangle joins the cluster whose centre
/// is nearest to its centroid. It also joins another cluster if:
enum class Membership : std::uint8_t {
    /// The ball around its centroid that contains the triangle reaches the plane that bisects the two clusters'
    /// centres. Loses no pair.
    ball,
    /// Its centroid is at most R / 2 from that plane, where R is the largest radius of all balls: the overlap of two
    /// clusters is then as wide as [MZ] eq. 5 demands at least. May lose pairs.
    equation_5,
    /// Its membership u in the cluster ([MZ] eq. 3) is at least Method::threshold. May lose pairs.
    threshold
};

/// Steps of the method that researchers may vary. Only the cpu backend has variants: the reference has no clusters and
/// ignores them, and the cuda backend refuses them.
struct Method {
    SweepDirection sweep = SweepDirection::pca;  ///< changes no result
    std::array<double, 3> direction = {};        ///< for SweepDirection::given: finite, not 0, of any length
    /// Rules other than `ball` may lose pairs. The detector compares each triangle's clusters with those of `ball`, and
    /// sets Statistics::complete to false if one is missing. Supported by find() and stream() for queries about
    /// intersections (without containment), impacts, proximities and candidates; queries whose result has no
    /// statistics, and overlaps, are refused. Public parts (Detector::partition) always use `ball`; so do ranks, which
    /// refuse others.
    Membership membership = Membership::ball;
    double threshold = 0;  ///< for Membership::threshold: 0 (all clusters) to 1 (only the nearest)

    friend bool operator==(const Method&, const Method&) = default;
};

/// Configuration of a Detector. No option changes a result, only its cost, except Method::membership.
struct Options {
    Backend backend = Backend::automatic;
    /// Threads of the cpu backend, at most 1024, started when the detector is made; 0: as many as the machine has. With
    /// the cuda backend, threads for what the host computes (docs/cuda.md), started when they are first needed.
    /// Threads beyond oneTBB's limit for the process (tbb::global_control) are not used.
    int threads = 0;

    /// Bytes that the detector may own, including buffers cached between calls and the result, but not the caller's
    /// arrays; 0: no limit. A search that exceeds the limit is repeated in chunks on one thread. If the arrays of one
    /// chunk, or the result, do not fit even then, the call throws ErrorCode::memory_limit with a lower bound on a
    /// sufficient limit, as soon as this is certain: at the latest when the pairs counted so far would fill the limit.
    std::int64_t memory_limit = 0;

    /// Clusters of the first level of subdivision, 1 to 64 (the cuda backend makes at most 63 for two meshes); 0:
    /// chosen from the number of triangles.
    int clusters = 0;
    int leaf_size = 3000;  ///< target number of triangles per leaf: larger clusters are divided once more, if that pays
    FuzzyCMeans fuzzy_c_means = {};
    Method method = {};
    Simd simd = Simd::automatic;
    int device = 0;  ///< CUDA device: its number in list_devices()
    /// Replaces `device`, which must then be 0: up to 64 different devices that share the work of queries about one
    /// mesh in host memory (intersections, motion and nearness). The first device alone handles two meshes, worlds,
    /// device memory, blocks, parts, codimensional edges and points (MeshView::edges, MeshView::points), radii, rings,
    /// rest shapes, feature queries with `weld`, candidates, and all queries under a memory limit.
    std::vector<int> devices = {};

    /// Returns the device that holds the detector's arrays.
    int first_device() const { return devices.empty() ? device : devices.front(); }

    /// Thread pool of the cpu backend, which then ignores `threads`. Null: the backend has `threads` threads of oneTBB.
    std::shared_ptr<Executor> executor = {};
};

}  // namespace crumple
