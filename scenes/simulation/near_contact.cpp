#include "scenes/simulation/near_contact.h"

#include <algorithm>
#include <limits>
#include <string>

#include "crumple/error.h"
#include "scenes/arithmetic.h"

namespace crumple::scenes {
namespace {

constexpr std::int32_t cloth_group = 0, obstacle_group = 1;

/// Minimum fraction of its distance that a pair keeps during a step. If it came into contact, the next step would be
/// blocked from its start.
constexpr double least_distance = 0.1;

constexpr int iteration_limit = 10;  // maximum number of rounds in which single points are held back

std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }

}  // namespace

Vec3d NearContact::way(std::span<const Vec3d> positions) const {
    Vec3d sum{};
    for (std::size_t k = 0; k < points.size(); ++k) sum = sum + weights[k] * positions[index(points[k])];
    return sum;
}

NearContactFinder::NearContactFinder(std::span<const Fabric::Corners> cloth, std::span<const Fabric::Corners> obstacles)
    : triangles_(cloth.begin(), cloth.end()), groups_(cloth.size(), cloth_group) {
    triangles_.insert(triangles_.end(), obstacles.begin(), obstacles.end());
    groups_.resize(triangles_.size(), obstacle_group);
    rules_.excluded_groups = {{obstacle_group, obstacle_group}};
}

MeshView NearContactFinder::view(std::span<const Vec3d> points) const {
    return {points.empty() ? nullptr : &points.front().x, static_cast<std::int64_t>(points.size()),
            triangles_.empty() ? nullptr : triangles_.front().data(), static_cast<std::int64_t>(triangles_.size()),
            groups_};
}

std::span<const NearContact> NearContactFinder::find(std::span<const Vec3d> points, double radius) {
    ProximityQuery query;
    query.radius = radius;
    query.closest = true;
    query.filter = rules_;
    const Proximities& near = detector_.find(view(points), query);
    contacts_.clear();
    const auto add = [&](const std::array<std::int32_t, 4>& of, const std::array<double, 4>& weights, bool touching) {
        if (touching) {
            throw Error(ErrorCode::invalid_argument, "the cloth touches itself or an obstacle at points " +
                                                         std::to_string(of[0]) + ", " + std::to_string(of[1]) + ", " +
                                                         std::to_string(of[2]) + " and " + std::to_string(of[3]));
        }
        NearContact contact{of, weights};
        const Vec3d way = contact.way(points);
        contact.distance = length(way);
        if (!(contact.distance > 0)) return;  // rounded to 0: no direction; shorten() keeps the pair apart
        contact.direction = (1 / contact.distance) * way;
        contacts_.push_back(contact);
    };
    const ProximityList &of_vertices = near.vertex_faces(), &of_edges = near.edge_edges();
    for (std::size_t i = 0; i < of_vertices.pairs.size(); ++i) {
        const auto [vertex, face] = of_vertices.pairs[i];
        const auto [a, b, c] = triangles_[index(face)];
        const auto [u, v] = of_vertices.at[i];
        add({vertex, a, b, c}, {1, u + v - 1, -u, -v}, of_vertices.touching[i]);
    }
    for (std::size_t i = 0; i < of_edges.pairs.size(); ++i) {
        const auto [a, b] = near.edges[of_edges.pairs[i].a];
        const auto [c, d] = near.edges[of_edges.pairs[i].b];
        const auto [s, t] = of_edges.at[i];
        add({a, b, c, d}, {1 - s, s, t - 1, -t}, of_edges.touching[i]);
    }
    return contacts_;
}

NearContactFinder::FreePath NearContactFinder::shorten(std::span<const Vec3d> start, std::span<Vec3d> end,
                                                       std::span<const std::uint8_t> held) {
    ImpactQuery query;
    query.min_distance_share = least_distance;
    query.filter = rules_;
    const MeshView mesh = view(start);
    double toi = 1;
    for (int round = 0; round < iteration_limit; ++round) {
        const Impacts& impacts = detector_.find(mesh.moving_to(view(end).vertices), query);
        if (!impacts.any) return {toi, 1};
        if (round == 0) toi = impacts.first.toi;
        hold_back(impacts, start, end, held);
    }
    const FreeStep step = detector_.find(mesh.moving_to(view(end).vertices), FreeStepQuery{query});
    for (std::size_t i = 0; i < end.size(); ++i) {
        end[i] = {step.positions[3 * i], step.positions[3 * i + 1], step.positions[3 * i + 2]};
    }
    return {toi, step.share};
}

/// Changes `end` for points that would touch something: they only move half as far as to their first impact.
void NearContactFinder::hold_back(const Impacts& impacts, std::span<const Vec3d> start, std::span<Vec3d> end,
                                  std::span<const std::uint8_t> held) {
    constexpr double never = std::numeric_limits<double>::infinity();
    toi_.assign(end.size(), never);
    const auto meets = [&](std::int32_t point, double toi) { toi_[index(point)] = std::min(toi_[index(point)], toi); };
    const ImpactList &of_vertices = impacts.vertex_faces(), &of_edges = impacts.edge_edges();
    for (std::size_t i = 0; i < of_vertices.pairs.size(); ++i) {
        const auto [vertex, face] = of_vertices.pairs[i];
        meets(vertex, of_vertices.toi[i]);
        for (const std::int32_t corner : triangles_[index(face)]) meets(corner, of_vertices.toi[i]);
    }
    for (std::size_t i = 0; i < of_edges.pairs.size(); ++i) {
        for (const std::int32_t edge : {of_edges.pairs[i].a, of_edges.pairs[i].b}) {
            meets(impacts.edges[edge].a, of_edges.toi[i]);
            meets(impacts.edges[edge].b, of_edges.toi[i]);
        }
    }
    for (std::size_t i = 0; i < end.size(); ++i) {
        if (toi_[i] != never && !held[i]) end[i] = start[i] + (0.5 * toi_[i]) * (end[i] - start[i]);
    }
}

}  // namespace crumple::scenes
