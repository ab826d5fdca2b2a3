#pragma once

// Membership of triangles in the public parts of a scene (crumple/part.h; sec. 1.1 of [MZ], the paper cited in
// ARCHITECTURE.md; rule and proof in docs/subdivide.md).
//
// The parts are the leaves of a tree: centres of the first level split the scene, and those of a further level split
// each cluster of the level above. Following a triangle down the tree takes only its own coordinates, the scene's box
// and the centres, so a machine that has some of the triangles finds the parts of these without the others.
//
// Machines that search different parts must agree on every bit of every mask, so this is plain float64 arithmetic
// without contraction, the same on every processor. Compiled for host and device.
//
// Layout: the nodes of a level are the children of the nodes of the level above, in order; those of the last level are
// the parts.

#include <bit>
#include <cstdint>

#include "geometry/inflation.h"
#include "geometry/normaliser.h"
#include "geometry/triangle.h"
#include "partition/fuzzy_c_means.h"
#include "partition/levels.h"

namespace crumple {

/// Ball that determines a triangle's membership, in normalised coordinates: around the centroid of its corners or, if
/// it moves, of its corners at the start and at the end. It contains the triangle, or its swept volume widened for the
/// query; the radius of a widened ball is at most `farthest`.
struct PartBall {
    Vec3d centre;
    double radius;

    CRUMPLE_HD PartBall(const Triangle& triangle, const Normaliser& normalise) {
        const Vec3d p[3] = {normalise(triangle.point[0]), normalise(triangle.point[1]), normalise(triangle.point[2])};
        centre = (1.0 / 3.0) * (p[0] + p[1] + p[2]);
        double r2 = 0;
        for (const Vec3d& corner : p) r2 = max(r2, dot(corner - centre, corner - centre));
        radius = std::sqrt(r2);
    }

    /// Constructs the ball of a triangle's swept volume from the start to the end of a step, widened by `half`, and by
    /// `path_share` times the longest path of a corner (inflation.h). The radius is at most `farthest`.
    CRUMPLE_HD PartBall(const Triangle& start, const Vec3d (&end)[3], double half, double path_share,
                        const Normaliser& normalise) {
        const Vec3d p[6] = {normalise(start.point[0]), normalise(start.point[1]), normalise(start.point[2]),
                            normalise(end[0]),         normalise(end[1]),         normalise(end[2])};
        centre = (1.0 / 6.0) * ((p[0] + p[1] + p[2]) + (p[3] + p[4] + p[5]));
        double r2 = 0, way2 = 0;
        for (const Vec3d& corner : p) r2 = max(r2, dot(corner - centre, corner - centre));
        for (int k = 0; k < 3; ++k) way2 = max(way2, dot(p[3 + k] - p[k], p[3 + k] - p[k]));
        radius = min(double{farthest}, std::sqrt(r2) + half + path_share * std::sqrt(way2));
    }
};

/// Centres of a node's children in normalised coordinates: float32 numbers, stored as float64.
struct PartSiblings {
    double x[max_clusters], y[max_clusters], z[max_clusters];

    CRUMPLE_HD Vec3d centre(int k) const { return {x[k], y[k], z[k]}; }
};

/// View of a tree of centres; PartCentres (part_centres.h) owns the arrays.
struct PartTree {
    struct ClusterLevel {
        const std::int32_t* first;    ///< nodes of this level that are children of node i: [first[i], first[i + 1])
        const PartSiblings* centres;  ///< 1 per node of the level above: centres of its children
        const double* apart;          ///< max_clusters per child: its distance from each of its siblings
    };
    Normaliser normalise;
    int depth = 0;
    ClusterLevel level[max_levels];

    /// Returns a mask: bit k is set if the ball may contain a point whose nearest centre, of those of all children of
    /// `node`, is that of the k-th child. `l`: the children's level. Lowers `slack`, if not null, to at most the
    /// distance that each corner of the triangle may move before the ball may reach a further child.
    CRUMPLE_HD std::uint64_t mask(const PartBall& ball, int l, std::int32_t node, double* slack = nullptr) const {
        const std::int32_t first = level[l].first[node], count = level[l].first[node + 1] - first;
        const PartSiblings& centres = level[l].centres[node];
        double distance2[max_clusters];
        for (std::int32_t k = 0; k < count; ++k) {
            const double dx = ball.centre.x - centres.x[k], dy = ball.centre.y - centres.y[k],
                         dz = ball.centre.z - centres.z[k];
            distance2[k] = dx * dx + dy * dy + dz * dz;
        }
        std::int32_t nearest = 0;
        double least = INFINITY;
        for (std::int32_t k = 0; k < count; ++k)
            if (distance2[k] < least) nearest = k, least = distance2[k];
        // A looser rule is tested first, because it is one comparison: no point of the ball can be nearest to a centre
        // that is farther from the ball's centre than the nearest one by more than the ball's diameter. The few centres
        // that pass are tested by the bisector rule (docs/subdivide.md). The slacks cover about fifteen roundings of
        // numbers of at most 28 in the bisector rule, and thirty of numbers of at most 133 in the looser one. Of
        // several nearest centres at one position, `nearest` is the lowest; the triangle joins only that.
        const double* apart = level[l].apart + static_cast<std::int64_t>(first + nearest) * max_clusters;
        const double reach = std::sqrt(least) + 2 * ball.radius;
        const double farthest = reach * reach + 1e-12;
        std::uint64_t mask = 0;
        for (std::int32_t k = 0; k < count; ++k) {
            const double d2 = distance2[k];
            if (k > nearest && apart[k] == 0) continue;
            if (d2 > farthest || d2 - least > 2 * ball.radius * apart[k] + 1e-13 * (1 + d2)) {
                // `gap` is the distance of the ball from the bisecting plane of both centres. If corners move by s, the
                // ball's centre moves by at most s, and its radius grows by at most 2 s.
                if (slack) {
                    const double gap = (d2 - least - 1e-12 * (1 + d2)) / (2 * apart[k]) - ball.radius;
                    *slack = min(*slack, gap / 3);
                }
                continue;
            }
            mask |= std::uint64_t{1} << k;
        }
        return mask;
    }

    /// Calls visit(part, masks) for each part that the ball's triangle belongs to, in ascending order, with one mask
    /// per level. `slack`: see mask().
    template <class Visit>
    CRUMPLE_HD void for_each_part(const PartBall& ball, Visit visit, double* slack = nullptr) const {
        std::uint64_t masks[max_levels];
        std::int32_t node[max_levels] = {}, next[max_levels] = {};  // next child to visit
        int l = 0;
        masks[0] = mask(ball, 0, 0, slack);
        while (l >= 0) {
            if (next[l] == max_clusters || masks[l] >> next[l] == 0) {
                --l;
                continue;
            }
            const std::int32_t k = next[l]++;
            if (!(masks[l] >> k & 1)) continue;
            const std::int32_t child = level[l].first[node[l]] + k;
            if (l + 1 == depth) {
                visit(child, static_cast<const std::uint64_t*>(masks));
            } else {
                ++l;
                node[l] = child;
                next[l] = 0;
                masks[l] = mask(ball, l, child, slack);
            }
        }
    }
};

}  // namespace crumple
