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

}  // namespace

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

const Stencils& NearContactFinder::find(std::span<const Vec3d> points, double radius) {
    const MeshView mesh = view(points);
    const ProximityQuery query{.radius = radius, .closest = true, .filter = rules_};
    contacts_ = stencils(mesh, detector_.find(mesh, query));
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
        if (contacts_.normal_from[i] != static_cast<std::uint8_t>(NormalFrom::none)) continue;
        const auto [a, b, c, d] = contacts_.vertices[i];
        throw Error(ErrorCode::invalid_argument, "the cloth touches itself or an obstacle at points " +
                                                     std::to_string(a) + ", " + std::to_string(b) + ", " +
                                                     std::to_string(c) + " and " + std::to_string(d));
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
        const MeshView step = mesh.moving_to(view(end).vertices);
        const Impacts& impacts = detector_.find(step, query);
        if (!impacts.any) return {toi, 1};
        if (round == 0) toi = impacts.first.toi;
        hold_back(step, impacts, start, end, held);
    }
    const FreeStep step = detector_.find(mesh.moving_to(view(end).vertices), FreeStepQuery{query});
    for (std::size_t i = 0; i < end.size(); ++i) {
        end[i] = {step.positions[3 * i], step.positions[3 * i + 1], step.positions[3 * i + 2]};
    }
    return {toi, step.share};
}

/// Changes `end` for points that would touch something: they only move half as far as to their first impact.
void NearContactFinder::hold_back(const MeshView& step, const Impacts& impacts, std::span<const Vec3d> start,
                                  std::span<Vec3d> end, std::span<const std::uint8_t> held) {
    constexpr double never = std::numeric_limits<double>::infinity();
    toi_.assign(end.size(), never);
    const Stencils rows = stencils(step, impacts);
    std::size_t row = 0;
    for (const ImpactList& list : impacts.lists) {
        for (const double toi : list.toi) {
            for (const std::int32_t point : rows.vertices[row]) {
                double& first = toi_[static_cast<std::size_t>(point)];
                first = std::min(first, toi);
            }
            ++row;
        }
    }
    for (std::size_t i = 0; i < end.size(); ++i) {
        if (toi_[i] != never && !held[i]) end[i] = start[i] + (0.5 * toi_[i]) * (end[i] - start[i]);
    }
}

}  // namespace crumple::scenes
