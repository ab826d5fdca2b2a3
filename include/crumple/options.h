#pragma once

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

/// Configuration of a Detector. No option changes a result, only its cost.
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
