// The scene `cloth`, on a ground of two huge triangles (group 2) that cut through the hem of the sheet. Two triangles
// that are so much larger than all others spoil every quantity that an algorithm derives from the largest triangle or
// from the scene's extent, such as a cell size.

#include "scenes/cloth.h"
#include "scenes/drape.h"
#include "scenes/list.h"

namespace crumple::scenes {

io::TriangleMesh make_ground(const Parameters& parameters) {
    Soup soup;
    add_cloth(soup, parameters);
    const double far = 20 * Drape::half_width, height = Drape::floor + 0.02;
    const std::int32_t first = soup.vertex({-far, -far, height});
    soup.vertex({far, -far, height});
    soup.vertex({far, far, height});
    soup.vertex({-far, far, height});
    soup.triangle({first, first + 1, first + 2});
    soup.triangle({first, first + 2, first + 3});
    soup.group(2);
    return soup.take();
}

}  // namespace crumple::scenes
