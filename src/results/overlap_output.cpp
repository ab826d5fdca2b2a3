#include "results/overlap_output.h"

#include <algorithm>
#include <limits>
#include <utility>

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
    act(mine.gradient_offsets, theirs.gradient_offsets);
    act(mine.gradient_vertices, theirs.gradient_vertices);
    act(mine.gradient, theirs.gradient);
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

void hand_over(Overlaps& mine, Overlaps& theirs) {
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
}

void begin(const OverlapQuery& query, std::int32_t worlds, std::int32_t bodies, Overlaps& result) {
    clear(result);
    if (query.output != Output::any) result.world_hit.assign(static_cast<std::size_t>(worlds), 0);
    if (query.output != Output::pairs) return;
    if (query.gradient) result.gradient_offsets.push_back(0);
    if (query.windings) result.winding_offsets.push_back(0);
    if (!query.self_overlaps) return;
    result.body_volume.assign(static_cast<std::size_t>(bodies), std::numeric_limits<double>::quiet_NaN());
    result.is_solid.assign(static_cast<std::size_t>(bodies), 0);
}

void add_body(std::int32_t body, const OverlapRow& row, Overlaps& result) {
    if (result.body_volume.empty()) return;
    result.body_volume[body] = row.body_volume;
    result.is_solid[body] = row.numbers.volume.scaled.mantissa == 0;
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
}

}  // namespace crumple
