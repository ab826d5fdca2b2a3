// Twelve concentric spheres that do not touch, each a group: closed, clean and smooth, without collisions. The boxes of
// the spheres are nested, and the spheres have the same centre.

#include <algorithm>
#include <cmath>

#include "scenes/list.h"
#include "scenes/soup.h"

namespace crumple::scenes {

io::TriangleMesh make_shells(const Parameters& parameters) {
    constexpr int shells = 12;
    Soup soup;
    for (int i = 0; i < shells; ++i) {
        const auto left = static_cast<double>(parameters.triangles - soup.triangle_count());
        // From 4 cuts on, a face's depth beneath its sphere is less than the distance between spheres.
        const int cuts = left > 0 ? static_cast<int>(std::lround(std::sqrt(left / (20 * (shells - i))))) : 0;
        add_icosphere(soup, std::max(4, cuts), {.scale = 1 + 0.15 * i});
        soup.group(i);
    }
    return soup.take();
}

}  // namespace crumple::scenes
