#include "results/overlap_output.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

#include "base/memory_claim.h"
#include "results/overlap_arrays.h"

namespace crumple {
namespace {

std::array<double, 3> array_of(const Vec3d& v) { return {v.x, v.y, v.z}; }
std::array<double, 6> box_of(const OverlapExtent& e) {
    return {e.low.x, e.low.y, e.low.z, e.high.x, e.high.y, e.high.z};
}
void negate(double& x) { x = 0 - x; }
void negate(Vec3d& v) {
    for (int axis = 0; axis < 3; ++axis) negate(v[axis]);
}
/// Converts numbers to those of the same overlap with one body turned inside out.
void negate(OverlapNumbers& numbers) {
    negate(numbers.volume.value);
    negate(numbers.mean_depth);
    for (Vec3d* v : {&numbers.area_vector, &numbers.torque, &numbers.normal}) negate(*v);
}

}  // namespace

Overlaps metered_overlaps(MemoryMeter* meter) {
    Overlaps result;
    for_each_overlap_array([&](const char*, auto array, OverlapLevel) {
        result.*array = std::remove_cvref_t<decltype(result.*array)>(meter);
    });
    return result;
}

void swap_out(Overlaps& mine, Overlaps& theirs) {
    for_each_overlap_array([&](const char*, auto array, OverlapLevel) {
        (mine.*array).swap_elements(theirs.*array);
        (mine.*array).clear();
    });
    theirs.any = std::exchange(mine.any, false);
    theirs.count = std::exchange(mine.count, 0);
    theirs.part = std::exchange(mine.part, {});
    theirs.statistics = std::exchange(mine.statistics, {});
}

void clear(Overlaps& result) {
    for_each_overlap_array([&](const char*, auto array, OverlapLevel) { (result.*array).clear(); });
    result.any = false;
    result.count = 0;
    result.part = {};
    result.statistics = {};
}

std::size_t bytes_of(const OverlapRow& row) {
    std::size_t bytes =
        bytes_of(row.curves) + bytes_of(row.regions) + bytes_of(row.withdrawals) + bytes_of(row.first_free);
    for (std::size_t side = 0; side < 2; ++side)
        bytes += bytes_of(row.gradient[side]) + bytes_of(row.windings[side]) + bytes_of(row.depths[side]);
    for (const OverlapCurve& curve : row.curves) bytes += bytes_of(curve.points) + bytes_of(curve.triangles);
    return bytes;
}

void orient(int first, int second, OverlapRow& row) {
    for (VertexWinding& vertex : row.windings[0]) vertex.winding *= second;
    for (VertexWinding& vertex : row.windings[1]) vertex.winding *= first;
    if (first == second) return;
    negate(row.numbers);
    for (OverlapRegion& region : row.regions) negate(region.numbers);
    for (auto& vertices : row.gradient)
        for (VertexVector& vertex : vertices) negate(vertex.value);
    for (OverlapCurve& curve : row.curves) {
        negate(curve.area_vector);
        negate(curve.torque);
        std::reverse(curve.points.begin(), curve.points.end());
        std::reverse(curve.triangles.begin(), curve.triangles.end());
    }
}

void begin(const OverlapQuery& query, std::int32_t worlds, std::int32_t bodies, Overlaps& result) {
    clear(result);
    if (query.output != Output::any) result.world_hit.assign(static_cast<std::size_t>(worlds), 0);
    begin_rows(query, result);
    if (query.output != Output::pairs || !query.self_overlaps) return;
    result.body_volume.assign(static_cast<std::size_t>(bodies), std::numeric_limits<double>::quiet_NaN());
    result.is_solid.assign(static_cast<std::size_t>(bodies), 0);
}

void begin_rows(const OverlapQuery& query, Overlaps& result) {
    if (query.output != Output::pairs) return;
    if (query.gradient) result.gradient_offsets.push_back(0);
    if (query.windings) result.winding_offsets.push_back(0);
    if (query.depths) result.depth_offsets.push_back(0);
    if (query.curves) {
        result.curve_offsets.push_back(0);
        result.curve_point_offsets.push_back(0);
    }
    if (query.regions) result.region_offsets.push_back(0);
}

void add_body(std::int32_t body, const OverlapRow& row, Overlaps& result) {
    if (result.body_volume.empty()) return;
    result.body_volume[body] = row.body_volume;
    result.is_solid[body] = is_solid(row);
}

OverlapNumbers undefined_numbers(const Vec3d& point) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    OverlapNumbers numbers;
    numbers.volume.value = nan;
    numbers.centroid = numbers.area_vector = numbers.torque = numbers.normal = {nan, nan, nan};
    numbers.point = point;
    return numbers;
}

bool is_in_result(const OverlapQuery& query, const OverlapRow& row) {
    return row.exists && (query.min_volume == 0 || std::abs(row.numbers.volume.value) >= query.min_volume);
}

void add_skipped(std::vector<std::int32_t> bodies, Overlaps& result) {
    std::sort(bodies.begin(), bodies.end());
    bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
    for (const std::int32_t body : bodies) result.skipped.push_back(body);
}

namespace {

void add_depths(const BodyPair& bodies, const OverlapRow& row, Overlaps& result) {
    std::int64_t deepest = -1;
    for (std::size_t side = 0; side < 2; ++side)
        for (const VertexDepth& at : row.depths[side]) {
            const auto index = static_cast<std::int64_t>(result.depths.size());
            if (deepest < 0 || at.depth > result.depths[deepest]) deepest = index;
            result.depth_vertices.push_back({side == 0 ? bodies.first : bodies.second, at.vertex});
            result.depths.push_back(at.depth);
            result.depth_points.push_back(array_of(at.nearest));
            result.depth_triangles.push_back(at.triangle);
        }
    result.depth_offsets.push_back(static_cast<std::int64_t>(result.depths.size()));
    result.deepest.push_back(deepest);
}

void add_region(const OverlapRegion& region, Overlaps& result) {
    const OverlapNumbers& numbers = region.numbers;
    result.region_volume.push_back(numbers.volume.value);
    result.region_centroid.push_back(array_of(numbers.centroid));
    result.region_area_vector.push_back(array_of(numbers.area_vector));
    result.region_normal.push_back(array_of(numbers.normal));
    result.region_mean_depth.push_back(numbers.mean_depth);
    result.region_thickness.push_back(region.extent.thickness);
    result.region_box.push_back(box_of(region.extent));
    result.region_is_contact.push_back(numbers.volume.scaled.mantissa == 0);
    result.region_is_merged.push_back(region.merged);
    result.region_pieces.push_back(region.pieces);
}

}  // namespace

void add_row(const OverlapQuery& query, const BodyPair& bodies, std::int32_t world, const OverlapRow& row, bool solids,
             Overlaps& result) {
    result.any = true;
    if (query.output == Output::any) return;
    if (world >= 0 && !result.world_hit.empty()) result.world_hit[world] = 1;
    if (query.output == Output::any_by_world) return;
    result.bodies.push_back(bodies);
    result.relation.push_back(row.relation);
    if (query.output == Output::body_pairs) return;
    const OverlapNumbers& numbers = row.numbers;
    result.volume.push_back(numbers.volume.value);
    result.centroid.push_back(array_of(numbers.centroid));
    result.area_vector.push_back(array_of(numbers.area_vector));
    result.normal.push_back(array_of(numbers.normal));
    result.mean_depth.push_back(numbers.mean_depth);
    result.torque.push_back(array_of(numbers.torque));
    result.torque_point.push_back(array_of(numbers.point));
    result.contact_area.push_back(numbers.contact_area);
    const auto add_offset = [](auto& offsets, std::size_t end) { offsets.push_back(static_cast<std::int64_t>(end)); };
    for (std::size_t side = 0; side < 2; ++side) {
        const std::int32_t body = side == 0 ? bodies.first : bodies.second;
        for (const auto& [vertex, value] : row.gradient[side]) {
            result.gradient_vertices.push_back({body, vertex});
            result.gradient.push_back(array_of(value));
        }
        for (const auto& [vertex, winding] : row.windings[side]) {
            result.winding_vertices.push_back({body, vertex});
            result.windings.push_back(winding);
        }
    }
    if (query.gradient) add_offset(result.gradient_offsets, result.gradient.size());
    if (query.depths) add_depths(bodies, row, result);
    if (query.depth_tolerance > 0) {
        result.depth_reached.push_back(row.depth_bounds.lower);
        result.depth_bound.push_back(row.depth_bounds.upper);
    }
    if (query.windings) add_offset(result.winding_offsets, result.windings.size());
    const auto first_region = static_cast<std::int64_t>(result.region_volume.size());
    if (query.extents || query.regions) {
        result.box.push_back(box_of(row.extent));
        result.thickness.push_back(row.extent.thickness);
    }
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t j = 0; j < query.directions.size(); ++j) {
        result.withdrawals.push_back(row.withdrawals.empty() ? nan : row.withdrawals[j]);
        if (query.first_free) result.first_free.push_back(row.first_free.empty() ? nan : row.first_free[j]);
    }
    if (query.unions) {
        result.union_volume.push_back(row.unions.volume);
        result.intersection_over_union.push_back(row.unions.share);
        result.difference_volume.push_back(row.unions.difference);
    }
    if (query.translation) {
        result.translation_low.push_back(solids ? row.translation.low : nan);
        result.translation_high.push_back(row.translation.high);
        result.translation.push_back(array_of(row.translation.translation));
    }
    for (const OverlapRegion& region : row.regions) add_region(region, result);
    if (query.regions) add_offset(result.region_offsets, result.region_volume.size());
    if (!query.curves) return;
    for (const OverlapCurve& curve : row.curves) {
        if (query.regions) result.curve_regions.push_back(curve.region < 0 ? -1 : first_region + curve.region);
        result.curve_closed.push_back(curve.closed);
        result.curve_area_vector.push_back(array_of(curve.area_vector));
        result.curve_torque.push_back(array_of(curve.torque));
        for (const Vec3d& point : curve.points) result.curve_points.push_back(array_of(point));
        for (const Pair& pair : curve.triangles) result.curve_triangles.push_back(pair);
        result.curve_triangles.push_back({-1, -1});
        add_offset(result.curve_point_offsets, result.curve_points.size());
    }
    add_offset(result.curve_offsets, result.curve_closed.size());
}

}  // namespace crumple
