#pragma once

// Steps of meshes, and comparison of a rank's rows of feature results with those of a single detector.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "distributed/rank_meshes.h"
#include "features/moving_soups.h"

namespace crumple::test {

/// A mesh, and the positions of its vertices at the end of a step.
struct Step {
    WholeMesh start, end;

    explicit Step(WholeMesh mesh, double extent = 0.1) : start(std::move(mesh)), end(start) {
        std::visit(
            [&](auto& xyz) {
                using Scalar = typename std::remove_cvref_t<decltype(xyz)>::value_type;
                for (std::size_t i = 0; i < xyz.size(); ++i)
                    xyz[i] = static_cast<Scalar>(static_cast<double>(xyz[i]) +
                                                 extent * std::sin(3.0 * static_cast<double>(i % 97) + 1));
            },
            end.vertices);
    }
    template <class Scalar>
    explicit Step(const MovingSoup<Scalar>& soup)
        : start(Soup<Scalar>{soup.start, soup.triangles, soup.groups}),
          end(Soup<Scalar>{soup.end, soup.triangles, soup.groups}) {}
    VertexView end_view() const { return end.view().vertices; }
};

/// Returns, for each vertex or edge that can be the first feature of `kind`, the lowest triangle that contains it.
template <class Result>
std::vector<std::int64_t> owner_of_first(const WholeMesh& mesh, const Result& whole, FeatureKind kind) {
    const bool edges = kind == FeatureKind::edge_edge;
    const std::size_t n = std::visit([](const auto& xyz) { return xyz.size() / 3; }, mesh.vertices);
    std::vector<std::int64_t> owner(edges ? whole.edges.size() : n, -1);
    for (std::int64_t t = mesh.triangles() - 1; t >= 0; --t)
        for (int k = 0; k < 3; ++k) {
            const std::int32_t a = mesh.corners[static_cast<std::size_t>(3 * t + k)],
                               b = mesh.corners[static_cast<std::size_t>(3 * t + (k + 1) % 3)];
            if (!edges) owner[static_cast<std::size_t>(a)] = t;
            if (!edges || a == b) continue;
            const Edge edge{std::min(a, b), std::max(a, b)};
            const auto at = std::lower_bound(whole.edges.begin(), whole.edges.end(), edge) - whole.edges.begin();
            owner[static_cast<std::size_t>(at)] = t;
        }
    return owner;
}

inline bool same_values(const ImpactList& found, std::size_t i, const ImpactList& whole, std::size_t j) {
    return std::memcmp(&found.toi[i], &whole.toi[j], sizeof(double)) == 0 && found.start[i] == whole.start[j];
}
inline bool same_values(const ProximityList& found, std::size_t i, const ProximityList& whole, std::size_t j) {
    if (found.type.empty() != whole.type.empty()) return false;
    const bool same = std::memcmp(&found.squared_distance[i], &whole.squared_distance[j], sizeof(double)) == 0 &&
                      found.touching[i] == whole.touching[j];
    return same && (whole.type.empty() || (found.type[i] == whole.type[j] &&
                                           std::memcmp(&found.at[i], &whole.at[j], sizeof whole.at[j]) == 0));
}

/// Compares a rank's rows with those rows of the whole result, in order, whose first feature is owned by one of the
/// rank's triangles (`ids`). Checks that the rank lists the edges of these rows.
template <class Rows, class Result>
testing::AssertionResult rows_are(const Rows& rows, std::vector<std::int64_t> ids, const Result& whole,
                                  const WholeMesh& mesh) {
    std::sort(ids.begin(), ids.end());
    std::int64_t count = 0;
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto kind = static_cast<FeatureKind>(k);
        const auto owner = owner_of_first(mesh, whole, kind);
        const auto &found = rows.lists[k], &expected = whole.lists[k];
        count += static_cast<std::int64_t>(expected.pairs.size());
        std::size_t i = 0;
        for (std::size_t j = 0; j < expected.pairs.size(); ++j) {
            const Pair pair = expected.pairs[j];
            if (!std::binary_search(ids.begin(), ids.end(), owner[static_cast<std::size_t>(pair.a)])) continue;
            if (i == found.pairs.size() || found.pairs[i] != pair)
                return testing::AssertionFailure()
                       << feature_kind_name(kind) << ": no (" << pair.a << ", " << pair.b << ")";
            if (!same_values(found, i, expected, j))
                return testing::AssertionFailure() << feature_kind_name(kind) << ": other values at " << i;
            if (kind == FeatureKind::edge_edge)
                for (const std::int32_t edge : {pair.a, pair.b}) {
                    const auto at = std::lower_bound(rows.edge_ids.begin(), rows.edge_ids.end(), edge);
                    if (at == rows.edge_ids.end() || *at != edge ||
                        rows.edges[at - rows.edge_ids.begin()] != whole.edges[edge])
                        return testing::AssertionFailure() << "edge " << edge << " is not told";
                }
            ++i;
        }
        if (i != found.pairs.size()) return testing::AssertionFailure() << feature_kind_name(kind) << ": too many rows";
    }
    if (rows.count != count || rows.any != whole.any)
        return testing::AssertionFailure() << rows.count << " rows over all ranks instead of " << count;
    return testing::AssertionSuccess();
}

}  // namespace crumple::test
