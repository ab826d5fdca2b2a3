// Lists of clusters, leaves and frames (Detector::cluster), from the arrays of stage `subdivide`.

#include <algorithm>
#include <bit>
#include <limits>

#include "backends/cpu/intersections/find_intersections.h"
#include "backends/cpu/stages/align.h"
#include "geometry/normaliser.h"

namespace crumple::cpu {
namespace {

using Vector = Clustering::Vector;

class ClusterLister {
   public:
    ClusterLister(const IntersectCall& call, Clustering& to)
        : call_(call),
          s_(call.buffers.subdivision),
          balls_(call.buffers.balls),
          normalise_(call.scene.low, call.scene.high),
          to_(to) {}

    void list_clusters() {
        const Centres& centres = call_.buffers.warm.level1;
        for (int k = 0; k < s_.clusters; ++k) to_.centres.push_back(in_scene(centres[k]));
        to_.offsets.push_back(0);
        for (std::int64_t t = 0; t < call_.scene.triangle_count(); ++t) {
            std::int32_t nearest = -1;
            double least = std::numeric_limits<double>::infinity();
            for (std::uint64_t mask = s_.mask1[t]; mask; mask &= mask - 1) {
                const auto k = std::countr_zero(mask);
                to_.clusters.push_back(k);
                const double d2 = squared_distance(t, centres[k]);
                if (d2 < least) least = d2, nearest = k;
            }
            to_.nearest_cluster.push_back(nearest);
            to_.offsets.push_back(static_cast<std::int64_t>(to_.clusters.size()));
        }
    }

    void list_leaves() {
        const auto n = static_cast<std::size_t>(call_.scene.triangle_count());
        to_.nearest_leaf.assign(n, -1);
        std::vector<double> least(n, std::numeric_limits<double>::infinity());
        std::vector<Leaf> leaves(s_.leaves.begin(), s_.leaves.end());
        std::sort(leaves.begin(), leaves.end(), [](const Leaf& a, const Leaf& b) {
            return a.cluster != b.cluster ? a.cluster < b.cluster : a.child < b.child;
        });
        to_.leaf_offsets.push_back(0);
        LeafMembers members(&call_.meter);
        for (const Leaf& leaf : leaves) {
            const auto index = static_cast<std::int32_t>(to_.leaf_cluster.size());
            const Vec3f centre = centre_of(leaf);
            members.gather(call_.scene, s_, leaf);
            for (std::int64_t i = 0; i < members.size(); ++i) {
                const std::int32_t t = members.triangle[i];
                to_.members.push_back(t);
                const double d2 = squared_distance(t, centre);
                const auto at = static_cast<std::size_t>(t);
                if (to_.nearest_cluster[at] != leaf.cluster || !(d2 < least[at])) continue;
                least[at] = d2;
                to_.nearest_leaf[at] = index;
            }
            to_.leaf_cluster.push_back(leaf.cluster);
            to_.leaf_centres.push_back(in_scene(centre));
            to_.leaf_offsets.push_back(static_cast<std::int64_t>(to_.members.size()));
            to_.axes.push_back(axes_of(members));
            call_.cancellation.check();
        }
        to_.complete = !s_.may_lose;
    }

   private:
    Vector in_scene(const Vec3f& p) const {
        const Vec3d x = normalise_.inverse({p.x, p.y, p.z});
        return {x.x, x.y, x.z};
    }
    double squared_distance(std::int64_t triangle, const Vec3f& centre) const {
        const Ball& ball = balls_[triangle];
        const Vec3d d = Vec3d{ball.x, ball.y, ball.z} - Vec3d{centre.x, centre.y, centre.z};
        return dot(d, d);
    }
    Vec3f centre_of(const Leaf& leaf) const {
        const WarmCentres& warm = call_.buffers.warm;
        return leaf.child < 0 ? warm.level1[leaf.cluster]
                              : warm.level2[static_cast<std::size_t>(leaf.cluster)][leaf.child];
    }
    std::array<Vector, 3> axes_of(const LeafMembers& members) const {
        std::array<Vector, 3> axes{};
        if (members.size() < 2) return axes;
        const LeafFrame frame = leaf_frame(balls_, call_.points(), call_.scene.corners, members, call_.options.method);
        for (std::size_t i = 0; i < 3; ++i) axes[i] = {frame.axis[i].x, frame.axis[i].y, frame.axis[i].z};
        return axes;
    }

    const IntersectCall& call_;
    const Subdivision& s_;
    const Array<Ball>& balls_;
    Normaliser normalise_;
    Clustering& to_;
};

}  // namespace

Clustering cluster(const IntersectCall& call) {
    Clustering clustering;
    call.leaves.ask({&call.query, call.decides, call.sink, call.enough, call.stream});
    measure(call);
    subdivide(call);
    ClusterLister lister(call, clustering);
    lister.list_clusters();
    lister.list_leaves();
    return clustering;
}

}  // namespace crumple::cpu
