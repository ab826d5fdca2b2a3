#include "backends/cpu/pair_range.h"

#include <algorithm>
#include <mutex>

#include "geometry/vec.h"

namespace crumple::cpu {
namespace {

// A box of balls, and which balls reach it.
struct Reach {
    static constexpr float most = std::numeric_limits<float>::max();
    Vec3f low{most, most, most}, high{-most, -most, -most};

    void add(const Ball& ball) {
        const Vec3f c{ball.x, ball.y, ball.z}, r{ball.r, ball.r, ball.r};
        low = min(low, c - r);
        high = max(high, c + r);
    }
    void add(const Reach& other) {
        low = min(low, other.low);
        high = max(high, other.high);
    }
    // Coordinates are at most 1, and balls, however widened, have radii of at most 6: rounding errs by less than this.
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

// is_first(t), is_second(t): whether triangle t is on that side of some pair.
template <class IsFirst, class IsSecond>
Level exclude_others(IsFirst is_first, IsSecond is_second, const RangeBuffers& b) {
    constexpr std::uint64_t inside = 2, outside = 3;
    const auto n = static_cast<std::int64_t>(b.balls.size()) - padding;
    if (b.included.empty()) b.included.assign(static_cast<std::size_t>(n), 1);
    b.masks.resize_discard(static_cast<std::size_t>(n));
    constexpr std::int64_t chunk = 4096;
    const auto for_each_chunk = [&](auto visit) {
        b.workers.parallel_for(static_cast<std::size_t>((n + chunk - 1) / chunk), [&](std::size_t c, std::size_t) {
            const std::int64_t begin = static_cast<std::int64_t>(c) * chunk;
            visit(begin, std::min(n, begin + chunk));
        });
    };
    Reach reach;
    std::mutex mutex;
    for_each_chunk([&](std::int64_t begin, std::int64_t end) {
        Reach mine;
        for (std::int64_t t = begin; t < end; ++t) {
            const bool first = is_first(t);
            b.masks[t] = first ? inside : outside;
            if (first && b.included[t]) mine.add(b.balls[t]);
        }
        const std::lock_guard lock(mutex);
        reach.add(mine);
    });
    reach.grow();
    for_each_chunk([&](std::int64_t begin, std::int64_t end) {
        for (std::int64_t t = begin; t < end; ++t)
            if (b.masks[t] == outside && !(is_second(t) && reach.meets(b.balls[t]))) b.included[t] = 0;
    });
    return {b.masks.data(), 1};
}

bool owns_any(const SceneFeatures& features, FeatureType type, const IdRange& ids, std::int64_t t) {
    if (type == FeatureType::face) return t < features.faces() && ids.has(t);
    const unsigned owned = features.owned(t);
    for (int k = 0; k < 3; ++k) {
        if (type == FeatureType::vertex && (owned >> k & 1) && ids.has(features.point_of(t, k))) return true;
        const auto side = static_cast<std::size_t>(k);
        if (type == FeatureType::edge && (owned >> (3 + k) & 1) && ids.has(features.edges_of(t)[side])) return true;
    }
    return false;
}

}  // namespace

Level exclude_others(const PairRange& range, const RangeBuffers& buffers) {
    return exclude_others([&](std::int64_t t) { return range.first.has(t); },
                          [&](std::int64_t t) { return range.second.has(t); }, buffers);
}

Level exclude_others(const FeatureRange& range, const SceneFeatures& features, const RangeBuffers& buffers) {
    return exclude_others([&](std::int64_t t) { return owns_any(features, range.types.first, range.first, t); },
                          [&](std::int64_t t) { return owns_any(features, range.types.second, range.second, t); },
                          buffers);
}

}  // namespace crumple::cpu
