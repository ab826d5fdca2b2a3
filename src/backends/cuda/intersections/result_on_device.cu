#include "backends/cuda/intersections/result_on_device.h"

#include <vector>

#include "backends/cuda/device/gather.h"
#include "exact/intersection/contact.h"

namespace crumple::cuda {
namespace {

std::int32_t second_of(const PreparedScene& scene) {
    return static_cast<std::int32_t>(scene.between ? scene.triangles[0] : 0);
}

}  // namespace

void ResultOnDevice::cut(ArenaLayout& c, const PreparedScene& scene, std::size_t pairs) {
    const auto first = static_cast<std::size_t>(scene.triangles[0]),
               second = static_cast<std::size_t>(scene.triangles[1]);
    output.offsets = c.take<unsigned long long>(first + 1);
    output.tiles = c.take<unsigned long long>(offset_tiles(first));
    output.next = c.take<unsigned long long>(first + 1);
    output.hit = c.take<std::uint8_t>(whole_words(first));
    output.hit_second = scene.between ? c.take<std::uint8_t>(whole_words(second)) : output.hit;
    output.capacity = pairs;
    output.pairs = c.take<Pair>(pairs);
    output.bucketed = c.take<BucketedPair>(pairs);
    output.part_capacity = part_capacity(pairs);
    output.parts = c.take<RowPart>(output.part_capacity);
    const auto worlds = static_cast<std::size_t>(names.any() ? names.worlds : 0);
    const std::size_t named = names.pairs ? pairs : 0;
    of_worlds_ = {c.take<BodyPair>(named), c.take<Pair>(named), c.take<std::int64_t>(names.any() ? worlds + 1 : 0),
                  c.take<std::int64_t>(worlds), c.take<std::uint8_t>(worlds)};
}

std::size_t ResultOnDevice::bytes(const PreparedScene& scene, std::size_t pairs, bool contacts) {
    MemoryMeter none;
    ArenaLayout cutter;
    ResultOnDevice(Geometry{}, nullptr, none).cut(cutter, scene, pairs);
    if (contacts) {
        ContactArrays().cut(cutter, pairs);
        cutter.take<Pair>(pairs);
        cutter.take<HostContact>(pairs);
        Gathered::cut(cutter, pairs);
    }
    return cutter.used();
}

void ResultOnDevice::clear(BatchedClear& batch, const PreparedScene& scene) const {
    const auto first = static_cast<std::size_t>(scene.triangles[0]);
    batch.add(output.offsets, (first + 1) * sizeof *output.offsets);
    batch.add(output.tiles, offset_tiles(first) * sizeof *output.tiles);
    clear_flags(batch, scene, output);
}

void ResultOnDevice::write(const PreparedScene& scene, const List<Hit>& hits, Counters* counters, Counters* told) {
    const auto firsts = static_cast<std::size_t>(scene.triangles[0]);
    make_offsets(geometry_, stream_, firsts, output, counters);
    fill_buckets(geometry_, stream_, scene, hits, output);
    order_buckets(geometry_, stream_, firsts, output, counters, told);
    if (names.any()) name_pairs(geometry_, stream_, firsts, output, names, of_worlds_);
}

std::int64_t ResultOnDevice::make_contacts(const PreparedScene& scene, Cancellation& cancellation) {
    const auto n = static_cast<std::size_t>(total);
    place_arrays(contact_block_, [&](ArenaLayout& c) { contacts_.cut(c, n); });
    find_contacts(geometry_, stream_, scene, output.pairs, n, second_of(scene), contacts_);
    unsigned long long open = 0;
    copy_now(stream_, &open, contacts_.open_count, 1, cudaMemcpyDeviceToHost);
    if (open > 0) decide_open(scene, static_cast<std::size_t>(open), second_of(scene), cancellation);
    pack_contacts(geometry_, stream_, n, contacts_);
    copy_now(stream_, &points_, contacts_.offsets + n, 1, cudaMemcpyDeviceToHost);
    return static_cast<std::int64_t>(open);
}

// Computes the contacts that only the host can round.
void ResultOnDevice::decide_open(const PreparedScene& scene, std::size_t n, std::int32_t second,
                                 Cancellation& cancellation) {
    Block block(meter_);
    Pair* pairs = nullptr;
    HostContact* found = nullptr;
    place_arrays(block, [&](ArenaLayout& c) {
        pairs = c.take<Pair>(n);
        found = c.take<HostContact>(n);
    });
    list_open(geometry_, stream_, output.pairs, contacts_, n, pairs);
    std::vector<HostContact> host(n);
    Gathered gathered(geometry_, stream_, scene, meter_);
    gathered.each(pairs, n, second, [&](std::size_t i, const Triangle& a, const Triangle& b) {
        cancellation.check();
        const Contact c = contact(a, b);
        host[i].kind = c.kind();
        host[i].count = c.count;
        for (std::size_t k = 0; k < static_cast<std::size_t>(c.count); ++k)
            host[i].points[k] = {c.points[k].x, c.points[k].y, c.points[k].z};
    });
    copy_now(stream_, found, host.data(), n, cudaMemcpyHostToDevice);
    add_contacts(geometry_, stream_, found, n, contacts_);
    CRUMPLE_CUDA(cudaStreamSynchronize(stream_));
}

DeviceIntersections ResultOnDevice::show(const PreparedScene& scene, bool contacts) const {
    DeviceIntersections shown;
    shown.any = total > 0;
    shown.pairs_needed = shown.count = static_cast<std::int64_t>(total);
    shown.of_worlds = names.any();
    if (shown.of_worlds) {
        shown.worlds = names.worlds;
        shown.world_hit = of_worlds_.hit;
        shown.world_counts = of_worlds_.counts;
        shown.world_offsets = of_worlds_.offsets;
        shown.bodies = names.pairs ? of_worlds_.bodies : nullptr;
        shown.pairs = names.pairs ? of_worlds_.pairs : nullptr;
    } else {
        shown.pairs = output.pairs;
        shown.offsets = reinterpret_cast<const std::int64_t*>(output.offsets);
        shown.hit = output.hit;
        shown.hit_second = scene.between ? output.hit_second : nullptr;
        shown.hit_count = scene.triangles[0];
        shown.hit_second_count = scene.triangles[1];
    }
    if (contacts) {
        shown.contact_kinds = contacts_.kinds;
        shown.contact_offsets = reinterpret_cast<const std::int64_t*>(contacts_.offsets);
        shown.contact_points = contacts_.points;
        shown.contact_point_count = static_cast<std::int64_t>(points_);
    }
    return shown;
}

void ResultOnDevice::copy_to(const PreparedScene& scene, bool contacts, Intersections& result) {
    const auto copy = [&](auto& array, const auto* device, std::size_t n) {
        using T = std::remove_reference_t<decltype(array[0])>;
        copy_now(stream_, array.resize_discard(n), reinterpret_cast<const T*>(device), n, cudaMemcpyDeviceToHost);
    };
    const auto pairs = static_cast<std::size_t>(total), first = static_cast<std::size_t>(scene.triangles[0]);
    copy(result.pairs, output.pairs, pairs);
    copy(result.offsets, output.offsets, first + 1);
    copy(result.hit, output.hit, first);
    copy(result.hit_second, output.hit_second, static_cast<std::size_t>(scene.triangles[1]));
    result.contacts.kinds.clear();
    result.contacts.offsets.clear();
    result.contacts.points.clear();
    if (!contacts) return;
    copy(result.contacts.kinds, contacts_.kinds, pairs);
    copy(result.contacts.offsets, contacts_.offsets, pairs + 1);
    copy(result.contacts.points, contacts_.points, static_cast<std::size_t>(points_));
}

}  // namespace crumple::cuda
