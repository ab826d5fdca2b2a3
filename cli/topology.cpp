#include "cli/topology.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "geometry/predicates.h"
#include "io/weld.h"
#include "questions/intersect/contact.h"

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
        const int turn = orient2d_filtered(a, b, c, axis);
        if (turn == 1 || turn == -1) return false;
    }
    // What a triangle has in common with itself is itself: an area, or less.
    return contact(triangle, triangle).count < 3;
}

}  // namespace

std::int32_t label_components(const io::TriangleMesh& mesh, std::vector<std::int32_t>& labels) {
    // Disjoint sets of vertices, each named by its lowest.
    std::vector<std::int32_t> sets(static_cast<std::size_t>(mesh.vertex_count()));
    std::iota(sets.begin(), sets.end(), 0);
    std::int32_t* const parent = sets.data();
    const auto root = [&](std::int32_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(mesh, t);
        for (int k = 1; k < 3; ++k) {
            const std::int32_t p = root(c[0]), q = root(c[k]);
            parent[std::max(p, q)] = std::min(p, q);
        }
    }
    std::vector<std::int32_t> number(sets.size(), -1);
    std::int32_t count = 0;
    labels.resize(static_cast<std::size_t>(mesh.triangle_count()));
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        std::int32_t& label = number[static_cast<std::size_t>(root(*corners_of(mesh, t)))];
        if (label < 0) label = count++;
        labels[static_cast<std::size_t>(t)] = label;
    }
    return count;
}

EdgeCounts count_edges(const io::TriangleMesh& mesh) {
    std::vector<std::pair<std::int32_t, std::int32_t>> edges;
    edges.reserve(mesh.triangles.size());
    for (std::int64_t t = 0; t < mesh.triangle_count(); ++t) {
        const std::int32_t* const c = corners_of(mesh, t);
        for (int k = 0; k < 3; ++k) {
            const auto edge = std::minmax(c[k], c[(k + 1) % 3]);
            if (edge.first != edge.second) edges.emplace_back(edge);
        }
    }
    std::sort(edges.begin(), edges.end());
    EdgeCounts counts;
    for (auto edge = edges.begin(); edge != edges.end();) {
        const auto next = std::find_if(edge, edges.end(), [&](const auto& other) { return other != *edge; });
        counts.open += next - edge == 1;
        counts.non_manifold += next - edge > 2;
        edge = next;
    }
    return counts;
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
