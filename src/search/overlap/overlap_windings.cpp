#include "search/overlap/overlap_windings.h"

#include <algorithm>

#include "exact/overlap/crossing.h"
#include "search/containment/winding_rays.h"

namespace crumple {

void WindingSteps::add_jumps(const ClosedSurface& surface, std::int32_t face, const EdgeJumps& jumps) {
    for (std::size_t edge = 0; edge < 3; ++edge) {
        const int direction = jumps[edge] == 0 ? 0 : surface.forest_edge(face, edge);
        if (direction == 0) continue;
        const std::int32_t* c = surface.corners(face);
        const std::int32_t place = surface.place(c[direction > 0 ? next_corner(edge) : edge]);
        add(place, surface.end_of(place), direction * jumps[edge]);
    }
}

// If a component has a vertex outside of the other surface's box, the winding number there is 0, and the steps from the
// first vertex to that vertex give the number at the first vertex. From the first vertices of all other components,
// rays are cast together, in one pass over the faces.
void WindingSteps::add_components(const PlacedSurface& of, const PlacedSurface& other, Shift shift,
                                  Cancellation& cancellation) {
    std::sort(steps_.begin(), steps_.end());
    const auto& first = of.surface->components();
    const auto is_outside = [&](std::int32_t place) {
        const Vec3d& p = of.points[of.surface->vertex_at_place(place)];
        return !overlap(Bounds{p, p}, other.box);
    };
    std::vector<WindingRay> rays;
    std::vector<WindingInterval> found;
    std::size_t step = 0;
    std::int32_t winding = 0;  // sum of the steps so far; steps of earlier components add up to 0
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        std::int32_t place = first[c];
        while (place < first[c + 1] && !is_outside(place)) ++place;
        if (place == first[c + 1]) {
            rays.push_back({of.points[of.surface->vertex_at_place(first[c])], c, 0});
            continue;
        }
        for (; step < steps_.size() && steps_[step].place <= place; ++step) winding += steps_[step].change;
        found.push_back({first[c], first[c + 1], -winding});
    }
    cast_rays(rays, other, shift, cancellation);
    for (const WindingRay& ray : rays) found.push_back({first[ray.of], first[ray.of + 1], ray.winding});
    for (const WindingInterval& whole : found) add(whole.begin, whole.end, whole.winding);
}

void WindingSteps::make_intervals() {
    std::sort(steps_.begin(), steps_.end());
    std::int32_t winding = 0;
    for (std::size_t i = 0; i < steps_.size();) {
        const std::int32_t place = steps_[i].place;
        if (winding != 0) intervals_.back().end = place;
        for (; i < steps_.size() && steps_[i].place == place; ++i) winding += steps_[i].change;
        if (winding != 0) intervals_.push_back({place, place, winding});
    }
}

std::int32_t WindingSteps::winding_at(std::int32_t place) const {
    const auto before = [](std::int32_t p, const WindingInterval& interval) { return p < interval.begin; };
    const auto after = std::upper_bound(intervals_.begin(), intervals_.end(), place, before);
    if (after == intervals_.begin()) return 0;
    const WindingInterval& interval = *std::prev(after);
    return place < interval.end ? interval.winding : 0;
}

}  // namespace crumple
