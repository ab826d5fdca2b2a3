#include "checks/crossing_places.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "io/lists/pairs.h"

namespace crumple::checks {
namespace {

/// Vertices of two triangles of a pair, one of each, and the pair's place in its group.
struct VertexKey {
    std::int32_t a, b, pair;
    friend auto operator<=>(const VertexKey&, const VertexKey&) = default;
};

/// Returns sets of pairs of one group that are connected. `rows`: the group, pairs of the same two shells.
DisjointSets connect(const Intersections& found, std::span<const std::int32_t> rows, const io::TriangleMesh& first,
                     const io::TriangleMesh& second) {
    const bool same = &first == &second;
    std::vector<VertexKey> keys;
    keys.reserve(9 * rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Pair pair = found.pairs[static_cast<std::size_t>(rows[i])];
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) {
                std::int32_t a = first.triangles[3 * static_cast<std::size_t>(pair.a) + j],
                             b = second.triangles[3 * static_cast<std::size_t>(pair.b) + k];
                if (same && a > b) std::swap(a, b);
                keys.push_back({a, b, static_cast<std::int32_t>(i)});
            }
    }
    std::sort(keys.begin(), keys.end());
    DisjointSets sets(rows.size());
    for (std::size_t i = 1; i < keys.size(); ++i)
        if (keys[i].a == keys[i - 1].a && keys[i].b == keys[i - 1].b) sets.join(keys[i].pair, keys[i - 1].pair);
    return sets;
}

void measure(const Intersections& found, CrossingPlace& place) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    place.box.low.fill(infinity), place.box.high.fill(-infinity);
    std::vector<std::int64_t> triangles;
    const std::int64_t of_second = place.shells.first == place.shells.second ? 0 : std::int64_t{1} << 32;
    for (const std::int32_t row : place.rows) {
        const Pair pair = found.pairs[static_cast<std::size_t>(row)];
        triangles.push_back(pair.a);
        triangles.push_back(pair.b + of_second);
        for (const Point& p : io::points_of_pair(found.contacts, static_cast<std::size_t>(row)))
            for (std::size_t k = 0; k < 3; ++k) {
                place.box.low[k] = std::min(place.box.low[k], p[k]);
                place.box.high[k] = std::max(place.box.high[k], p[k]);
            }
    }
    std::sort(triangles.begin(), triangles.end());
    place.triangles = std::unique(triangles.begin(), triangles.end()) - triangles.begin();
    place.centre = middle_of(place.box);
}

}  // namespace

CrossingPlace joined(std::span<const CrossingPlace* const> places, const Intersections& found) {
    CrossingPlace all;
    all.shells = places[0]->shells;
    for (const CrossingPlace* place : places) all.rows.insert(all.rows.end(), place->rows.begin(), place->rows.end());
    std::sort(all.rows.begin(), all.rows.end());
    measure(found, all);
    return all;
}

std::vector<CrossingPlace> find_places(const Intersections& found, std::span<const io::TriangleMesh* const> shells) {
    std::vector<std::int32_t> order(found.pairs.size());
    std::iota(order.begin(), order.end(), 0);
    const auto shells_of = [&](std::int32_t row) { return found.bodies[static_cast<std::size_t>(row)]; };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::int32_t i, std::int32_t j) { return shells_of(i) < shells_of(j); });
    std::vector<CrossingPlace> places;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        const BodyPair pair = shells_of(order[begin]);
        while (end < order.size() && shells_of(order[end]) == pair) ++end;
        const auto rows = std::span<const std::int32_t>(order).subspan(begin, end - begin);
        DisjointSets sets = connect(found, rows, *shells[static_cast<std::size_t>(pair.first)],
                                    *shells[static_cast<std::size_t>(pair.second)]);
        std::map<std::int32_t, CrossingPlace> of_set;  // sets are represented by their least pairs
        for (std::size_t i = 0; i < rows.size(); ++i)
            of_set[sets.find(static_cast<std::int32_t>(i))].rows.push_back(rows[i]);
        for (auto& [least, place] : of_set) {
            place.shells = pair;
            measure(found, place);
            places.push_back(std::move(place));
        }
    }
    return places;
}

}  // namespace crumple::checks
