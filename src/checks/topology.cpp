#include "checks/topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "base/disjoint_sets.h"
#include "exact/intersection/contact.h"
#include "geometry/predicates.h"
#include "io/bytes/large_pages.h"
#include "io/meshes/weld.h"
#include "scene/placement.h"

namespace crumple::checks {
namespace {

const std::int32_t* corners_of(const io::TriangleMesh& mesh, std::int64_t t) { return mesh.triangles.data() + 3 * t; }

/// Calls visit(t, triangle) for each triangle, in ascending order.
template <class Visit>
void for_each_triangle(const io::TriangleMesh& mesh, Visit visit) {
    const auto run = [&](const auto& xyz) {
        for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
            const std::int32_t* const c = corners_of(mesh, t);
            Triangle triangle{{}, {c[0], c[1], c[2]}};
            for (std::size_t k = 0; k < 3; ++k) {
                const auto* const p = xyz.data() + 3 * std::int64_t{c[k]};
                triangle.point[k] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
            }
            visit(t, triangle);
        }
    };
    std::visit(run, mesh.vertices);
}

bool is_degenerate(const Triangle& triangle) {
    const auto& [a, b, c] = triangle.point;
    for (int axis = 0; axis < 3; ++axis) {
        const int reverse = orient2d_filtered(a, b, c, axis);
        if (reverse == 1 || reverse == -1) return false;
    }
    // Decides exactly: the contact of a triangle with itself is the triangle, so it is an area (three corners or more)
    // unless the triangle is degenerate.
    return contact(triangle, triangle).count < 3;
}

}  // namespace

std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels) {
    DisjointSets sets(static_cast<std::size_t>(mesh.vertex_count()));
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(mesh, t);
        sets.join(c[0], c[1]);
        sets.join(c[0], c[2]);
    }
    std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.vertex_count()), -1);
    std::int32_t count = 0;
    labels.resize(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        std::int32_t& label = number[static_cast<std::size_t>(sets.find(*corners_of(mesh, t)))];
        if (label < 0) label = count++;
        labels[static_cast<std::size_t>(t)] = label;
    }
    return count;
}

namespace {

/// Items grouped by vertex, in linear time. In each group, items are in the order in which they were added.
template <class Item>
class ByVertex {
   public:
    /// Groups the items that add_all(add) passes to add(vertex, item). Calls add_all twice, first to count the items;
    /// both calls must add the same items in the same order.
    template <class AddAll>
    ByVertex(std::int64_t vertices, AddAll add_all) : end_(static_cast<std::size_t>(vertices + 1)) {
        add_all([&](std::int32_t vertex, const Item&) { ++end_[static_cast<std::size_t>(vertex) + 1]; });
        std::partial_sum(end_.begin(), end_.end(), end_.begin());
        items_ = std::make_unique_for_overwrite<Item[]>(end_.back());
        io::advise_large_pages(items_.get(), end_.back() * sizeof(Item));
        // At this point end_[v] is where v's group starts. Each item added advances it, so in the end it is where the
        // group ends.
        add_all(
            [&](std::int32_t vertex, const Item& item) { items_[end_[static_cast<std::size_t>(vertex)]++] = item; });
    }

    /// Calls visit(vertex, items) for each vertex with items, in ascending order. `visit` may modify the items.
    template <class Visit>
    void for_each_group(Visit visit) {
        std::size_t begin = 0;
        for (std::size_t v = 0; v + 1 < end_.size(); ++v) {
            if (end_[v] > begin) visit(static_cast<std::int32_t>(v), std::span(items_.get() + begin, end_[v] - begin));
            begin = end_[v];
        }
    }

   private:
    std::vector<std::size_t> end_;
    std::unique_ptr<Item[]> items_;
};

/// Side of a triangle, in the group of its edge's lower vertex.
struct DirectedSide {
    std::int32_t upper;      ///< the edge's other vertex
    std::uint32_t numbered;  ///< 2 · triangle, plus 1 if the triangle runs from the lower vertex to the upper one
    bool upwards() const { return numbered % 2 == 1; }
    std::int32_t triangle() const { return static_cast<std::int32_t>(numbered / 2); }
    friend auto operator<=>(const DirectedSide&, const DirectedSide&) = default;
};

/// Returns two triangles that run along an edge in the same direction, or nothing if as many triangles run along it in
/// one direction as in the other. `sides`: all sides along one edge; `lower`: the edge's lower vertex.
std::optional<FlippedEdge> find_flipped(std::int32_t lower, std::span<const DirectedSide> sides) {
    const auto up = std::count_if(sides.begin(), sides.end(), [](const DirectedSide& side) { return side.upwards(); });
    if (2 * up == std::ssize(sides)) return std::nullopt;
    const bool most = 2 * up > std::ssize(sides);
    const auto same = [&](const DirectedSide& side) { return side.upwards() == most; };
    const auto first = std::find_if(sides.begin(), sides.end(), same);
    const auto second = std::find_if(first + 1, sides.end(), same);
    return FlippedEdge{{lower, first->upper}, first->triangle(), second->triangle()};
}

std::int64_t count_parts(const std::vector<Edge>& edges, std::int64_t vertices) {
    DisjointSets sets(static_cast<std::size_t>(vertices));
    for (const Edge& edge : edges) sets.join(edge.a, edge.b);
    std::vector<std::int32_t> roots;
    roots.reserve(edges.size());
    for (const Edge& edge : edges) roots.push_back(sets.find(edge.a));
    std::sort(roots.begin(), roots.end());
    return std::unique(roots.begin(), roots.end()) - roots.begin();
}

}  // namespace

EdgeReport report_edges(const io::TriangleMesh& mesh) {
    ByVertex<DirectedSide> sides(mesh.vertex_count(), [&](auto add) {
        for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
            const std::int32_t* const c = corners_of(mesh, t);
            for (int k = 0; k < 3; ++k) {
                const std::int32_t a = c[k], b = c[(k + 1) % 3];
                if (a != b) add(std::min(a, b), {std::max(a, b), 2 * static_cast<std::uint32_t>(t) + (a < b ? 1 : 0)});
            }
        }
    });
    EdgeReport report;
    sides.for_each_group([&](std::int32_t lower, std::span<DirectedSide> group) {
        std::sort(group.begin(), group.end());
        for (auto side = group.begin(); side != group.end();) {
            const auto next =
                std::find_if(side, group.end(), [&](const DirectedSide& other) { return other.upper != side->upper; });
            const auto count = next - side;
            if (count == 1) report.open.push_back({lower, side->upper});
            if (count > 2) ++report.non_manifold;
            if (count > 2 && count % 2) ++report.odd;
            if (count % 2) report.closed = false;
            if (count % 2 == 0 && !report.flipped) report.flipped = find_flipped(lower, {side, next});
            side = next;
        }
    });
    report.holes = count_parts(report.open, mesh.vertex_count());
    return report;
}

double signed_volume(const io::TriangleMesh& mesh) {
    Bounds box = no_bounds;
    const auto for_each = [&](auto take) {
        for_each_triangle(mesh, [&](std::int64_t, const Triangle& triangle) { take(triangle.point); });
    };
    for_each([&](const auto& p) {
        for (const Vec3d& corner : p) box.widen(corner);
    });
    const Vec3d middle = 0.5 * box.low + 0.5 * box.high, half = box.high - middle;
    // Scales coordinates by a power of two, so that products of three coordinates do not overflow unless the volume
    // does.
    const int exponent = std::ilogb(max(max(half.x, half.y), max(half.z, 0x1p-1000)));
    const double scale = std::ldexp(1.0, -exponent);
    double volume = 0, lost = 0;  // Neumaier's compensated sum
    for_each([&](const auto& p) {
        const double part = dot(scale * (p[0] - middle), cross(scale * (p[1] - middle), scale * (p[2] - middle))) / 6,
                     sum = volume + part;
        lost += std::abs(volume) >= std::abs(part) ? (volume - sum) + part : (part - sum) + volume;
        volume = sum;
    });
    return std::ldexp(volume + lost, 3 * exponent);
}

std::vector<std::int32_t> degenerate_triangles(const io::TriangleMesh& mesh) {
    std::vector<std::int32_t> result;
    for_each_triangle(mesh, [&](std::int64_t t, const Triangle& triangle) {
        if (is_degenerate(triangle)) result.push_back(static_cast<std::int32_t>(t));
    });
    return result;
}

std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh) {
    io::TriangleMesh welded = mesh;
    io::weld(welded);
    struct UpperCorners {
        std::int32_t middle, highest, triangle;
        auto operator<=>(const UpperCorners&) const = default;
    };
    ByVertex<UpperCorners> all(welded.vertex_count(), [&](auto add) {
        for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
            const std::int32_t* const c = corners_of(welded, t);
            const auto [low, high] = std::minmax({c[0], c[1], c[2]});
            const std::int32_t middle = std::max(std::min(c[0], c[1]), std::min(std::max(c[0], c[1]), c[2]));
            add(low, {middle, high, static_cast<std::int32_t>(t)});
        }
    });
    std::vector<std::int32_t> result;
    all.for_each_group([&](std::int32_t, std::span<UpperCorners> group) {
        std::sort(group.begin(), group.end());
        for (std::size_t i = 1; i < group.size(); ++i)
            if (group[i].middle == group[i - 1].middle && group[i].highest == group[i - 1].highest)
                result.push_back(group[i].triangle);
    });
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace crumple::checks
