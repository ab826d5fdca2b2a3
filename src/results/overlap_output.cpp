#include "results/overlap_output.h"

#include <utility>

namespace crumple {
namespace {

template <class Act>
void for_each_array(Overlaps& mine, Overlaps& theirs, Act act) {
    act(mine.world_hit, theirs.world_hit);
    act(mine.bodies, theirs.bodies);
    act(mine.relation, theirs.relation);
    act(mine.volume, theirs.volume);
    act(mine.centroid, theirs.centroid);
    act(mine.area_vector, theirs.area_vector);
    act(mine.normal, theirs.normal);
    act(mine.mean_depth, theirs.mean_depth);
    act(mine.torque, theirs.torque);
    act(mine.torque_point, theirs.torque_point);
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
}

}  // namespace crumple
