#pragma once

// Float64 filter: computes when two moving features first touch, in float64 and double words (unevaluated sums of two
// float64 numbers), with proven bounds; the result is `unknown` if the bounds do not decide. All other results are
// those of exact_impact.h, bit for bit. Accepts any coordinates; NaN and infinity give `unknown`. Compiled for host and
// device. The derivation is in docs/motion_filters.md.
//
// The volume (volume.h) is 0 whenever the features touch. Its roots are visited in ascending order. Each is isolated by
// signs, enclosed by Newton's method, and skipped if the features certainly do not touch at that time. If they
// certainly touch, the enclosure is narrowed, with the volume in double words, until the root can be rounded.
//
// Cost: 60 ns if surely_apart.h decides, 200 ns more with roots at which nothing touches, 400 ns for an impact.

#include "exact/impact/start_contact.h"
#include "exact/impact/surely_apart.h"
#include "exact/impact/volume_roots.h"

namespace crumple {

enum class Certainty { apart, meets, unknown };

struct FilteredImpact {
    Certainty verdict = Certainty::unknown;
    double toi = 0;      ///< as Impact::toi, if `verdict` is `meets`
    bool start = false;  ///< as Impact::start, if `verdict` is `meets`
};

namespace detail {

/// True if all points but `other` stay in one plane perpendicular to an axis at all times, and `other` is certainly not
/// in it near t. Then, near t, the volume is 0 only where these three points are collinear.
CRUMPLE_HD inline bool on_one_line(const FourPoints& points, std::size_t other, double t, double share, double slack) {
    const MovingPoint &p = points[(other + 1) % 4], &q = points[(other + 2) % 4], &r = points[(other + 3) % 4];
    for (int i = 0; i < 3; ++i) {
        if (p.start[i] != q.start[i] || p.start[i] != r.start[i] || p.end[i] != q.end[i] || p.end[i] != r.end[i])
            continue;
        const double start = points[other].start[i] - p.start[i], end = points[other].end[i] - p.end[i];
        if (std::abs(lerp(start, end, t)) > share * max(std::abs(start), std::abs(end)) + slack) return true;
    }
    return false;
}

/// Returns 1 if the features touch wherever the volume is 0 within `radius` of t, −1 if they do not, 0 if neither is
/// certain.
template <FeaturePair pair>
CRUMPLE_HD inline int touch(const FourPoints& points, const Approach<pair>& x, double t, double radius) {
    // Bound on the error of components of u, v and w, relative to their reach.
    const double share = 5 * epsilon + 2 * radius;
    const Vec3d u = x.u.at(t), v = x.v.at(t), w = x.w.at(t), n = cross(u, v), size = abs(n);
    const int k = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    const int i = first_axis(k), j = second_axis(k);
    const auto product = [&](const Vec3d& p, const Vec3d& q) { return p[i] * q[j] - p[j] * q[i]; };
    const auto bound = [&](const Vec3d& p, const Vec3d& q) {
        return 4 * share * (p[i] * q[j] + p[j] * q[i]) + x.slack;
    };
    const double whole = size[k], whole_bound = bound(x.extent_u, x.extent_v);
    if (!(whole > whole_bound)) {
        // Nearly parallel edges, or a nearly degenerate face.
        const Vec3d way = between_middles<pair>(u, v, w);
        const double off = 3 * share * dot(abs(way), x.extent_u + x.extent_v + x.extent_w) + x.slack;
        return side<pair>(dot(way, u), dot(way, v), dot(way, w), off) != 0 ? -1 : 0;
    }

    // The vertex is at (alpha u + beta v) / whole; edges meet at their parameters alpha / whole and beta / whole.
    const double forwards = n[k] > 0 ? 1 : -1;
    const double alpha = forwards * product(w, v), alpha_bound = bound(x.extent_w, x.extent_v);
    const double beta = (pair == FeaturePair::vertex_face ? forwards : -forwards) * product(u, w);
    const double beta_bound = bound(x.extent_u, x.extent_w);
    // If a value is 0, the three points other than `other` are collinear.
    const auto inside = [&](double value, double off, std::size_t other) {
        if (value > off) return 1;
        if (value < -off) return -1;
        return on_one_line(points, other, t, share, x.slack) ? 1 : 0;
    };
    if constexpr (pair == FeaturePair::vertex_face) {
        return min(min(inside(alpha, alpha_bound, 2), inside(beta, beta_bound, 3)),
                   inside(whole - alpha - beta, whole_bound + alpha_bound + beta_bound, 1));
    } else {
        return min(min(inside(alpha, alpha_bound, 1), inside(whole - alpha, whole_bound + alpha_bound, 0)),
                   min(inside(beta, beta_bound, 3), inside(whole - beta, whole_bound + beta_bound, 2)));
    }
}

}  // namespace detail

/// Computes the first impact of features that surely_apart() does not decide. Requires x.in_range().
template <FeaturePair pair>
CRUMPLE_HD inline FilteredImpact first_impact(const FourPoints& points, const Approach<pair>& x, const Volume& volume) {
    if (volume.sign_at_start() == 0) {
        if (vertices_touch_at_start<pair>(points)) return {Certainty::meets, 0, true};
        return {detail::separated_beside_an_edge(x) ? Certainty::apart : Certainty::unknown};
    }
    VolumeRoots roots(volume);
    for (;;) {
        RootBracket bracket;
        const VolumeRoots::Next next = roots.next(bracket);
        if (next == VolumeRoots::Next::none) return {Certainty::apart};
        RootEnclosure root;
        if (next == VolumeRoots::Next::unknown || !enclose(volume, bracket, root)) return {};
        int touching = detail::touch(points, x, root.middle, root.radius);
        if (touching < 0) continue;
        double toi = 0;
        const bool rounded = round_down(points, x, volume, root, toi);
        if (rounded && touching == 0) touching = detail::touch(points, x, root.middle, root.radius);
        if (touching < 0) continue;
        if (!rounded || touching == 0) return {};
        return {Certainty::meets, toi};
    }
}

template <FeaturePair pair>
CRUMPLE_HD inline FilteredImpact filtered_impact(const FourPoints& points) {
    const Approach<pair> x(points);
    if (!x.in_range()) return {};
    const Volume volume(x);
    if (surely_apart(x, volume)) return {Certainty::apart};
    return first_impact(points, x, volume);
}

}  // namespace crumple
