#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "crumple/executor.h"

namespace crumple {

/// Who does the work. `automatic` takes cuda if it was built and a device is there (Detector::fallback() tells why
/// not), else cpu. A backend that is asked for by name and is not there is an Error (backend_unavailable).
enum class Backend : std::uint8_t { automatic, reference, cpu, cuda };

/// Instruction sets that the cpu backend can run on. `automatic` takes the best that the machine has.
enum class Simd : std::uint8_t { automatic, scalar, sse4, avx2, avx512, neon };

/// How fuzzy C-means ([MZ] sec. 4) places the centres of clusters: for researchers.
struct FuzzyCMeans {
    double fuzziness = 2.0;    ///< t of [MZ] eq. 2, above 1
    int max_iterations = 2;    ///< cap on iterations, warm-started from the centres of the call before
    int first_iterations = 5;  ///< the same for a first frame, which has no centres to start from
    /// Iteration ends when no centre moves further than this in any coordinate, in units of the scene's extent rounded
    /// up to a power of two.
    double stop = 1e-2;
    double first_stop = 1e-4;  ///< the same for a first frame

    friend bool operator==(const FuzzyCMeans&, const FuzzyCMeans&) = default;
};

/// How a Detector works. None of these changes an answer, only its cost.
struct Options {
    Backend backend = Backend::automatic;
    /// 0: as many as the machine has; more than oneTBB allows in the process (tbb::global_control) are not used. The
    /// cpu backend starts them when the detector is made.
    int threads = 0;

    /// Bytes that the detector may own, buffers kept between calls and the result included; the caller's arrays are
    /// not counted. 0: no limit. Work that exceeds it is cut into chunks, on one thread; if records or result cannot
    /// fit even so, the call throws ErrorCode::memory_limit with a lower bound on the limit that suffices, as soon as
    /// that is certain: at the latest when as many pairs were counted as the limit has room for.
    std::int64_t memory_limit = 0;

    /// Parts of the first level of subdivision, 1 to 64 (the cuda backend makes at most 63 between two meshes); 0:
    /// chosen from the triangle count.
    int clusters = 0;
    int leaf_size = 3000;  ///< triangles that a leaf should have; larger clusters are subdivided again
    FuzzyCMeans fuzzy_c_means = {};
    Simd simd = Simd::automatic;
    int device = 0;  ///< of the cuda backend: its number among those of list_devices()
    /// Instead of `device`: several, each once, which share the work. They share questions about one mesh in host
    /// memory, about intersections, motion and nearness; the first does alone what is of two meshes, of worlds, in
    /// device memory, in blocks or in parts, of listed edges and points, radii, rings or a shape at rest, welded by
    /// position where features are asked about, candidates, and all under a memory limit.
    std::vector<int> devices = {};

    /// The device whose memory the detector's arrays there are in.
    int first_device() const { return devices.empty() ? device : devices.front(); }

    /// Whose threads the cpu backend works on, in place of `threads` of its own; null: oneTBB's.
    std::shared_ptr<Executor> executor = {};
};

}  // namespace crumple
