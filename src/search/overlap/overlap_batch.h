#pragma once

// Rows of an overlap query whose pairs of triangles a device decides together (backends/overlap_device.h), and the
// input of each row: surfaces, pairs of triangles, origin.
//
//   rows --pose each body once--> surfaces, pairs --device--> crossings of each pair, sums of each row

#include <memory>
#include <span>
#include <vector>

#include "backends/overlap_device.h"
#include "base/memory_claim.h"
#include "crumple/overlaps.h"
#include "search/containment/closed_bodies.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

/// Returns the middle of the intersection of two boxes: sums relative to it have the least cancellation.
Vec3d middle_of(const Bounds& a, const Bounds& b);

/// Returns all pairs of triangles of one surface that have a common point, in both orders: the pairs in `found`, and
/// all pairs of adjacent triangles, since `found` lacks those that meet only in their common vertices or edge.
std::vector<Pair> pairs_within(const ClosedSurface& surface, std::span<const Pair> found);

class OverlapBatch {
   public:
    /// Pair of bodies, with the pairs of their triangles that were found.
    struct Row {
        BodyPair bodies;
        std::span<const Pair> pairs;
    };

    OverlapBatch(const ClosedBodies& bodies, MemoryMeter& meter) : bodies_(bodies), memory_(meter) {}

    /// Lets the device decide the rows' pairs. Returns false if they are too few to be worthwhile, or if memory does
    /// not suffice. `numbers`: false if only volumes are needed.
    bool cross(OverlapDevice& device, std::span<const Row> rows, bool numbers, ParallelFor& workers);

    /// Returns null if the device did not decide the row's pairs.
    const CrossedRow* row(std::size_t i) const { return of_row_[i] < 0 ? nullptr : &rows_[index(of_row_[i])]; }
    const PlacedSurface& surface(std::int32_t on_device) const { return surfaces_[index(on_device)]->placed; }
    std::span<const Pair> pairs(const CrossedRow& row) const {
        return std::span(pairs_).subspan(row.begin, row.end - row.begin);
    }
    RowOnDevice on_device(const CrossedRow& row) const;

   private:
    struct Surface {
        Array<Vec3d> points;
        PlacedSurface placed;
    };
    static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

    void list_bodies(std::span<const Row> rows);
    void place(ParallelFor& workers);
    void list_pairs(std::span<const Row> rows);

    const ClosedBodies& bodies_;
    MemoryClaim memory_;  ///< memory of the pairs and of their crossings
    OverlapDevice* device_ = nullptr;
    std::vector<std::int32_t> numbers_;               ///< bodies of rows with pairs, ascending
    std::vector<std::unique_ptr<Surface>> surfaces_;  ///< by index in numbers_
    std::vector<std::int32_t> of_row_;                ///< index in rows_, or −1
    std::vector<CrossedRow> rows_;
    std::vector<Pair> pairs_;
    BatchCrossings crossings_;
};

}  // namespace crumple
