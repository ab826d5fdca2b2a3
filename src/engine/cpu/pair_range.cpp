#include "engine/cpu/pair_range.h"

#include <algorithm>

#include "geometry/vec.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t chunk = 4096;

// A box of balls, and which balls reach it.
struct Reach {
    static constexpr float most = std::numeric_limits<float>::max();
    Vec3f low{most, most, most}, high{-most, -most, -most};

    void add(const Ball& ball) {
        const Vec3f c{ball.x, ball.y, ball.z}, r{ball.r, ball.r, ball.r};
        low = min(low, c - r);
        high = max(high, c + r);
    }
    // Coordinates are at most 1, and a ball that matters no larger than the scene: rounding errs by less than this.
    void grow() {
        constexpr Vec3f margin{4e-6f, 4e-6f, 4e-6f};
        low = low - margin;
        high = high + margin;
    }
    bool meets(const Ball& ball) const {
        const Vec3f c{ball.x, ball.y, ball.z};
        const Vec3f out = max(Vec3f{}, max(low - c, c - high));
        return !(dot(out, out) > ball.r * ball.r);
    }
};

}  // namespace

Level exclude_others(const PairRange& range, Workers& workers, const Array<Ball>& balls, Array<std::uint8_t>& included,
                     Array<std::uint64_t>& masks) {
    constexpr std::uint64_t inside = 2, outside = 3;
    const auto n = static_cast<std::int64_t>(balls.size()) - padding;
    if (included.empty()) included.assign(static_cast<std::size_t>(n), 1);
    masks.resize_discard(static_cast<std::size_t>(n));
    Reach reach;
    for (std::int64_t t = range.first.begin; t < range.first.end; ++t)
        if (included[t]) reach.add(balls[t]);
    reach.grow();
    const auto in = [](const IdRange& ids, std::int64_t t) { return t >= ids.begin && t < ids.end; };
    workers.parallel_for(static_cast<std::size_t>((n + chunk - 1) / chunk), [&](std::size_t c, std::size_t) {
        const std::int64_t begin = static_cast<std::int64_t>(c) * chunk;
        for (std::int64_t t = begin; t < std::min(n, begin + chunk); ++t) {
            const bool first = in(range.first, t);
            masks[t] = first ? inside : outside;
            if (!first && !(in(range.second, t) && reach.meets(balls[t]))) included[t] = 0;
        }
    });
    return {masks.data(), 1};
}

}  // namespace crumple::cpu
