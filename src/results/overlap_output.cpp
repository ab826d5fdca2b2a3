#include "results/overlap_output.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/memory_claim.h"

namespace crumple {
namespace {

template <class Act>
void for_each_array(Overlaps& mine, Overlaps& theirs, Act act) {
    act(mine.world_hit, theirs.world_hit);
    act(mine.skipped, theirs.skipped);
    act(mine.bodies, theirs.bodies);
    act(mine.relation, theirs.relation);
    act(mine.volume, theirs.volume);
    act(mine.centroid, theirs.centroid);
    act(mine.area_vector, theirs.area_vector);
    act(mine.normal, theirs.normal);
    act(mine.mean_depth, theirs.mean_depth);
    act(mine.torque, theirs.torque);
    act(mine.torque_point, theirs.torque_point);
    act(mine.contact_area, theirs.contact_area);
    act(mine.gradient_offsets, theirs.gradient_offsets);
    act(mine.gradient_vertices, theirs.gradient_vertices);
    act(mine.gradient, theirs.gradient);
    act(mine.curve_offsets, theirs.curve_offsets);
    act(mine.curve_closed, theirs.curve_closed);
    act(mine.curve_area_vector, theirs.curve_area_vector);
    act(mine.curve_torque, theirs.curve_torque);
    act(mine.curve_point_offsets, theirs.curve_point_offsets);
    act(mine.curve_points, theirs.curve_points);
    act(mine.curve_triangles, theirs.curve_triangles);
    act(mine.winding_offsets, theirs.winding_offsets);
    act(mine.winding_vertices, theirs.winding_vertices);
    act(mine.windings, theirs.windings);
    act(mine.body_volume, theirs.body_volume);
    act(mine.is_solid, theirs.is_solid);
}

std::array<double, 3> array_of(const Vec3d& v) { return {v.x, v.y, v.z}; }

}  // namespace

Overlaps metered_overlaps(MemoryMeter* meter) {
    Overlaps result;
    for_each_array(result, result, [&]<class T>(Array<T>& array, Array<T>&) { array = Array<T>(meter); });
    return result;
}

void swap_out(Overlaps& mine, Overlaps& theirs) {
    for_each_array(mine, theirs, [](auto& one, auto& other) {
        one.swap_elements(other);
        one.clear();
    });
    theirs.any = std::exchange(mine.any, false);
    theirs.count = std::exchange(mine.count, 0);
    theirs.statistics = std::exchange(mine.statistics, {});
}

void clear(Overlaps& result) {
    for_each_array(result, result, [](auto& array, auto&) { array.clear(); });
    result.any = false;
    result.count = 0;
    result.statistics = {};
}

std::size_t bytes_of(const OverlapRow& row) {
    std::size_t bytes = bytes_of(row.curves);
    for (std::size_t side = 0; side < 2; ++side) bytes += bytes_of(row.gradient[side]) + bytes_of(row.windings[side]);
    for (const OverlapCurve& curve : row.curves) bytes += bytes_of(curve.points) + bytes_of(curve.triangles);
    return bytes;
}

void orient(int first, int second, OverlapRow& row) {
    const auto negate = [](double& x) { x = 0 - x; };
    const auto negate_all = [&](Vec3d& v) {
        for (int axis = 0; axis < 3; ++axis) negate(v[axis]);
    };
    for (VertexWinding& vertex : row.windings[0]) vertex.winding *= second;
    for (VertexWinding& vertex : row.windings[1]) vertex.winding *= first;
    if (first == second) return;
    OverlapNumbers& numbers = row.numbers;
    negate(numbers.volume.value);
    negate(numbers.mean_depth);
    for (Vec3d* v : {&numbers.area_vector, &numbers.torque, &numbers.normal}) negate_all(*v);
    for (auto& vertices : row.gradient)
        for (VertexVector& vertex : vertices) negate_all(vertex.value);
    for (OverlapCurve& curve : row.curves) {
        negate_all(curve.area_vector);
        negate_all(curve.torque);
        std::reverse(curve.points.begin(), curve.points.end());
        std::reverse(curve.triangles.begin(), curve.triangles.end());
    }
}

void begin(const OverlapQuery& query, std::int32_t worlds, std::int32_t bodies, Overlaps& result) {
    clear(result);
    if (query.output != Output::any) result.world_hit.assign(static_cast<std::size_t>(worlds), 0);
    if (query.output != Output::pairs) return;
    if (query.gradient) result.gradient_offsets.push_back(0);
    if (query.windings) result.winding_offsets.push_back(0);
    if (query.curves) {
        result.curve_offsets.push_back(0);
        result.curve_point_offsets.push_back(0);
    }
    if (!query.self_overlaps) return;
    result.body_volume.assign(static_cast<std::size_t>(bodies), std::numeric_limits<double>::quiet_NaN());
    result.is_solid.assign(static_cast<std::size_t>(bodies), 0);
}

void add_body(std::int32_t body, const OverlapRow& row, Overlaps& result) {
    if (result.body_volume.empty()) return;
    result.body_volume[body] = row.body_volume;
    result.is_solid[body] = row.numbers.volume.scaled.mantissa == 0;
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

void add_row(const OverlapQuery& query, const BodyPair& bodies, std::int32_t world, const OverlapRow& row,
             Overlaps& result) {
    result.any = true;
    if (query.output == Output::any) return;
    if (world >= 0) result.world_hit[world] = 1;
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
    if (query.windings) add_offset(result.winding_offsets, result.windings.size());
    if (!query.curves) return;
    for (const OverlapCurve& curve : row.curves) {
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
