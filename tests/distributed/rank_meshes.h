#pragma once

// Local meshes of ranks, cut from one mesh, and comparison of a rank's rows with the whole result.

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "agreement/compare.h"
#include "crumple/distributed.h"
#include "crumple/io.h"
#include "soups.h"

namespace crumple::test {

/// Returns the number of pairs over all ranks.
template <class Detector>
std::int64_t count_pairs(Detector& detector, const LocalMesh& local, IntersectionQuery query = {}) {
    query.output = Output::count;
    return detector.find(local, query).count;
}

enum class Distribution : std::uint8_t { blocks, round_robin, random, all_on_one };
inline constexpr std::array every_distribution{Distribution::blocks, Distribution::round_robin, Distribution::random,
                                               Distribution::all_on_one};

struct WholeMesh {
    std::variant<std::vector<float>, std::vector<double>> vertices;  ///< three coordinates per vertex
    std::vector<std::int32_t> corners, groups;  ///< three vertex ids, and a group, per triangle; no groups: empty

    WholeMesh() = default;
    template <class Scalar>
    explicit WholeMesh(const Soup<Scalar>& soup) : groups(soup.groups) {
        std::vector<Scalar> xyz;
        for (const auto& p : soup.vertices) xyz.insert(xyz.end(), p.begin(), p.end());
        vertices = std::move(xyz);
        for (const auto& t : soup.triangles) corners.insert(corners.end(), t.begin(), t.end());
    }
    explicit WholeMesh(const io::TriangleMesh& mesh)
        : vertices(mesh.vertices), corners(mesh.triangles), groups(mesh.groups) {}
    std::int64_t triangles() const { return static_cast<std::int64_t>(corners.size() / 3); }
    MeshView view() const {
        return std::visit(
            [&](const auto& xyz) {
                return MeshView(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), corners.data(), triangles(),
                                groups);
            },
            vertices);
    }
};

inline int rank_of_triangle(Distribution how, std::int64_t t, std::int64_t triangles, int ranks) {
    switch (how) {
        case Distribution::blocks:
            return static_cast<int>(t * ranks / triangles);
        case Distribution::round_robin:
            return static_cast<int>(t % ranks);
        case Distribution::random:
            return static_cast<int>(std::mt19937(static_cast<unsigned>(t))() % static_cast<unsigned>(ranks));
        case Distribution::all_on_one:
            return ranks / 2;
    }
    return 0;
}

/// Local mesh of one rank, with ids. Rank 0 also has the vertices that no triangle uses.
class MeshPiece {
   public:
    MeshPiece(const WholeMesh& whole, Distribution how, int rank, int ranks) : whole_(&whole) {
        const std::int64_t m = whole.triangles();
        const std::size_t n = std::visit([](const auto& xyz) { return xyz.size() / 3; }, whole.vertices);
        std::vector<std::int32_t> local(n, -1);
        std::vector<bool> named(n, false);
        for (const std::int32_t v : whole.corners) named[static_cast<std::size_t>(v)] = true;
        const auto number = [&](std::size_t v) {
            if (local[v] < 0) {
                local[v] = static_cast<std::int32_t>(vertex_ids.size());
                vertex_ids.push_back(static_cast<std::int64_t>(v));
            }
            return local[v];
        };
        for (std::size_t v = 0; rank == 0 && v < n; ++v)
            if (!named[v]) number(v);
        // If the distribution is random, triangles are in descending order of ids, since ids may come in any order.
        for (std::int64_t i = 0; i < m; ++i) {
            const std::int64_t t = how == Distribution::random ? m - 1 - i : i;
            if (rank_of_triangle(how, t, m, ranks) != rank) continue;
            triangle_ids.push_back(t);
            for (int k = 0; k < 3; ++k)
                corners.push_back(number(static_cast<std::size_t>(whole.corners[static_cast<std::size_t>(3 * t + k)])));
            if (!whole.groups.empty()) groups.push_back(whole.groups[static_cast<std::size_t>(t)]);
        }
        follow();
    }
    /// Updates the coordinates to those that the whole mesh has now.
    void follow() {
        std::visit(
            [&](const auto& all) {
                std::remove_cvref_t<decltype(all)> xyz;
                for (const std::int64_t v : vertex_ids)
                    xyz.insert(xyz.end(), all.begin() + static_cast<std::ptrdiff_t>(3 * v),
                               all.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
                vertices = std::move(xyz);
            },
            whole_->vertices);
    }
    LocalMesh local() const {
        LocalMesh local;
        std::visit(
            [&](const auto& xyz) {
                local.mesh = MeshView(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), corners.data(),
                                      static_cast<std::int64_t>(corners.size() / 3), groups);
            },
            vertices);
        local.triangle_ids = triangle_ids;
        local.vertex_ids = vertex_ids;
        return local;
    }

    std::variant<std::vector<float>, std::vector<double>> vertices;
    std::vector<std::int32_t> corners, groups;
    std::vector<std::int64_t> triangle_ids, vertex_ids;

   private:
    const WholeMesh* whole_;
};

/// Compares a rank's rows with those rows of the whole result, in order, whose first triangle is one of the rank's
/// triangles (`ids`). If they are equal on each rank, the rows of all ranks are the whole result.
inline testing::AssertionResult rows_are(const DistributedIntersections& rows, std::vector<std::int64_t> ids,
                                         const Intersections& whole) {
    std::sort(ids.begin(), ids.end());
    std::vector<Pair> pairs;
    Contacts contacts;
    const bool has_contacts = !whole.contacts.offsets.empty();
    if (has_contacts) contacts.offsets.push_back(0);
    for (std::size_t i = 0; i < whole.pairs.size(); ++i) {
        if (!std::binary_search(ids.begin(), ids.end(), whole.pairs[i].a)) continue;
        pairs.push_back(whole.pairs[i]);
        if (!has_contacts) continue;
        contacts.kinds.push_back(whole.contacts.kinds[i]);
        for (std::int64_t p = whole.contacts.offsets[i]; p < whole.contacts.offsets[i + 1]; ++p)
            contacts.points.push_back(whole.contacts.points[p]);
        contacts.offsets.push_back(static_cast<std::int64_t>(contacts.points.size()));
    }
    if (rows.count != static_cast<std::int64_t>(whole.pairs.size()))
        return testing::AssertionFailure() << rows.count << " pairs over all ranks instead of " << whole.pairs.size();
    auto same = same_pairs(rows.pairs.span(), pairs);
    if (same) same = same_bytes(rows.contacts.kinds, contacts.kinds, "contact kinds");
    if (same) same = same_bytes(rows.contacts.offsets, contacts.offsets, "contact offsets");
    return same ? same_bytes(rows.contacts.points, contacts.points, "contact points") : same;
}

}  // namespace crumple::test
