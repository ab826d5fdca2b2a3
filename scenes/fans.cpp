// Coins as CAD systems triangulate them: both faces are fans of needles around one vertex, the edge is a strip of
// slivers. A fan of valence n has n (n - 1) / 2 pairs of adjacent triangles, whose boxes nearly all overlap. The coins
// intersect each other; each coin is a group.

#include <algorithm>

#include "scenes/arithmetic.h"
#include "scenes/list.h"
#include "scenes/random.h"
#include "scenes/soup.h"

namespace crumple::scenes {

io::TriangleMesh make_fans(const Parameters& parameters) {
    constexpr int usual_valence = 1500;
    const auto coins = static_cast<int>(std::max<std::int64_t>(2, parameters.triangles / (4 * usual_valence)));
    const auto valence = static_cast<int>(std::max<std::int64_t>(3, parameters.triangles / (4 * coins)));
    Random random(parameters.seed);
    Soup soup;
    for (int coin = 0; coin < coins; ++coin) {
        const Vec3d up = random.direction(), side = random.direction();
        const Vec3d x = normalised(side - dot(side, up) * up), y = cross(up, x);
        const Vec3d middle{1.2 * coin, random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)};
        const std::int32_t first = soup.vertex(middle - 0.05 * up);
        soup.vertex(middle + 0.05 * up);
        for (int i = 0; i < valence; ++i) {
            const double turns = static_cast<double>(i) / valence;
            const Vec3d rim = middle + cosine(turns) * x + sine(turns) * y;
            soup.vertex(rim - 0.05 * up);
            soup.vertex(rim + 0.05 * up);
        }
        for (int i = 0; i < valence; ++i) {
            const std::int32_t low = first + 2 + 2 * i, next = first + 2 + 2 * ((i + 1) % valence);
            soup.triangle({first, next, low});
            soup.triangle({first + 1, low + 1, next + 1});
            soup.triangle({low, next, next + 1});
            soup.triangle({low, next + 1, low + 1});
        }
        soup.group(coin);
    }
    return soup.take();
}

}  // namespace crumple::scenes
