#include "checks/self_overlaps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <unordered_map>

#include "base/disjoint_sets.h"
#include "checks/cut_shell.h"
#include "checks/triangle_set.h"

namespace crumple::checks {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Calls take(a, b, c) for each triangle of a fan of a piece.
template <class Take>
void for_each_triangle(const CutShell& shell, const CutShell::Patch& patch, Take take) {
    const auto point = [&](std::int32_t i) { return shell.points[static_cast<std::size_t>(i)]; };
    for (const std::int32_t i : patch.pieces) {
        const io::CutPiece& corners = shell.pieces[static_cast<std::size_t>(i)].corners;
        for (std::size_t k = 2; k < corners.size(); ++k)
            take(point(corners[0]), point(corners[k - 1]), point(corners[k]));
    }
}

/// Returns the volume of the cones over a patch, with signs.
double cones_of(const CutShell& shell, const CutShell::Patch& patch, const Vec3d& apex) {
    double cones = 0;
    for_each_triangle(shell, patch, [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        cones += dot(a - apex, cross(b - apex, c - apex)) / 6;
    });
    return cones;
}

/// Part of a patch, with the distances of its corners to other triangles.
struct PatchPart {
    std::array<Vec3d, 3> corner;
    std::array<TriangleSet::Nearest, 3> at;
    double bound;

    friend bool operator<(const PatchPart& a, const PatchPart& b) { return a.bound < b.bound; }
};

/// Finds bounds on the greatest distance of a patch to other triangles. The distance is 1-Lipschitz, and at most the
/// distance to one triangle, which is a convex function; search/depth/depth_piece.h derives the same bounds. Parts with
/// the largest bounds are halved.
class PatchDepth {
   public:
    explicit PatchDepth(const TriangleSet& others) : others_(others) {}

    /// Adds a triangle of the patch. `vertices`: numbers of its corners, which may have occurred before.
    void add(const std::array<Vec3d, 3>& corners, const std::array<std::int32_t, 3>& vertices) {
        PatchPart part{corners, {}, infinity};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [at, is_new] = known_.try_emplace(vertices[k]);
            if (is_new) at->second = others_.nearest(corners[k], last_);
            part.at[k] = at->second;
            last_ = part.at[k].triangle;
            reached_ = std::max(reached_, part.at[k].distance);
        }
        added_.push_back(part);
    }

    /// Returns the depth that some point has, and the one that no point exceeds.
    std::array<double, 2> refine(double tolerance) {
        constexpr std::size_t few = 1 << 13, most = 1 << 19;
        for (PatchPart& part : added_) push(part);
        for (std::size_t steps = 0; steps < most && !parts_.empty(); ++steps) {
            const double gap = parts_.top().bound - reached_;
            if (gap <= share * reached_ || (gap <= tolerance && steps >= few)) break;
            halve();
        }
        return {reached_, std::max({reached_, left_out_, parts_.empty() ? 0 : parts_.top().bound})};
    }

   private:
    static constexpr double share = 0.001;  ///< of the depth: smaller differences are not resolved

    void push(PatchPart& part) {
        tighten(part, [&](std::size_t k) {
            double longest = 0;
            for (const Vec3d& corner : part.corner) {
                const Vec3d side = corner - part.corner[k];
                longest = std::max(longest, std::sqrt(dot(side, side)));
            }
            return part.at[k].distance + longest;
        });
        tighten(part, [&](std::size_t k) {
            double greatest = 0;
            for (const Vec3d& corner : part.corner)
                greatest = std::max(greatest, others_.distance(corner, part.at[k].triangle));
            return greatest;
        });
        if (is_deep(part))
            parts_.push(part);
        else
            left_out_ = std::max(left_out_, part.bound);
    }
    bool is_deep(const PatchPart& part) const { return part.bound > (1 + share) * reached_; }
    /// Lowers the bound of a part to the least of three bounds, while it is above the depth that has been reached.
    template <class BoundAt>
    void tighten(PatchPart& part, BoundAt bound_at) const {
        for (std::size_t k = 0; k < 3 && is_deep(part); ++k) part.bound = std::min(part.bound, bound_at(k));
    }
    void halve() {
        PatchPart part = parts_.top();
        parts_.pop();
        std::size_t longest = 0;
        double most = -1;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d side = part.corner[(k + 1) % 3] - part.corner[k];
            if (dot(side, side) > most) longest = k, most = dot(side, side);
        }
        const std::size_t i = longest, j = (longest + 1) % 3;
        const Vec3d middle = 0.5 * part.corner[i] + 0.5 * part.corner[j];
        const TriangleSet::Nearest at = others_.nearest(middle, part.at[i].triangle);
        reached_ = std::max(reached_, at.distance);
        for (const std::size_t k : {i, j}) {
            PatchPart half = part;
            half.corner[k] = middle, half.at[k] = at;
            push(half);
        }
    }

    const TriangleSet& others_;
    std::vector<PatchPart> added_;
    std::priority_queue<PatchPart> parts_;
    std::unordered_map<std::int32_t, TriangleSet::Nearest> known_;  ///< by vertex
    std::int32_t last_ = -1;
    double reached_ = 0;
    double left_out_ = 0;  ///< greatest bound of the parts that were left out
};

class SelfOverlapSearch {
   public:
    SelfOverlapSearch(const CutShell& shell, bool outwards, double tolerance)
        : shell_(shell), outwards_(outwards), tolerance_(tolerance) {}

    std::vector<SelfOverlap> run(std::size_t places, double volume);

   private:
    /// Returns the factor of a patch in the volume that the shell covers more than once, ½ ∫ (w² − w) dx for winding
    /// numbers w: the integrand increases by w where the surface leads from w to w + 1. For a shell that faces inwards,
    /// the signs of w are exchanged.
    int weight_of(const CutShell::Patch& patch) const {
        return patch.places.empty() ? 0 : outwards_ ? patch.winding_outside : patch.winding_outside + 1;
    }
    /// True if both sides of a patch are inside the shell.
    bool is_measured(const CutShell::Patch& patch) const {
        return weight_of(patch) != 0 && patch.winding_outside != 0 && patch.winding_outside != -1;
    }
    Bounds box_near(const CutShell::Patch& patch) const;
    void find_triangles_near_patches();
    void measure_depth(const CutShell::Patch& patch, SelfOverlap& overlap) const;

    const CutShell& shell_;
    bool outwards_;
    double tolerance_;
    std::vector<std::int32_t> near_;  ///< triangles near covered patches, ascending
    std::optional<TriangleSet> near_set_;
};

std::vector<SelfOverlap> SelfOverlapSearch::run(std::size_t places, double volume) {
    DisjointSets sets(places);
    for (const CutShell::Patch& patch : shell_.patches)
        for (std::size_t i = 1; i < patch.places.size() && weight_of(patch) != 0; ++i)
            sets.join(patch.places[0], patch.places[i]);
    std::vector<SelfOverlap> overlaps(places);  // by least place
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(places); ++i)
        overlaps[static_cast<std::size_t>(sets.find(i))].places.push_back(i);
    double sum = 0;
    for (const CutShell::Patch& patch : shell_.patches) {
        if (weight_of(patch) == 0) continue;
        SelfOverlap& overlap = overlaps[static_cast<std::size_t>(sets.find(patch.places[0]))];
        const double part = weight_of(patch) * cones_of(shell_, patch, shell_.points[0]);
        overlap.is_contact = false;
        overlap.volume += part, sum += part;
    }
    if (!(std::abs(sum - volume) <= 1e-6 * std::abs(volume))) return {};
    find_triangles_near_patches();
    for (const CutShell::Patch& patch : shell_.patches)
        if (is_measured(patch)) measure_depth(patch, overlaps[static_cast<std::size_t>(sets.find(patch.places[0]))]);
    std::erase_if(overlaps, [](const SelfOverlap& overlap) { return overlap.places.empty(); });
    return overlaps;
}

/// Returns a box that contains the triangles that may be the nearest ones to points of a patch. Other triangles meet
/// the patch's border, so the nearest one is no farther away than the diagonal of the patch's box.
Bounds SelfOverlapSearch::box_near(const CutShell::Patch& patch) const {
    Bounds box = no_bounds;
    for_each_triangle(shell_, patch, [&](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        for (const Vec3d& p : {a, b, c}) box.widen(p);
    });
    const Vec3d extent = box.high - box.low;
    const double reach = std::sqrt(dot(extent, extent)) + shell_.tolerance;
    return {box.low - Vec3d{reach, reach, reach}, box.high + Vec3d{reach, reach, reach}};
}

void SelfOverlapSearch::find_triangles_near_patches() {
    Bounds box = no_bounds;
    for (const CutShell::Patch& patch : shell_.patches)
        if (is_measured(patch)) box.widen(box_near(patch));
    std::vector<TrianglePoints> triangles;
    for (std::int32_t t = 0; t < std::ssize(shell_.triangles); ++t) {
        TrianglePoints points;
        Bounds of = no_bounds;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t vertex = shell_.triangles[static_cast<std::size_t>(t)][k];
            points[k] = shell_.points[static_cast<std::size_t>(vertex)];
            of.widen(points[k]);
        }
        if (!overlap(of, box)) continue;
        near_.push_back(t);
        triangles.push_back(points);
    }
    if (!triangles.empty()) near_set_.emplace(std::move(triangles));
}

void SelfOverlapSearch::measure_depth(const CutShell::Patch& patch, SelfOverlap& overlap) const {
    std::vector<std::int32_t> own;  // ascending, as pieces are
    for (const std::int32_t i : patch.pieces) own.push_back(shell_.pieces[static_cast<std::size_t>(i)].triangle);
    std::vector<TrianglePoints> others;
    near_set_->for_each_near(box_near(patch), [&](std::int32_t i) {
        if (!std::binary_search(own.begin(), own.end(), near_[static_cast<std::size_t>(i)]))
            others.push_back((*near_set_)[i]);
    });
    if (others.empty()) return;
    const TriangleSet set(std::move(others));
    PatchDepth depth(set);
    for (const std::int32_t i : patch.pieces) {
        const io::CutPiece& c = shell_.pieces[static_cast<std::size_t>(i)].corners;
        const auto point = [&](std::int32_t v) { return shell_.points[static_cast<std::size_t>(v)]; };
        for (std::size_t k = 2; k < c.size(); ++k)
            depth.add({point(c[0]), point(c[k - 1]), point(c[k])}, {c[0], c[k - 1], c[k]});
    }
    const auto [reached, bound] = depth.refine(tolerance_);
    overlap.depth = {std::max(overlap.depth[0], reached - shell_.tolerance),
                     std::max(overlap.depth[1], bound + shell_.tolerance)};
}

}  // namespace

std::vector<SelfOverlap> find_self_overlaps(const io::TriangleMesh& shell, const Intersections& found,
                                            std::span<const CrossingPlace* const> places, double volume, bool outwards,
                                            double tolerance) {
    const std::optional<CutShell> cut = cut_shell(shell, found, places);
    if (!cut) return {};
    return SelfOverlapSearch(*cut, outwards, tolerance).run(places.size(), volume);
}

}  // namespace crumple::checks
