#pragma once

#include <gtest/gtest.h>

#include "agreement/compare.h"

namespace crumple::test {

/// Compares all arrays byte for byte. A failure names the array that differs.
inline testing::AssertionResult same_nearest(const Distances& found, const Distances& expected) {
    testing::AssertionResult same = same_bytes(found.bodies, expected.bodies, "bodies");
    if (same) same = same_bytes(found.touching, expected.touching, "flags");
    if (same) same = same_bytes(found.squared_distance, expected.squared_distance, "squared distances");
    if (same) same = same_bytes(found.triangles, expected.triangles, "triangles");
    if (same) same = same_bytes(found.points, expected.points, "points");
    if (same) same = same_bytes(found.world_rows, expected.world_rows, "rows of worlds");
    return same;
}

}  // namespace crumple::test
