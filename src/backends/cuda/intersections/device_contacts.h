#pragma once

// Contacts of the pairs of an answer, correctly rounded, on the device as far as double words reach
// (exact/intersection/contact_on_line.h); planes in common, degenerate triangles and ties of rounding are for the
// host.

#include "backends/cuda/device/memory.h"
#include "backends/cuda/device/runtime.h"
#include "crumple/intersections.h"
#include "scene/prepared_scene.h"

namespace crumple::cuda {

using Point = std::array<double, 3>;

struct ContactArrays {
    ContactKind* kinds;           ///< by pair
    unsigned long long* offsets;  ///< pairs + 1; before: how many points each has
    Point* points;                ///< packed
    Point* loose;                 ///< six places a pair
    unsigned long long* open;     ///< pairs that the host has to look at
    unsigned long long* open_count;
    void* scan;
    std::size_t scan_bytes;

    void cut(Cutter& cutter, std::size_t pairs);
};

/// What double words can tell; lists the other pairs. `second` is added to each pair's b.
void find_contacts(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
                   std::size_t n, std::int32_t second, const ContactArrays& contacts);
/// Launches the same on no pairs, so that the driver gives it its stacks.
void reserve_contact_stack(const Geometry& geometry, cudaStream_t stream);
/// The open pairs themselves, in the list's order.
void list_open(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, const ContactArrays& contacts,
               std::size_t count, Pair* open);
/// Contact of the i-th open pair, from the host.
struct HostContact {
    ContactKind kind;
    int count;
    Point points[6];
};
void add_contacts(const Geometry& geometry, cudaStream_t stream, const HostContact* found, std::size_t count,
                  const ContactArrays& contacts);
/// Counts become offsets, and points move together.
void pack_contacts(const Geometry& geometry, cudaStream_t stream, std::size_t n, const ContactArrays& contacts);

}  // namespace crumple::cuda
