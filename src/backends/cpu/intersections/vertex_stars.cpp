#include "backends/cpu/intersections/vertex_stars.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "backends/cpu/stages/sweep.h"
#include "filters/intersection/triangle_record.h"
#include "geometry/eigen.h"

namespace crumple::cpu {
namespace {

constexpr std::int64_t fewest_members = 128;  // leaves with fewer are not searched for stars
constexpr std::size_t fewest_triangles = 64;  // of a star
constexpr std::size_t most_overlaps = 8;      // per triangle of a star; with more, the star is not used
constexpr std::int64_t samples = 64;
constexpr int fewest_samples = 4;  // that contain the vertex of a star
constexpr std::size_t most_stars = 8;

struct FrequentVertices {
    std::array<std::int32_t, most_stars> vertex;
    std::size_t count = 0;
};

// Returns vertices that at least `fewest_samples` of the sampled members contain. Vertices with equal hashes hide each
// other.
FrequentVertices frequent_vertices(const BuildInput& in) {
    struct Slot {
        std::int32_t vertex = -1, count = 0;
    };
    std::array<Slot, 256> slots;
    FrequentVertices found;
    for (std::int64_t i = 0; i < samples; ++i) {
        const std::int32_t triangle = in.triangle[i * in.members / samples];
        for (int k = 0; k < 3; ++k) {
            const std::int32_t vertex = in.corners[3 * std::int64_t{triangle} + k];
            Slot& slot = slots[static_cast<std::uint32_t>(vertex) * 0x9e3779b1u >> 24];
            if (slot.vertex != vertex) {
                if (slot.count < fewest_samples) slot = {vertex, 1};
            } else if (++slot.count == fewest_samples && found.count < most_stars) {
                found.vertex[found.count++] = vertex;
            }
        }
    }
    return found;
}

}  // namespace

/// Projection along an axis, with directions from a vertex as pseudo-angles: numbers in [-2, 2] that increase with the
/// angle, from the negative first axis once around. Opposite directions differ by 2.
class VertexStars::Projection {
   public:
    Projection(const PointRows& points, std::int32_t vertex, const Vec3d& u, const Vec3d& w)
        : points_(points),
          from_(points[vertex]),
          u_(u),
          w_(w),
          tiny_(points.f ? float32_rows_slack : float64_rows_slack) {}

    struct Angle {
        double value = 0, error = 0;
        bool certain = false;
    };

    /// Returns the pseudo-angle of a vertex. It is not certain if it may be that of the negative first axis, or if the
    /// projected vertex may be the projected centre.
    Angle angle(std::int32_t vertex) const {
        const Vec3d e = points_[vertex] - from_;
        const double u = dot(u_, e), w = dot(w_, e), size = std::abs(u) + std::abs(w);
        const double error = 5 * 0x1p-53 * (dot(abs(u_), abs(e)) + dot(abs(w_), abs(e))) + tiny_;
        if (!(size > 4 * error) || (u <= error && std::abs(w) <= error)) return {};
        const double share = w / size;
        const double value = u >= 0 ? share : w >= 0 ? 2 - share : -2 - share;
        return {value, 2 * error / size + 16 * 0x1p-53, true};
    }

   private:
    PointRows points_;
    Vec3d from_, u_, w_;
    double tiny_;
};

void VertexStars::find(const BuildInput& in, LeafMembers& members) {
    pairs_.clear();
    candidates_.clear();
    if (members.between || in.members < fewest_members || in.members > block_members) return;
    const FrequentVertices centres = frequent_vertices(in);
    if (centres.count == 0) return;
    unsigned used = 0;
    for (const std::uint16_t bits : members.lower) used |= bits;
    for (std::size_t s = 0; s < centres.count; ++s) {
        const unsigned bit = ~used & (used + 1);
        if (bit > 0xffff) return;
        if (add(in, centres.vertex[s], static_cast<std::uint16_t>(bit), members)) used |= bit;
    }
}

// Adds the star of a vertex, with the better one of two projections. Returns false if the star is not worth its bit.
bool VertexStars::add(const BuildInput& in, std::int32_t vertex, std::uint16_t bit, LeafMembers& members) {
    gather(in, vertex);
    if (triangles_.size() < fewest_triangles) return false;
    const Vec3d centre = in.points[vertex];
    SymmetricMatrix moment;
    const std::size_t step = (triangles_.size() + 127) / 128;
    for (std::size_t i = 0; i < triangles_.size(); i += step) {
        const Vec3d e = in.points[triangles_[i].p] - centre;
        const double square = dot(e, e);
        if (!(square > 0)) continue;
        const Vec3d d = (1 / std::sqrt(square)) * e;
        moment.xx += d.x * d.x, moment.xy += d.x * d.y, moment.xz += d.x * d.z;
        moment.yy += d.y * d.y, moment.yz += d.y * d.z, moment.zz += d.z * d.z;
    }
    const PrincipalAxes axes = principal_axes(moment);
    // Directions of a flat star spread along two axes. If a star of needles points along one axis, the directions of
    // few wide triangles can determine the second one, so the third is tried, too.
    std::size_t fewest = most_overlaps * triangles_.size() + 1;
    int best = 0, made = 0;
    for (int second = 1; second <= 2; ++second) {
        make_arcs(Projection(in.points, vertex, axes.axis[0], axes.axis[second]));
        made = second;
        std::size_t cost = (triangles_.size() - std::min(triangles_.size(), arcs_.size())) * most_overlaps;
        if (for_each_overlap([&](const Arc&, const Arc&) { return ++cost < fewest; }) && cost < fewest) {
            fewest = cost;
            best = second;
        }
        if (cost <= 2 * triangles_.size()) break;
    }
    if (best == 0) return false;
    if (best != made) make_arcs(Projection(in.points, vertex, axes.axis[0], axes.axis[best]));
    const Array<std::uint16_t>& lower = members.lower;
    // Members with a common bit are a pair of another leaf or of an earlier star.
    for_each_overlap([&](const Arc& a, const Arc& b) {
        if ((lower[a.member] & lower[b.member]) == 0) pairs_.push_back({a.member, b.member});
        return true;
    });
    for (const Arc& arc : arcs_) members.lower[arc.member] = static_cast<std::uint16_t>(lower[arc.member] | bit);
    return true;
}

// Lists the members that contain a vertex exactly once.
void VertexStars::gather(const BuildInput& in, std::int32_t vertex) {
    triangles_.clear();
    for (std::int64_t i = 0; i < in.members; ++i) {
        const std::int32_t* corner = in.corners + 3 * std::int64_t{in.triangle[i]};
        const bool is[3] = {corner[0] == vertex, corner[1] == vertex, corner[2] == vertex};
        if (is[0] + is[1] + is[2] != 1) continue;
        const int k = is[0] ? 0 : is[1] ? 1 : 2;
        triangles_.push_back({static_cast<std::int32_t>(i), corner[(k + 1) % 3], corner[(k + 2) % 3]});
    }
}

// Makes the arcs of a star's triangles, sorted by their low ends. Leaves out triangles whose angle at the vertex may be
// 180 degrees in the projection. An arc that contains the negative first axis is cut in two.
void VertexStars::make_arcs(const Projection& projection) {
    arcs_.clear();
    for (const StarTriangle& t : triangles_) {
        const Projection::Angle p = projection.angle(t.p), q = projection.angle(t.q);
        if (!p.certain || !q.certain) continue;
        const Projection::Angle &low = p.value < q.value ? p : q, &high = p.value < q.value ? q : p;
        const double width = high.value - low.value, error = 2 * (low.error + high.error);
        if (width < 2 - error) {
            arcs_.push_back({std::min(p.value - p.error, q.value - q.error),
                             std::max(p.value + p.error, q.value + q.error), t.member});
        } else if (width > 2 + error) {
            arcs_.push_back({-3, low.value + low.error, t.member});
            arcs_.push_back({high.value - high.error, 3, t.member});
        }
    }
    std::sort(arcs_.begin(), arcs_.end(), [](const Arc& a, const Arc& b) { return a.low < b.low; });
}

// Calls visit(a, b) for arcs a and b that overlap, until it returns false, and then returns false.
template <class Visit>
bool VertexStars::for_each_overlap(Visit visit) const {
    for (std::size_t i = 0; i < arcs_.size(); ++i)
        for (std::size_t j = i + 1; j < arcs_.size() && arcs_[j].low <= arcs_[i].high; ++j)
            if (!visit(arcs_[i], arcs_[j])) return false;
    return true;
}

void VertexStars::sort(const SortedLeaf& leaf) {
    candidates_.resize_discard(pairs_.size());
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
        const auto a = static_cast<std::uint32_t>(leaf.position[pairs_[i].a]);
        const auto b = static_cast<std::uint32_t>(leaf.position[pairs_[i].b]);
        candidates_[i] = std::min(a, b) << 16 | std::max(a, b);
    }
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.resize(
        static_cast<std::size_t>(std::unique(candidates_.begin(), candidates_.end()) - candidates_.begin()));
}

std::size_t VertexStars::first_pair(std::int64_t row) const {
    const auto from = std::partition_point(candidates_.begin(), candidates_.end(),
                                           [&](std::uint32_t pair) { return (pair >> 16) < row; });
    return static_cast<std::size_t>(from - candidates_.begin());
}

bool VertexStars::list(const SortedLeaf& leaf, std::int64_t last, std::size_t& next, CandidateChunk& chunk) const {
    chunk.rows = chunk.columns = chunk.count = chunk.pairs = 0;
    chunk.dummy = static_cast<std::uint16_t>(leaf.rows - 1);
    const auto add = [&](std::uint32_t row, std::uint32_t column) {
        chunk.row[chunk.count] = static_cast<std::uint16_t>(row);
        chunk.column[chunk.count++] = static_cast<std::uint16_t>(column);
    };
    while (next < candidates_.size() && (candidates_[next] >> 16) < last && chunk.count < chunk_columns) {
        const std::uint32_t row = candidates_[next] >> 16;
        for (; next < candidates_.size() && candidates_[next] >> 16 == row; ++next, ++chunk.pairs)
            add(row, candidates_[next] & 0xffff);
        while (chunk.count % chunk.group) add(row, chunk.dummy);
    }
    while (chunk.count % 16) add(0, chunk.dummy);
    return chunk.pairs > 0;
}

}  // namespace crumple::cpu
