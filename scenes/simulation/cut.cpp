#include "scenes/simulation/cut.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace crumple::scenes {
namespace {

using Edge = std::pair<std::int32_t, std::int32_t>;  // ascending

Edge edge_of(std::int32_t a, std::int32_t b) { return std::minmax(a, b); }

struct CutPoint {
    double share;                       // place on the edge: 0 at the end with the lower index
    bool open = true;                   // true if every triangle at the edge is cut through
    std::int32_t above = 0, below = 0;  // indices of the points on either side of the cut
};

class MeshSlicer {
   public:
    MeshSlicer(const Fabric& uncut, std::span<const Cut> cuts) : uncut_(uncut), cuts_(cuts) {}

    CutFabric run() {
        find_crossings();
        result_.fabric.spacing = uncut_.spacing;
        result_.fabric.flat = uncut_.flat;
        for (auto& [edge, crossing] : crossings_) make_points(edge, crossing);
        for (const Fabric::Corners& triangle : uncut_.triangles) split(triangle);
        return std::move(result_);
    }

   private:
    const std::array<double, 2>& flat(std::int32_t i) const { return uncut_.flat[static_cast<std::size_t>(i)]; }
    double height_above(const Cut& cut, std::int32_t i) const { return flat(i)[1] - cut.height(flat(i)[0]); }

    /// Returns the place at which a cut crosses the edge, 0 at its lower index and 1 at the other, or nothing.
    std::optional<double> share_of(Edge edge) const {
        constexpr double least = 0.1;  // least distance from either end, as a share of the edge, to avoid slivers
        for (const Cut& cut : cuts_) {
            const double a = height_above(cut, edge.first), b = height_above(cut, edge.second);
            if ((a < 0) == (b < 0)) continue;
            const double share = std::clamp(a / (a - b), least, 1 - least);
            const double u = flat(edge.first)[0] + share * (flat(edge.second)[0] - flat(edge.first)[0]);
            if (u < std::min(cut.from, cut.tip) || u > std::max(cut.from, cut.tip)) continue;
            return share;
        }
        return {};
    }

    void find_crossings() {
        for (const Fabric::Corners& t : uncut_.triangles) {
            int crossed = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Edge edge = edge_of(t[k], t[(k + 1) % 3]);
                const auto share = share_of(edge);
                if (!share) continue;
                crossings_.try_emplace(edge, CutPoint{.share = *share});
                ++crossed;
            }
            if (crossed != 1) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto found = crossings_.find(edge_of(t[k], t[(k + 1) % 3]));
                if (found != crossings_.end()) found->second.open = false;
            }
        }
    }

    void make_points(Edge edge, CutPoint& crossing) {
        const auto& p = flat(edge.first);
        const auto& q = flat(edge.second);
        const double s = crossing.share;
        const auto add = [&](bool below) {
            const auto id = static_cast<std::int32_t>(result_.fabric.flat.size());
            result_.fabric.flat.push_back({p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])});
            result_.made[{edge.first, edge.second, below}] = id;
            result_.shares.push_back(s);
            return id;
        };
        crossing.above = add(false);
        crossing.below = crossing.open ? add(true) : crossing.above;
    }

    const CutPoint* crossing_of(std::int32_t a, std::int32_t b) const {
        const auto found = crossings_.find(edge_of(a, b));
        return found == crossings_.end() ? nullptr : &found->second;
    }

    void split(const Fabric::Corners& t) {
        auto& triangles = result_.fabric.triangles;
        // Finds the corner a that is alone on its side of a cut or, if only one edge is crossed, that edge from a to b.
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
            const CutPoint *ab = crossing_of(a, b), *bc = crossing_of(b, c), *ca = crossing_of(c, a);
            if (!ab || bc) continue;
            if (!ca) {
                triangles.push_back({a, ab->above, c});
                triangles.push_back({ab->above, b, c});
                return;
            }
            const bool above = is_above(a, b);
            const auto near = [&](const CutPoint& x) { return above ? x.above : x.below; };
            const auto far = [&](const CutPoint& x) { return above ? x.below : x.above; };
            triangles.push_back({a, near(*ab), near(*ca)});
            triangles.push_back({far(*ab), b, c});
            triangles.push_back({far(*ab), c, far(*ca)});
            return;
        }
        triangles.push_back(t);
    }

    /// True if `a` is above the cut that crosses the edge between a and b.
    bool is_above(std::int32_t a, std::int32_t b) const {
        for (const Cut& cut : cuts_) {
            const bool below_a = height_above(cut, a) < 0, below_b = height_above(cut, b) < 0;
            if (below_a != below_b) return below_b;
        }
        return false;
    }

    const Fabric& uncut_;
    std::span<const Cut> cuts_;
    std::map<Edge, CutPoint> crossings_;
    CutFabric result_;
};

}  // namespace

CutFabric cut(const Fabric& uncut, std::span<const Cut> cuts) { return MeshSlicer(uncut, cuts).run(); }

void switch_fabric(ClothSolver& solver, const CutFabric& before, const CutFabric& after) {
    const std::vector<Vec3d> points = solver.points, velocities = solver.velocities;
    solver.set_fabric(after.fabric);
    const std::size_t uncut = after.fabric.flat.size() - after.made.size();
    for (const auto& made : after.made) {
        const auto& key = made.first;
        const auto to = static_cast<std::size_t>(made.second);
        const auto copy = [&](const std::vector<Vec3d>& from, std::vector<Vec3d>& into) {
            auto old = before.made.find(key);
            if (old == before.made.end()) old = before.made.find({key.low, key.high, false});
            if (old != before.made.end()) {
                into[to] = from[static_cast<std::size_t>(old->second)];
            } else {
                const double s = after.shares[to - uncut];
                into[to] =
                    (1 - s) * from[static_cast<std::size_t>(key.low)] + s * from[static_cast<std::size_t>(key.high)];
            }
        };
        copy(points, solver.points);
        copy(velocities, solver.velocities);
    }
}

}  // namespace crumple::scenes
