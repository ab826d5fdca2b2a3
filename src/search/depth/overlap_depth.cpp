#include "search/depth/overlap_depth.h"

#include <algorithm>
#include <atomic>
#include <utility>

namespace crumple {
namespace {

/// Depths of consecutive vertices of one surface.
class DepthWalk {
   public:
    DepthWalk(const PlacedSurface& of, const SurfaceTree& other)
        : of_(of), other_(other), in_range_(of.in_range && other.surface().in_range), walk_(other) {}

    /// Adds the depth of a vertex, unless the vertex lies on the surface. Vertices that are close to the previous one
    /// take less time.
    void add(std::int32_t vertex, Cancellation& cancellation, std::vector<VertexDepth>& depths) {
        const Vec3d& p = of_.points[vertex];
        walk_.find(other_.scale() * p, start_);
        start_ = walk_.near()[walk_.closest()].triangle;
        const auto nearest = decide_nearest(p, near(), walk_.closest(), in_range_, cancellation, rational_);
        if (nearest) depths.push_back({vertex, nearest->distance, nearest->point, nearest->triangle});
    }
    std::int64_t rational() const { return rational_; }

   private:
    /// Returns the triangles that the walk has found, without a scale.
    std::span<const NearTriangle> near() {
        if (other_.scale() == 1) return walk_.near();
        unscaled_.clear();
        for (const NearTriangle& near : walk_.near())
            unscaled_.push_back({near.triangle, other_.surface().corners(near.triangle)});
        return unscaled_;
    }

    const PlacedSurface& of_;
    const SurfaceTree& other_;
    bool in_range_;
    PointWalk walk_;
    std::int32_t start_ = -1;
    std::int64_t rational_ = 0;
    std::vector<NearTriangle> unscaled_;
};

/// Returns the vertices with non-zero winding number, in the order of their places, so that vertices next to each other
/// are close in space.
std::vector<std::int32_t> inner_vertices(const ClosedSurface& surface, const WindingSteps& windings) {
    std::vector<std::int32_t> vertices;
    for (const WindingInterval& interval : windings.intervals())
        for (std::int32_t place = interval.begin; place < interval.end; ++place)
            vertices.push_back(surface.vertex_at_place(place));
    return vertices;
}

}  // namespace

std::vector<VertexDepth> find_depths(const PlacedSurface& of, const WindingSteps& windings, const SurfaceTree& other,
                                     ParallelFor& workers, Cancellation& cancellation, std::int64_t& rational) {
    constexpr std::size_t chunk = 256;
    const std::vector<std::int32_t> vertices = inner_vertices(*of.surface, windings);
    std::vector<std::vector<VertexDepth>> parts((vertices.size() + chunk - 1) / chunk);
    std::atomic<std::int64_t> count{0};
    workers.parallel_for(parts.size(), [&](std::size_t part) {
        DepthWalk walk(of, other);
        const std::size_t end = std::min(vertices.size(), (part + 1) * chunk);
        for (std::size_t i = part * chunk; i < end; ++i) {
            if (i % 32 == 0) cancellation.check();
            walk.add(vertices[i], cancellation, parts[part]);
        }
        count += walk.rational();
    });
    std::vector<VertexDepth> depths;
    for (const auto& part : parts) depths.insert(depths.end(), part.begin(), part.end());
    std::sort(depths.begin(), depths.end(), [](const auto& x, const auto& y) { return x.vertex < y.vertex; });
    rational += count;
    return depths;
}

}  // namespace crumple
