#include "results/nearest_output.h"

#include <utility>

namespace crumple {
namespace {

/// Calls act(array) for each array that has an element for each row.
template <class Act>
void for_each_array(Distances& answer, Act act) {
    act(answer.bodies);
    act(answer.squared_distance);
    act(answer.touching);
    act(answer.triangles);
    act(answer.points);
}

}  // namespace

Distances metered_nearest(MemoryMeter* meter) {
    Distances answer;
    answer.world_rows = Array<std::int64_t>(meter);
    for_each_array(answer, [&]<class T>(Array<T>& array) { array = Array<T>(meter); });
    return answer;
}

void swap_out(Distances& mine, Distances& theirs) {
    const auto swap = [](auto& one, auto& other) {
        one.swap_elements(other);
        one.clear();
    };
    swap(mine.bodies, theirs.bodies);
    swap(mine.squared_distance, theirs.squared_distance);
    swap(mine.touching, theirs.touching);
    swap(mine.triangles, theirs.triangles);
    swap(mine.points, theirs.points);
    swap(mine.world_rows, theirs.world_rows);
    theirs.any = std::exchange(mine.any, false);
    theirs.count = std::exchange(mine.count, 0);
    theirs.statistics = std::exchange(mine.statistics, {});
}

void clear(Distances& answer) {
    for_each_array(answer, [](auto& array) { array.clear(); });
    answer.world_rows.clear();
    answer.any = false;
    answer.count = 0;
    answer.statistics = {};
}

void make_rows(Distances& answer) {
    const std::size_t rows = answer.bodies.size();
    for_each_array(answer, [&](auto& array) { array.resize(rows); });
}

void put_row(Distances& answer, std::size_t i, const NearestRow& row) {
    answer.squared_distance[i] = row.squared;
    answer.touching[i] = row.touching;
    answer.triangles[i] = row.triangles;
    for (std::size_t k = 0; k < 2; ++k) answer.points[i][k] = {row.points[k].x, row.points[k].y, row.points[k].z};
}

void keep_rows(Distances& answer, const Array<std::uint8_t>& kept) {
    for_each_array(answer, [&](auto& array) {
        std::size_t n = 0;
        for (std::size_t i = 0; i < kept.size(); ++i)
            if (kept[i]) array[n++] = array[i];
        array.resize(n);
    });
}

}  // namespace crumple
