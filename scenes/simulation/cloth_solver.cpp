#include "scenes/simulation/cloth_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "scenes/arithmetic.h"

namespace crumple::scenes {
namespace {

/// Edge of a triangle, with its ends in ascending order, and the triangle's opposite corner.
struct FabricSide {
    std::int32_t low, high, across;
};

std::vector<FabricSide> sides_of(std::span<const Fabric::Corners> triangles) {
    std::vector<FabricSide> sides;
    for (const Fabric::Corners& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t a = t[k], b = t[(k + 1) % 3];
            sides.push_back({std::min(a, b), std::max(a, b), t[(k + 2) % 3]});
        }
    }
    std::stable_sort(sides.begin(), sides.end(), [](const FabricSide& s, const FabricSide& t) {
        return std::pair(s.low, s.high) < std::pair(t.low, t.high);
    });
    return sides;
}

/// Returns the fraction of a tangential movement `way` that friction removes. `correction`: length of the correction
/// along the normal.
double friction_share(Vec3d way, double coefficient, double correction) {
    const double far = length(way);
    return far > 0 ? std::min(1.0, coefficient * correction / far) : 0;
}

}  // namespace

ClothSolver::ClothSolver(const Fabric& fabric, const ClothProperties& properties) : properties_(properties) {
    set_fabric(fabric);
}

void ClothSolver::set_fabric(const Fabric& fabric) {
    triangles_ = fabric.triangles;
    springs_.clear();
    // A chain of unit masses at distance h whose springs have stiffness k carries waves at h sqrt(k).
    const double h = fabric.spacing;
    const double shear = properties_.shear_speed * properties_.shear_speed / (h * h);
    const double bend = properties_.bend_speed * properties_.bend_speed / (h * h);
    const auto add = [&](std::int32_t a, std::int32_t b, bool across) {
        const auto& p = fabric.flat[static_cast<std::size_t>(a)];
        const auto& q = fabric.flat[static_cast<std::size_t>(b)];
        const double u = q[0] - p[0], v = q[1] - p[1], rest = std::sqrt(u * u + v * v);
        if (!(rest > 0)) return;
        const double bias = 2 * std::abs(u * v) / (rest * rest);  // 0 along warp and weft, 1 on the diagonal
        const double stiffness = across ? bend : bias < 0.5 ? std::numeric_limits<double>::infinity() : shear;
        springs_.push_back({a, b, rest, stiffness});
    };
    const std::vector<FabricSide> sides = sides_of(triangles_);
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const bool again = i > 0 && sides[i].low == sides[i - 1].low && sides[i].high == sides[i - 1].high;
        if (again) {
            add(sides[i - 1].across, sides[i].across, true);
        } else {
            add(sides[i].low, sides[i].high, false);
        }
    }
    points.resize(fabric.flat.size());
    velocities.resize(fabric.flat.size());
    held.resize(fabric.flat.size());
    obstacles_.clear();
    goals_.clear();
    friction_.clear();
    near_.reset();
}

void ClothSolver::add_obstacle(std::span<const Vec3d> at, std::span<const Fabric::Corners> triangles, double friction) {
    const auto first = static_cast<std::int32_t>(points.size());
    for (const auto& [a, b, c] : triangles) obstacles_.push_back({first + a, first + b, first + c});
    points.insert(points.end(), at.begin(), at.end());
    velocities.resize(points.size());
    held.resize(points.size(), 1);
    goals_.insert(goals_.end(), at.begin(), at.end());
    friction_.resize(goals_.size(), friction);
    near_.reset();
}

void ClothSolver::step(double dt, std::span<const Collider* const> bodies, double age) {
    pull(dt);
    for (const SelfContact& contact : contacts_) part(contact, age);
    push_out(bodies, dt);
    derive_velocities(dt);
}

StepLength ClothSolver::step_freely(double dt, int substeps) {
    if (!near_) near_.emplace(triangles_, obstacles_);
    const std::size_t cloth = points.size() - goals_.size();
    for (std::size_t i = 0; i < goals_.size(); ++i) velocities[cloth + i] = (1 / dt) * (goals_[i] - points[cloth + i]);
    double fastest = 0;
    for (const Vec3d& velocity : velocities) fastest = std::max(fastest, length(velocity));

    // Finds the pairs of features that may come closer than the thickness during the step. The few points that are too
    // fast for this search radius are stopped only by shorten().
    const double reach = std::min(2 * fastest * dt, properties_.thickness);
    const Stencils& contacts = near_->find(points, properties_.thickness + reach);
    start_ = points;
    const double h = dt / substeps;
    for (int i = 1; i <= substeps; ++i) {
        pull(h);
        for (std::size_t row = 0; row < contacts.size(); ++row) part(contacts, row, i * h);
        derive_velocities(h);
    }
    unshortened_ = points;
    const auto [toi, share] = near_->shorten(start_, points, held);
    std::size_t held_back = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i] == unshortened_[i]) continue;
        ++held_back;
        if (!held[i]) velocities[i] = (1 / dt) * (points[i] - start_[i]);
    }
    return {contacts.size(), toi, held_back, share};
}

void ClothSolver::pull(double dt) {
    predict(dt);
    for (const Spring& spring : springs_) keep_distance(spring, dt);
    for (std::size_t i = springs_.size(); i-- > 0;) keep_distance(springs_[i], dt);
}

void ClothSolver::derive_velocities(double dt) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!held[i]) velocities[i] = (1 / dt) * (points[i] - before_[i]);
    }
}

void ClothSolver::predict(double dt) {
    before_ = points;
    const double kept = std::max(0.0, 1 - properties_.drag * dt);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!held[i]) velocities[i] = kept * velocities[i] - Vec3d{0, 0, properties_.gravity * dt};
        points[i] = points[i] + dt * velocities[i];
    }
}

void ClothSolver::keep_distance(const Spring& spring, double dt) {
    const auto a = static_cast<std::size_t>(spring.a), b = static_cast<std::size_t>(spring.b);
    const double mobile_a = 1 - held[a], mobile_b = 1 - held[b];
    const double share = mobile_a + mobile_b + 1 / (spring.stiffness * dt * dt);
    const Vec3d way = points[b] - points[a];
    const double far = length(way);
    if (!(far > 0) || !(share > 0)) return;
    const Vec3d correction = ((far - spring.rest) / (far * share)) * way;
    points[a] = points[a] + mobile_a * correction;
    points[b] = points[b] - mobile_b * correction;
}

void ClothSolver::part(const SelfContact& contact, double age) {
    const auto p = static_cast<std::size_t>(contact.point);
    std::array<std::size_t, 3> t{};
    for (std::size_t k = 0; k < 3; ++k) t[k] = static_cast<std::size_t>(contact.triangle[k]);
    const auto meet = [&](const std::vector<Vec3d>& at) {
        return contact.weights[0] * at[t[0]] + contact.weights[1] * at[t[1]] + contact.weights[2] * at[t[2]];
    };
    const Vec3d normal = contact.side * normalised(cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]));
    const Vec3d apart = points[p] - meet(points);
    // Points that are too close to each other move apart slowly; else they would leave the contact at a high speed.
    const double wanted = std::min(properties_.thickness, contact.distance + properties_.separation_speed * age);
    const double correction = wanted - dot(normal, apart);
    if (!(correction > 0)) return;
    const Vec3d moved = apart - (before_[p] - meet(before_));
    const Vec3d slide = moved - dot(normal, moved) * normal;
    const Vec3d change = correction * normal - friction_share(slide, properties_.self_friction, correction) * slide;

    double share = 1 - held[p];
    for (std::size_t k = 0; k < 3; ++k) share += (1 - held[t[k]]) * contact.weights[k] * contact.weights[k];
    if (!(share > 0)) return;
    points[p] = points[p] + ((1 - held[p]) / share) * change;
    for (std::size_t k = 0; k < 3; ++k) {
        points[t[k]] = points[t[k]] - ((1 - held[t[k]]) * contact.weights[k] / share) * change;
    }
}

void ClothSolver::part(const Stencils& contacts, std::size_t row, double age) {
    const auto& vertices = contacts.vertices[row];
    const auto& weights = contacts.weights[row];
    const Vec3d normal{contacts.normals[row][0], contacts.normals[row][1], contacts.normals[row][2]};
    const auto between = [&](const std::vector<Vec3d>& at) {
        Vec3d sum{};
        for (std::size_t k = 0; k < 4; ++k) sum = sum + weights[k] * at[static_cast<std::size_t>(vertices[k])];
        return sum;
    };
    const Vec3d apart = between(points);
    const double wanted = std::min(properties_.thickness, contacts.distance[row] + properties_.separation_speed * age);
    const double correction = wanted - dot(normal, apart);
    if (!(correction > 0)) return;
    double share = 0;
    for (std::size_t k = 0; k < 4; ++k)
        share += (1 - held[static_cast<std::size_t>(vertices[k])]) * weights[k] * weights[k];
    if (!(share > 0)) return;
    // The largest of the points is one of an obstacle, if there is any.
    const auto last = static_cast<std::size_t>(*std::max_element(vertices.begin(), vertices.end()));
    const std::size_t cloth = points.size() - goals_.size();
    const double friction = last < cloth ? properties_.self_friction : friction_[last - cloth];
    const Vec3d moved = apart - between(before_);
    const Vec3d slide = moved - dot(normal, moved) * normal;
    const Vec3d change = correction * normal - friction_share(slide, friction, correction) * slide;
    for (std::size_t k = 0; k < 4; ++k) {
        const auto i = static_cast<std::size_t>(vertices[k]);
        points[i] = points[i] + ((1 - held[i]) * weights[k] / share) * change;
    }
}

void ClothSolver::push_out(std::span<const Collider* const> bodies, double dt) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (held[i]) continue;
        for (const Collider* const body : bodies) {
            const Nearest near = body->nearest(points[i]);
            const double depth = properties_.clearance - near.distance;
            if (!(depth > 0)) continue;
            const Vec3d moved = points[i] - before_[i] - dt * near.velocity;
            const Vec3d slide = moved - dot(near.normal, moved) * near.normal;
            points[i] = points[i] + depth * near.normal - friction_share(slide, body->friction, depth) * slide;
        }
    }
}

}  // namespace crumple::scenes
