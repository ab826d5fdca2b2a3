#include "cli/topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "exact/intersection/contact.h"
#include "geometry/predicates.h"
#include "io/meshes/weld.h"
#include "scene/placement.h"

namespace crumple::cli {
namespace {

const std::int32_t* corners_of(const io::TriangleMesh& mesh, std::int64_t t) { return mesh.triangles.data() + 3 * t; }

Triangle triangle_of(const io::TriangleMesh& mesh, std::int64_t t) {
    const std::int32_t* const c = corners_of(mesh, t);
    Triangle triangle{{}, {c[0], c[1], c[2]}};
    std::visit(
        [&](const auto& xyz) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto* const p = xyz.data() + 3 * std::int64_t{c[k]};
                triangle.point[k] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
            }
        },
        mesh.vertices);
    return triangle;
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

namespace {

/// Disjoint sets of vertices, each represented by its lowest vertex.
class DisjointSets {
   public:
    explicit DisjointSets(std::int64_t count) : parents_(static_cast<std::size_t>(count)) {
        std::iota(parents_.begin(), parents_.end(), 0);
    }
    std::int32_t root(std::int32_t v) {
        while (parent(v) != v) v = parent(v) = parent(parent(v));
        return v;
    }
    void join(std::int32_t a, std::int32_t b) {
        const std::int32_t p = root(a), q = root(b);
        parent(std::max(p, q)) = std::min(p, q);
    }

   private:
    std::int32_t& parent(std::int32_t v) { return parents_[static_cast<std::size_t>(v)]; }

    std::vector<std::int32_t> parents_;
};

}  // namespace

std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels) {
    DisjointSets sets(mesh.vertex_count());
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(mesh, t);
        sets.join(c[0], c[1]);
        sets.join(c[0], c[2]);
    }
    std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.vertex_count()), -1);
    std::int32_t count = 0;
    labels.resize(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        std::int32_t& label = number[static_cast<std::size_t>(sets.root(*corners_of(mesh, t)))];
        if (label < 0) label = count++;
        labels[static_cast<std::size_t>(t)] = label;
    }
    return count;
}

namespace {

/// Side of a triangle: the edge, and the direction in which the triangle's corners run along it.
struct DirectedSide {
    Edge edge;     ///< the edge with its lower vertex first: a < b
    bool upwards;  ///< true if the triangle runs from a to b
    std::int32_t triangle;
};

/// Returns two triangles that run along an edge in the same direction, or nothing if as many triangles run along it in
/// one direction as in the other. `sides`: all sides of triangles at this edge.
std::optional<FlippedEdge> find_flipped(std::span<const DirectedSide> sides) {
    const auto up = std::count_if(sides.begin(), sides.end(), [](const DirectedSide& side) { return side.upwards; });
    if (2 * up == std::ssize(sides)) return std::nullopt;
    const bool most = 2 * up > std::ssize(sides);
    const auto same = [&](const DirectedSide& side) { return side.upwards == most; };
    const auto first = std::find_if(sides.begin(), sides.end(), same);
    const auto second = std::find_if(first + 1, sides.end(), same);
    return FlippedEdge{first->edge, first->triangle, second->triangle};
}

std::int64_t count_parts(const std::vector<Edge>& edges, std::int64_t vertices) {
    DisjointSets sets(vertices);
    for (const Edge& edge : edges) sets.join(edge.a, edge.b);
    std::vector<std::int32_t> roots;
    roots.reserve(edges.size());
    for (const Edge& edge : edges) roots.push_back(sets.root(edge.a));
    std::sort(roots.begin(), roots.end());
    return std::unique(roots.begin(), roots.end()) - roots.begin();
}

}  // namespace

EdgeReport report_edges(const io::TriangleMesh& mesh) {
    std::vector<DirectedSide> sides;
    sides.reserve(mesh.triangles.size());
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(mesh, t);
        for (int k = 0; k < 3; ++k) {
            const std::int32_t a = c[k], b = c[(k + 1) % 3];
            if (a != b) sides.push_back({{std::min(a, b), std::max(a, b)}, a < b, static_cast<std::int32_t>(t)});
        }
    }
    std::stable_sort(sides.begin(), sides.end(),
                     [](const DirectedSide& p, const DirectedSide& q) { return p.edge < q.edge; });
    EdgeReport report;
    for (auto side = sides.begin(); side != sides.end();) {
        const auto next =
            std::find_if(side, sides.end(), [&](const DirectedSide& other) { return other.edge != side->edge; });
        const auto count = next - side;
        if (count == 1) report.open.push_back(side->edge);
        if (count > 2) ++report.non_manifold;
        if (count % 2) report.closed = false;
        if (count % 2 == 0 && !report.flipped) report.flipped = find_flipped({side, next});
        side = next;
    }
    report.holes = count_parts(report.open, mesh.vertex_count());
    return report;
}

double signed_volume(const io::TriangleMesh& mesh) {
    Bounds box = no_bounds;
    const auto for_each = [&](auto take) {
        for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) take(triangle_of(mesh, t).point);
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
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        if (is_degenerate(triangle_of(mesh, t))) result.push_back(static_cast<std::int32_t>(t));
    }
    return result;
}

std::vector<std::int32_t> duplicated_triangles(const io::TriangleMesh& mesh) {
    io::TriangleMesh welded = mesh;
    io::weld(welded);
    struct Corners {
        std::array<std::int32_t, 3> sorted;
        std::int32_t triangle;
        auto operator<=>(const Corners&) const = default;
    };
    std::vector<Corners> all;
    all.reserve(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(welded, t);
        all.push_back({{c[0], c[1], c[2]}, static_cast<std::int32_t>(t)});
        std::sort(all.back().sorted.begin(), all.back().sorted.end());
    }
    std::sort(all.begin(), all.end());
    std::vector<std::int32_t> result;
    for (std::size_t i = 1; i < all.size(); ++i) {
        if (all[i].sorted == all[i - 1].sorted) result.push_back(all[i].triangle);
    }
    std::sort(result.begin(), result.end());
    return result;
}

}  // namespace crumple::cli
