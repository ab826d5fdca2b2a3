#pragma once

// World whose poses are in device memory, as a simulation on a device has them, and comparison of world results in
// device memory with host results.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "agreement/compare.h"
#include "cuda/device_mesh.h"
#include "worlds/random_worlds.h"

namespace crumple::test {

/// World whose poses are copied to the device; bodies and shapes stay on the host.
class DeviceWorld {
   public:
    /// `float32`: poses are stored as float32; the host's poses should then be representable so.
    explicit DeviceWorld(const World& host, bool float32 = false)
        : world_(host), float32_(float32), numbers_(bytes(host.poses)) {
        const auto count = static_cast<std::int64_t>(host.poses.size());
        world_.poses = {};
        world_.device_poses = float32 ? DevicePoses(static_cast<const float*>(numbers_.data()), count)
                                      : DevicePoses(static_cast<const Pose*>(numbers_.data()), count);
    }
    World view(cudaStream_t stream = nullptr) const {
        World world = world_;
        world.device_poses.stream = stream;
        return world;
    }
    /// Replaces the poses.
    void set_poses(std::span<const Pose> poses) { numbers_.set(bytes(poses)); }

   private:
    std::vector<std::byte> bytes(std::span<const Pose> poses) const {
        if (!float32_) {
            std::vector<std::byte> out(poses.size_bytes());
            if (!out.empty()) std::memcpy(out.data(), poses.data(), out.size());
            return out;
        }
        std::vector<float> rounded;
        for (const Pose& pose : poses)
            for (const double x : pose.rows) rounded.push_back(static_cast<float>(x));
        std::vector<std::byte> out(rounded.size() * sizeof(float));
        if (!out.empty()) std::memcpy(out.data(), rounded.data(), out.size());
        return out;
    }

    World world_;
    bool float32_;
    DeviceBytes numbers_;
};

/// Compares all arrays of a world result on the device with the expected result.
inline testing::AssertionResult shows_world(const DeviceIntersections& found, const Intersections& expected) {
    const auto same = [](const auto& device, const auto& host, const char* what) {
        return std::equal(device.begin(), device.end(), host.begin(), host.end())
                   ? testing::AssertionSuccess()
                   : testing::AssertionFailure() << what << " differ";
    };
    if (!found.complete) return testing::AssertionFailure() << "the answer is not complete";
    if (found.any != expected.any || found.count != expected.count || found.pairs_needed != expected.count)
        return testing::AssertionFailure() << found.count << " pairs instead of " << expected.count;
    const auto worlds = static_cast<std::int64_t>(expected.world_counts.size());
    if (found.worlds != worlds) return testing::AssertionFailure() << found.worlds << " instead of " << worlds;
    testing::AssertionResult result = same(to_host(found.world_hit, worlds), expected.world_hit, "flags of worlds");
    if (result) result = same(to_host(found.world_counts, worlds), expected.world_counts, "counts of worlds");
    std::vector<std::int64_t> offsets(1, 0);
    for (const std::int64_t count : expected.world_counts) offsets.push_back(offsets.back() + count);
    if (result) result = same(to_host(found.world_offsets, worlds + 1), offsets, "offsets of worlds");
    if (!found.pairs) return result;
    if (result) result = same(to_host(found.bodies, found.count), expected.bodies, "bodies");
    if (result) result = same(to_host(found.pairs, found.count), expected.pairs, "pairs");
    if (!result || !found.contact_kinds) return result;
    result = same(to_host(found.contact_kinds, found.count), expected.contacts.kinds, "kinds");
    if (result)
        result = same(to_host(found.contact_offsets, found.count + 1), expected.contacts.offsets, "contact offsets");
    if (result)
        result = same(to_host(found.contact_points, found.contact_point_count), expected.contacts.points, "points");
    return result;
}

}  // namespace crumple::test
