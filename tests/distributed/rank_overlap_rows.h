#pragma once

// Comparison of a rank's overlaps with those of a single detector.

#include <gtest/gtest.h>

#include <algorithm>

#include "distributed/rank_meshes.h"
#include "distributed/rank_worlds.h"
#include "overlaps/closed_bodies.h"
#include "results/overlap_output.h"
#include "results/overlap_rows.h"

namespace crumple::test {

/// Returns what a rank must find of a whole result: rows whose first body is one of the rank's, and lists of its
/// bodies.
inline Overlaps rows_of_piece(const Overlaps& whole, const WorldPiece& piece) {
    Overlaps rows;
    for_each_overlap_array([&](const char*, auto array, OverlapLevel level) {
        if (level == OverlapLevel::offsets && !(whole.*array).empty()) (rows.*array).push_back({});
    });
    for (std::size_t i = 0; i < whole.bodies.size(); ++i)
        if (piece.has(whole.bodies[i].first)) append_rows(whole, i, i + 1, rows);
    for_each_overlap_array([&](const char* name, auto array, OverlapLevel level) {
        if (level != OverlapLevel::rows) return;
        EXPECT_EQ((rows.*array).size() * whole.bodies.size(), (whole.*array).size() * rows.bodies.size()) << name;
    });
    for (const std::int32_t body : whole.skipped)
        if (piece.has(body)) rows.skipped.push_back(body);
    for (const std::int64_t body : piece.ids) {
        if (whole.body_volume.empty()) break;
        rows.body_volume.push_back(whole.body_volume[body]);
        rows.is_solid.push_back(whole.is_solid[body]);
    }
    rows.any = !rows.bodies.empty();
    rows.count = static_cast<std::int64_t>(rows.bodies.size());
    return rows;
}

inline testing::AssertionResult overlaps_are(const DistributedOverlaps& found, const WorldPiece& piece,
                                             const Overlaps& whole) {
    if (found.any != whole.any || found.count != whole.count)
        return testing::AssertionFailure() << "any " << found.any << ", count " << found.count << " instead of "
                                           << whole.any << ", " << whole.count;
    const std::string different = difference(found.rows, rows_of_piece(whole, piece));
    return different.empty() ? testing::AssertionSuccess() : testing::AssertionFailure() << "other " << different;
}

/// Returns a mesh of several random closed pieces, which may meet.
inline Soup<double> pieces(unsigned seed, int count, bool grid) {
    Dice dice(seed);
    Soup<double> soup;
    for (int i = 0; i < count; ++i)
        dice.chance(0.5) ? add_box(dice, grid, 2, soup) : add_tetrahedron(dice, grid, 3, soup);
    return soup;
}

/// Compares a rank's result with what it must be: the rank that provided triangle 0 has the whole result.
inline testing::AssertionResult is_overlap_of_mesh(const DistributedOverlaps& found, const MeshPiece& piece,
                                                   const OverlapQuery& query, Overlaps whole) {
    if (found.any != whole.any || found.count != whole.count)
        return testing::AssertionFailure() << "any " << found.any << ", count " << found.count << " instead of "
                                           << whole.any << ", " << whole.count;
    Overlaps expected;
    if (std::find(piece.triangle_ids.begin(), piece.triangle_ids.end(), 0) != piece.triangle_ids.end()) {
        expected = whole;
        expected.world_hit.clear();
        expected.any = !expected.bodies.empty();
    } else {
        begin_rows(query, expected);
    }
    const std::string different = difference(found.rows, expected);
    return different.empty() ? testing::AssertionSuccess() : testing::AssertionFailure() << "other " << different;
}

}  // namespace crumple::test
