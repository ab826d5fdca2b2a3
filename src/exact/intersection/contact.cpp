// Contacts on the host: contact_on_line.h, with rational arithmetic for single points that it leaves unresolved.
// Coplanar or degenerate triangles and extreme coordinates take rational arithmetic as a whole.

#include "exact/intersection/contact.h"

#include "exact/intersection/contact_on_line.h"
#include "exact/intersection/exact_intersection.h"

namespace crumple {
namespace {

struct Rationally {
    bool& used;

    bool crossing(const Vec3d& p, const Vec3d& q, const std::array<Vec3d, 3>& triangle, Vec3d& result) const {
        used = true;
        result = round_crossing(p, q, triangle);
        return true;
    }
    bool direction(const CommonLine& line, int axis, int& sign) const {
        const auto normal = [](const std::array<Vec3d, 3>& p, int along) {
            const int x = first_axis(along), y = second_axis(along);
            return exact_difference(p[1][x], p[0][x]) * exact_difference(p[2][y], p[0][y]) -
                   exact_difference(p[1][y], p[0][y]) * exact_difference(p[2][x], p[0][x]);
        };
        used = true;
        const int x = first_axis(axis), y = second_axis(axis);
        sign = (normal(line.b, x) * normal(line.a, y) - normal(line.b, y) * normal(line.a, x)).sign();
        return true;
    }
};

}  // namespace

Contact contact(const Triangle& a, const Triangle& b) {
    Contact result;
    if (contact_on_line(a, b, Rationally{result.rational}, result)) return result;
    result = contact(intersect_rationally(a, b));
    result.rational = true;
    return result;
}

}  // namespace crumple
