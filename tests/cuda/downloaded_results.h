#pragma once

// Comparison of intersections in device memory with those of the host.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "agreement/compare.h"
#include "cuda/device_mesh.h"

namespace crumple::test {

/// Compares all arrays of a result on the device with the expected result; `b` is null for one mesh.
inline testing::AssertionResult shows(const DeviceIntersections& found, const MeshView& a, const MeshView* b,
                                      const Intersections& expected) {
    const auto same = [](const auto& device, const auto& host, const char* what) {
        return std::equal(device.begin(), device.end(), host.begin(), host.end())
                   ? testing::AssertionSuccess()
                   : testing::AssertionFailure() << what << " differ";
    };
    if (!found.complete) return testing::AssertionFailure() << "the answer is not complete";
    const std::vector<Pair> pairs = to_host(found.pairs, found.count);
    testing::AssertionResult result = same_pairs(pairs, expected.pairs.span());
    if (result) result = same(to_host(found.offsets, a.triangles.rows + 1), expected.offsets, "offsets");
    if (result) result = same(to_host(found.hit, a.triangles.rows), expected.hit, "hit flags");
    if (result && b) result = same(to_host(found.hit_second, b->triangles.rows), expected.hit_second, "second flags");
    if (!result || expected.contacts.offsets.empty()) return result;
    result = same(to_host(found.contact_kinds, found.count), expected.contacts.kinds, "kinds");
    if (result)
        result = same(to_host(found.contact_offsets, found.count + 1), expected.contacts.offsets, "contact offsets");
    if (result)
        result = same(to_host(found.contact_points, found.contact_point_count), expected.contacts.points, "points");
    return result;
}

}  // namespace crumple::test
