// Two crossing triangles and one that is far away: one pair.

#include <array>
#include <cstdio>
#include <vector>

#include "crumple/crumple.h"

int main() {
    const std::vector<std::array<float, 3>> vertices{{0, 0, 0},        {1, 0, 0},       {0, 1, 0},
                                                     {0.2f, 0.2f, -1}, {0.2f, 0.2f, 1}, {2, 2, 0},
                                                     {9, 9, 9},        {9, 9, 10},      {9, 10, 9}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    crumple::Detector detector;
    const crumple::Collisions& collisions = detector.find_self({vertices, triangles});
    for (const crumple::Pair& pair : collisions.pairs) std::printf("%d %d\n", pair.a, pair.b);
    return collisions.pairs.size() == 1 && collisions.pairs[0] == crumple::Pair{0, 1} ? 0 : 1;
}
