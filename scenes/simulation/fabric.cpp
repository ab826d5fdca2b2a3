#include "scenes/simulation/fabric.h"

#include <algorithm>
#include <cmath>

namespace crumple::scenes {

Fabric weave(int columns, int rows, double spacing, Random& random) {
    constexpr double jitter = 0.1;
    Fabric fabric;
    fabric.spacing = spacing;
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= columns; ++i) {
            const double u = i - 0.5 * columns + random.uniform(-jitter, jitter);
            const double v = j - 0.5 * rows + random.uniform(-jitter, jitter);
            fabric.flat.push_back({u * spacing, v * spacing});
        }
    }
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const std::int32_t a = j * (columns + 1) + i, b = a + 1, c = b + columns, d = c + 1;
            if (random.bits() & 1) {
                fabric.triangles.push_back({a, b, d});
                fabric.triangles.push_back({a, d, c});
            } else {
                fabric.triangles.push_back({a, b, c});
                fabric.triangles.push_back({b, d, c});
            }
        }
    }
    return fabric;
}

int cells_of_square(double triangles) { return std::max(4, static_cast<int>(std::lround(std::sqrt(triangles / 2)))); }

}  // namespace crumple::scenes
