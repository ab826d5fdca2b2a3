#pragma once

// Correctly rounded contacts of the pairs of a result. The device computes those for which double words suffice
// (exact/intersection/contact_on_line.h); the host computes those of coplanar and degenerate triangles, and ties of
// rounding.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/runtime.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

using Point = std::array<double, 3>;

struct ContactArrays {
    ContactKind* kinds;           ///< by pair
    unsigned long long* offsets;  ///< pairs + 1; before pack_contacts(): number of points of each pair
    Point* points;                ///< points of all pairs, one after another, after pack_contacts()
    Point* loose;                 ///< points of each pair, in 6 places per pair, until pack_contacts()
    unsigned long long* open;     ///< indices of pairs that are left to the host
    unsigned long long* open_count;
    void* scan;  ///< scratch of CUB for prefix sums
    std::size_t scan_bytes;

    void cut(ArenaLayout& cutter, std::size_t pairs);
};

/// Computes the contacts for which double words suffice; lists the other pairs as open. `second` is added to each
/// pair's b: the number of the first mesh's triangles if b counts from the second mesh's first triangle, else 0.
void find_contacts(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
                   std::size_t n, std::int32_t second, const ContactArrays& contacts);
/// Launches the kernel of find_contacts() on no pairs, so that the driver reserves its stacks.
void reserve_contact_stack(const Geometry& geometry, cudaStream_t stream);
/// Copies the open pairs to `open`, in the order of ContactArrays::open.
void list_open(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, const ContactArrays& contacts,
               std::size_t count, Pair* open);
/// Contact of an open pair, computed by the host.
struct HostContact {
    ContactKind kind;
    int count;
    Point points[6];
};
/// Writes the contacts of the open pairs, in the same order.
void add_contacts(const Geometry& geometry, cudaStream_t stream, const HostContact* found, std::size_t count,
                  const ContactArrays& contacts);
/// Turns counts into offsets, and packs the points.
void pack_contacts(const Geometry& geometry, cudaStream_t stream, std::size_t n, const ContactArrays& contacts);

}  // namespace crumple::cuda
