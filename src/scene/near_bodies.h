#pragma once

// Finds the pairs of bodies of a world whose boxes overlap, by a sweep along x.

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "crumple/array.h"
#include "geometry/triangle.h"
#include "scene/world_outline.h"

namespace crumple {

class NearBodies {
   public:
    explicit NearBodies(MemoryMeter* meter) : box_(meter), rest_(meter) {}

    /// Sets the boxes: box_of(b) returns that of body b. The outline must outlive the use of this object.
    template <class BoxOf>
    void prepare(const WorldOutline& outline, BoxOf box_of) {
        outline_ = &outline;
        box_.resize_discard(static_cast<std::size_t>(outline.bodies()));
        for (std::int32_t b = 0; b < outline.bodies(); ++b) box_[b] = box_of(b);
        const std::int32_t first = outline.first_body(outline.worlds());
        rest_.resize_discard(static_cast<std::size_t>(outline.bodies() - first));
        for (std::int32_t b = first; b < outline.bodies(); ++b) rest_[b - first] = {b, box_[b].low.x, 0};
        std::sort(rest_.begin(), rest_.end(), [](const Rest& a, const Rest& b) { return a.low < b.low; });
        double reach = -largest_number;
        for (Rest& r : rest_) r.reach = reach = std::max(reach, box_[r.body].high.x);
    }

    const Bounds& box(std::int32_t body) const { return box_[body]; }

    /// Calls visit(a, b), a < b, for each pair of bodies with overlapping boxes of which both bodies are in this world,
    /// or one is in this world and the other in all worlds. If `world` is the number of worlds, visits the pairs of
    /// bodies that are in all worlds. The order is arbitrary. Ends when visit returns false.
    template <class Visit>
    void for_each_pair(std::int32_t world, Visit visit) const {
        const bool last = world == outline_->worlds();
        const std::int32_t begin = outline_->first_body(world),
                           end = last ? outline_->bodies() : outline_->first_body(world + 1);
        constexpr std::int32_t few = 32;
        std::vector<std::int32_t> order;
        if (end - begin > few) {
            order.resize(static_cast<std::size_t>(end - begin));
            std::iota(order.begin(), order.end(), begin);
            std::sort(order.begin(), order.end(), [&](auto a, auto b) { return box_[a].low.x < box_[b].low.x; });
        }
        for (std::int32_t i = 0; i < end - begin; ++i) {
            const std::int32_t a = order.empty() ? begin + i : order[static_cast<std::size_t>(i)];
            for (std::int32_t j = i + 1; j < end - begin; ++j) {
                const std::int32_t b = order.empty() ? begin + j : order[static_cast<std::size_t>(j)];
                if (!order.empty() && box_[b].low.x > box_[a].high.x) break;
                if (overlap(box_[a], box_[b]) && !visit(std::min(a, b), std::max(a, b))) return;
            }
            if (last) continue;
            auto r = std::partition_point(rest_.begin(), rest_.end(),
                                          [&](const Rest& x) { return x.reach < box_[a].low.x; });
            for (; r != rest_.end() && r->low <= box_[a].high.x; ++r)
                if (overlap(box_[a], box_[r->body]) && !visit(a, r->body)) return;
        }
    }

   private:
    /// Body that is in all worlds. `reach`: the largest upper end in x of this body and of all bodies before it in the
    /// order of `low`.
    struct Rest {
        std::int32_t body;
        double low, reach;
    };

    const WorldOutline* outline_ = nullptr;
    Array<Bounds> box_;  ///< box of each body
    Array<Rest> rest_;   ///< bodies in all worlds, by ascending low.x
};

}  // namespace crumple
