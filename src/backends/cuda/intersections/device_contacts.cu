#include "backends/cuda/intersections/device_contacts.h"

#include <cub/device/device_scan.cuh>

#include "exact/intersection/contact_on_line.h"

namespace crumple::cuda {
namespace {

__global__ void contact_kernel(PreparedScene scene, const Pair* pairs, std::size_t n, std::int32_t second,
                               ContactArrays out) {
    const std::size_t warps_end = (n + 31) / 32 * 32;
    for (std::size_t i = grid_thread(); i < warps_end; i += grid_stride()) {
        bool open = false;
        if (i < n) {
            Contact contact;
            open = !contact_on_line(scene.triangle(pairs[i].a), scene.triangle(pairs[i].b + second), NothingExact{},
                                    contact);
            if (open) contact.count = 0;
            out.kinds[i] = contact.kind();
            out.offsets[i] = static_cast<unsigned long long>(contact.count);
            for (int k = 0; k < contact.count; ++k) {
                const Vec3d& p = contact.points[static_cast<std::size_t>(k)];
                out.loose[6 * i + static_cast<std::size_t>(k)] = {p.x, p.y, p.z};
            }
        }
        const unsigned long long place = append(open, out.open_count);
        if (open) out.open[place] = i;
    }
}

__global__ void open_kernel(const Pair* pairs, ContactArrays contacts, std::size_t n, Pair* open) {
    for (std::size_t i = grid_thread(); i < n; i += grid_stride()) open[i] = pairs[contacts.open[i]];
}

__global__ void add_kernel(const HostContact* found, std::size_t n, ContactArrays out) {
    for (std::size_t i = grid_thread(); i < n; i += grid_stride()) {
        const unsigned long long pair = out.open[i];
        out.kinds[pair] = found[i].kind;
        out.offsets[pair] = static_cast<unsigned long long>(found[i].count);
        for (int k = 0; k < found[i].count; ++k) out.loose[6 * pair + static_cast<unsigned>(k)] = found[i].points[k];
    }
}

__global__ void pack_kernel(std::size_t n, ContactArrays out) {
    for (std::size_t i = grid_thread(); i < n; i += grid_stride()) {
        const unsigned long long begin = out.offsets[i], count = out.offsets[i + 1] - begin;
        for (unsigned long long k = 0; k < count; ++k) out.points[begin + k] = out.loose[6 * i + k];
    }
}

}  // namespace

void ContactArrays::cut(ArenaLayout& c, std::size_t pairs) {
    kinds = c.take<ContactKind>(pairs);
    offsets = c.take<unsigned long long>(pairs + 1);
    points = c.take<Point>(6 * pairs);
    loose = c.take<Point>(6 * pairs);
    open = c.take<unsigned long long>(pairs);
    open_count = c.take<unsigned long long>(1);
    CRUMPLE_CUDA(cub::DeviceScan::ExclusiveSum(nullptr, scan_bytes, offsets, offsets, pairs + 1));
    scan = c.take<std::byte>(scan_bytes);
}

void find_contacts(const Geometry& geometry, cudaStream_t stream, const PreparedScene& scene, const Pair* pairs,
                   std::size_t n, std::int32_t second, const ContactArrays& contacts) {
    fill(stream, contacts.open_count, 0, sizeof *contacts.open_count);
    fill(stream, contacts.offsets + n, 0, sizeof *contacts.offsets);
    Launch{stream, geometry.blocks(n), geometry.threads}(contact_kernel, scene, pairs, n, second, contacts);
}

void reserve_contact_stack(const Geometry& geometry, cudaStream_t stream) {
    Launch{stream, 1, geometry.threads}(contact_kernel, PreparedScene{}, static_cast<const Pair*>(nullptr),
                                        std::size_t{0}, std::int32_t{0}, ContactArrays{});
}

void list_open(const Geometry& geometry, cudaStream_t stream, const Pair* pairs, const ContactArrays& contacts,
               std::size_t count, Pair* open) {
    Launch{stream, geometry.blocks(count), geometry.threads}(open_kernel, pairs, contacts, count, open);
}

void add_contacts(const Geometry& geometry, cudaStream_t stream, const HostContact* found, std::size_t count,
                  const ContactArrays& contacts) {
    Launch{stream, geometry.blocks(count), geometry.threads}(add_kernel, found, count, contacts);
}

void pack_contacts(const Geometry& geometry, cudaStream_t stream, std::size_t n, const ContactArrays& contacts) {
    std::size_t bytes = contacts.scan_bytes;
    CRUMPLE_CUDA(
        cub::DeviceScan::ExclusiveSum(contacts.scan, bytes, contacts.offsets, contacts.offsets, n + 1, stream));
    Launch{stream, geometry.blocks(n), geometry.threads}(pack_kernel, n, contacts);
}

}  // namespace crumple::cuda
