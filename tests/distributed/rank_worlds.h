#pragma once

// World whose bodies are distributed over ranks, and comparison of a rank's rows with those of a single detector.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "distributed/feature_rows.h"

namespace crumple::test {

/// Bodies of one rank, with the shapes that they need, and their ids.
class WorldPiece {
   public:
    WorldPiece(const World& whole, Distribution how, int rank, int ranks) : whole_(whole) {
        const auto n = static_cast<std::int64_t>(whole.bodies.size());
        std::map<std::int32_t, std::int32_t> local;
        // If the distribution is random, bodies are in descending order of ids, since ids may come in any order.
        for (std::int64_t i = 0; i < n; ++i) {
            const std::int64_t b = how == Distribution::random ? n - 1 - i : i;
            if (rank_of_triangle(how, b, n, ranks) != rank) continue;
            Body body = whole.bodies[static_cast<std::size_t>(b)];
            const auto [at, added] = local.try_emplace(body.shape, static_cast<std::int32_t>(shapes.size()));
            if (added) shapes.push_back(whole.shapes[static_cast<std::size_t>(body.shape)]);
            body.shape = at->second;
            bodies.push_back(body);
            ids.push_back(b);
        }
        follow(whole);
    }
    /// Updates the poses to those of the same world at another time.
    void follow(const World& whole) {
        const auto take = [&](std::span<const Pose> all, std::vector<Pose>& mine) {
            mine.clear();
            for (const std::int64_t b : ids)
                if (!all.empty()) mine.push_back(all[static_cast<std::size_t>(b)]);
        };
        take(whole.poses, poses);
        take(whole.end_poses, end_poses);
    }
    LocalWorld local() const { return {{shapes, bodies, poses, end_poses}, ids}; }
    bool has(std::int32_t body) const { return std::find(ids.begin(), ids.end(), body) != ids.end(); }

    std::vector<Shape> shapes;
    std::vector<Body> bodies;
    std::vector<Pose> poses, end_poses;
    std::vector<std::int64_t> ids;

   private:
    World whole_;
};

/// Compares a rank's rows with those rows of the whole result, in order, whose first body is one of the rank's.
inline testing::AssertionResult rows_are(const DistributedIntersections& rows, const WorldPiece& piece,
                                         const Intersections& whole) {
    std::vector<BodyPair> bodies;
    std::vector<Pair> pairs;
    Contacts contacts;
    const bool has_contacts = !whole.contacts.offsets.empty();
    if (has_contacts) contacts.offsets.push_back(0);
    for (std::size_t i = 0; i < whole.bodies.size(); ++i) {
        if (!piece.has(whole.bodies[i].first)) continue;
        bodies.push_back(whole.bodies[i]);
        if (!whole.pairs.empty()) pairs.push_back(whole.pairs[i]);
        if (!has_contacts) continue;
        contacts.kinds.push_back(whole.contacts.kinds[i]);
        for (std::int64_t p = whole.contacts.offsets[i]; p < whole.contacts.offsets[i + 1]; ++p)
            contacts.points.push_back(whole.contacts.points[p]);
        contacts.offsets.push_back(static_cast<std::int64_t>(contacts.points.size()));
    }
    if (rows.any != whole.any || rows.count != whole.count)
        return testing::AssertionFailure()
               << "any " << rows.any << ", count " << rows.count << " instead of " << whole.any << ", " << whole.count;
    if (!std::equal(rows.bodies.begin(), rows.bodies.end(), bodies.begin(), bodies.end()))
        return testing::AssertionFailure() << "other bodies";
    auto same = same_pairs(rows.pairs.span(), pairs);
    if (same) same = same_bytes(rows.contacts.kinds, contacts.kinds, "contact kinds");
    if (same) same = same_bytes(rows.contacts.offsets, contacts.offsets, "contact offsets");
    return same ? same_bytes(rows.contacts.points, contacts.points, "contact points") : same;
}

/// Compares a rank's rows of impacts or proximities in the same way. Checks that the rank lists the edges of these
/// rows.
template <class Rows, class Result>
testing::AssertionResult feature_rows_are(const Rows& rows, const WorldPiece& piece, const Result& whole) {
    for (std::size_t k = 0; k < feature_kinds; ++k) {
        const auto &found = rows.lists[k], &expected = whole.lists[k];
        std::size_t i = 0;
        for (std::size_t j = 0; j < expected.pairs.size(); ++j) {
            const BodyPair bodies = expected.bodies[j];
            const Pair pair = expected.pairs[j];
            if (!piece.has(bodies.first)) continue;
            if (i == found.pairs.size() || found.pairs[i] != pair || found.bodies[i] != bodies)
                return testing::AssertionFailure() << "kind " << k << ": no (" << pair.a << ", " << pair.b
                                                   << ") of bodies " << bodies.first << " and " << bodies.second;
            if (!same_values(found, i, expected, j))
                return testing::AssertionFailure() << "kind " << k << ": other values at " << i;
            ++i;
            if (static_cast<FeatureKind>(k) != FeatureKind::edge_edge) continue;
            for (const auto& [body, edge] : {std::pair(bodies.first, pair.a), std::pair(bodies.second, pair.b)}) {
                std::size_t e = 0;
                while (e < rows.edge_ids.size() && (rows.edge_bodies[e] != body || rows.edge_ids[e] != edge)) ++e;
                if (e == rows.edge_ids.size() || rows.edges[e] != whole.edges[whole.first_edge[body] + edge])
                    return testing::AssertionFailure() << "edge " << edge << " of body " << body << " is not told";
            }
        }
        if (i != found.pairs.size() || i != found.bodies.size())
            return testing::AssertionFailure() << "kind " << k << ": too many rows";
    }
    if (rows.count != whole.count || rows.any != whole.any)
        return testing::AssertionFailure() << rows.count << " rows over all ranks instead of " << whole.count;
    return testing::AssertionSuccess();
}

}  // namespace crumple::test
