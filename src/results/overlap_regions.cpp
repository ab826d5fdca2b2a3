#include "results/overlap_regions.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "base/disjoint_sets.h"
#include "results/edge_crossings.h"
#include "results/overlap_face_loops.h"
#include "results/overlap_sheets.h"
#include "scene/placement.h"

namespace crumple {
namespace {

/// Number of segments on a face up to which all pairs may be compared.
constexpr std::size_t most_compared_in_pairs = 16;

class RegionFinder {
   public:
    RegionFinder(const RegionInput& input, Cancellation& cancellation)
        : in_(input),
          cancellation_(cancellation),
          sets_(2 * input.segments.size() + input.inside[0].size() + input.inside[1].size()),
          chains_{DisjointSets(input.segments.size()), DisjointSets(input.segments.size())},
          merged_(input.segments.size()),
          crossings_(input, cancellation) {
        auto first = static_cast<std::int32_t>(2 * in_.segments.size());
        for (std::size_t side = 0; side < 2; ++side) {
            element_[side].assign(in_.vertex_count[side], -1);
            for (const VertexWinding& vertex : in_.inside[side])
                element_[side][static_cast<std::size_t>(vertex.vertex)] = first++;
        }
    }

    std::vector<RegionParts> find() {
        join_along_edges();
        for (std::size_t side = 0; side < 2; ++side) {
            join_uncrossed_edges(side);
            join_within_faces(side);
        }
        return parts();
    }

   private:
    void join_along_edges();
    void join_edge(std::span<const EdgeEnd> ends);
    void join_uncrossed_edges(std::size_t side);
    void join_within_faces(std::size_t side);
    void join_crossing_sheets(std::size_t side, std::span<const std::int32_t> on_face);
    int common_vertices(std::size_t side, std::int32_t face, std::int32_t other) const;
    bool sheets_cross(std::size_t side, const Segment& s, const Segment& t) const;
    void join_loops(std::size_t side, std::span<const std::int32_t> on_face);
    std::vector<RegionParts> parts();

    int winding(std::size_t side, std::int32_t vertex) const {
        const std::int32_t element = element_[side][static_cast<std::size_t>(vertex)];
        if (element < 0) return 0;
        const std::size_t first = 2 * in_.segments.size() + (side == 1 ? in_.inside[0].size() : 0);
        return in_.inside[side][static_cast<std::size_t>(element) - first].winding;
    }
    std::int32_t element(std::size_t side, std::int32_t vertex) const {
        return element_[side][static_cast<std::size_t>(vertex)];
    }
    std::int32_t segment_element(std::size_t side, std::int32_t segment) const {
        return segment + static_cast<std::int32_t>(side * in_.segments.size());
    }
    /// Joins two segments on both surfaces.
    void join_segments_of_both(std::int32_t s, std::int32_t t) {
        for (std::size_t side = 0; side < 2; ++side) sets_.join(segment_element(side, s), segment_element(side, t));
    }
    std::int32_t face_of(std::size_t side, std::int32_t segment) const {
        const Segment& s = in_.segments[static_cast<std::size_t>(segment)];
        return side == 0 ? s.a : s.b;
    }

    const RegionInput& in_;
    Cancellation& cancellation_;
    /// Segments on the first surface, segments on the second one, inside vertices of the first and of the second one.
    DisjointSets sets_;
    std::array<DisjointSets, 2> chains_;  ///< by surface: segments that are connected within one of its faces
    std::vector<std::uint8_t> merged_;    ///< by segment: 1 if it crosses another one on a face
    std::array<std::vector<std::int32_t>, 2> element_;  ///< by surface and vertex: index in sets_, or −1 if not inside
    EdgeCrossings crossings_;
};

void RegionFinder::join_along_edges() {
    const auto ends = crossings_.ends();
    for (std::size_t begin = 0, end = 0; begin < ends.size(); begin = end) {
        end = crossings_.end_of_edge(begin);
        join_edge(ends.subspan(begin, end - begin));
    }
}

// Joins the neighbours along one edge, on which these ends lie.
void RegionFinder::join_edge(std::span<const EdgeEnd> ends) {
    const EdgeEnd& edge = ends[0];
    int w = winding(edge.side, edge.low);
    std::int32_t last = element(edge.side, edge.low), segment = -1;  // the last element, and the last segment
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const EdgeEnd& at = ends[i];
        const std::int32_t current = segment_element(edge.side, at.segment);
        if (i > 0 && at.crossed == ends[i - 1].crossed) {
            join_segments_of_both(at.segment, segment);
        } else {
            if (w != 0) sets_.join(last, current);
            w += at.jump;
            last = current;
            segment = at.segment;
        }
        // On the face that the edge crosses, segments continue here.
        chains_[1 - edge.side].join(at.segment, segment);
    }
    if (w != 0) sets_.join(last, element(edge.side, edge.high));
}

void RegionFinder::join_uncrossed_edges(std::size_t side) {
    const auto join_edges_of = [&](std::int32_t face) {
        const std::int32_t* vertex = in_.corners[side] + 3 * std::ptrdiff_t{face};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = element(side, vertex[k]), to = element(side, vertex[next_corner(k)]);
            if (!crossings_.is_crossed(side, face, k) && from >= 0 && to >= 0) sets_.join(from, to);
        }
    };
    for (const std::int32_t face : in_.faces[side]) join_edges_of(face);
    for (std::size_t i = 0; i < in_.segments.size(); ++i) join_edges_of(face_of(side, static_cast<std::int32_t>(i)));
}

void RegionFinder::join_within_faces(std::size_t side) {
    std::vector<std::int32_t> order(in_.links);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::int32_t>(i);
    const auto before = [&](std::int32_t i, std::int32_t j) { return face_of(side, i) < face_of(side, j); };
    if (!std::is_sorted(order.begin(), order.end(), before)) std::stable_sort(order.begin(), order.end(), before);
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        cancellation_.check();
        const std::int32_t face = face_of(side, order[begin]);
        while (end < order.size() && face_of(side, order[end]) == face) ++end;
        const auto on_face = std::span<const std::int32_t>(order).subspan(begin, end - begin);
        if (on_face.size() < 2) continue;
        join_crossing_sheets(side, on_face);
        join_loops(side, on_face);
    }
}

// Joins the segments on one face that cross, because the faces in which they lie cross. Sweeps over boxes of segments
// along the axis on which their middles are spread most.
void RegionFinder::join_crossing_sheets(std::size_t side, std::span<const std::int32_t> on_face) {
    const auto box = [&](std::int32_t s) -> const Bounds& { return crossings_.box(s); };
    Bounds middles = no_bounds;
    for (const std::int32_t s : on_face) middles.widen(0.5 * box(s).low + 0.5 * box(s).high);
    const Vec3d spread = 0.5 * middles.high - 0.5 * middles.low;
    const int axis = spread.x >= spread.y && spread.x >= spread.z ? 0 : spread.y >= spread.z ? 1 : 2;
    std::vector<std::int32_t> order(on_face.begin(), on_face.end());
    std::sort(order.begin(), order.end(), [&](std::int32_t s, std::int32_t t) {
        return std::pair(box(s).low[axis], s) < std::pair(box(t).low[axis], t);
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
        cancellation_.check();
        for (std::size_t j = i + 1; j < order.size() && box(order[j]).low[axis] <= box(order[i]).high[axis]; ++j) {
            if (!overlap(box(order[i]), box(order[j]))) continue;
            const auto s = static_cast<std::size_t>(order[i]), t = static_cast<std::size_t>(order[j]);
            if (!sheets_cross(side, in_.segments[s], in_.segments[t])) continue;
            join_segments_of_both(order[i], order[j]);
            merged_[s] = merged_[t] = 1;
        }
    }
}

int RegionFinder::common_vertices(std::size_t side, std::int32_t face, std::int32_t other) const {
    const std::int32_t *v = in_.corners[side] + 3 * std::ptrdiff_t{face},
                       *w = in_.corners[side] + 3 * std::ptrdiff_t{other};
    int common = 0;
    for (std::size_t k = 0; k < 3; ++k) common += v[k] == w[0] || v[k] == w[1] || v[k] == w[2];
    return common;
}

// True if two segments on one face of surface `side` cross: if the ends of each are on different sides of the other
// one's sheet, the face of the other surface.
bool RegionFinder::sheets_cross(std::size_t side, const Segment& s, const Segment& t) const {
    const std::size_t of = 1 - side;
    const std::int32_t sheet = side == 0 ? s.b : s.a, other_sheet = side == 0 ? t.b : t.a;
    if (common_vertices(of, sheet, other_sheet) >= 2) return false;  // before coordinates are read
    const FaceOfSurface one = in_.face(of, sheet), other = in_.face(of, other_sheet);
    if (!sheets_may_cross(one, other, in_.in_range)) return false;
    const auto parts = [&](const FaceCorners& plane, const Segment& segment) {
        std::array<ShiftedPoint, 3> q;
        for (std::size_t k = 0; k < 3; ++k) q[k] = shifted_vertex(plane[k], of);
        const ShiftedPoint normal = cross(q[1] - q[0], q[2] - q[0]);
        const auto sign = [&](const SegmentEnd& end) {
            return dot(normal, shifted_point(crossings_.crossed_edge(segment, end)) - q[0]).sign();
        };
        return sign(segment.start) * sign(segment.end) < 0;
    };
    return parts(one.corner, t) && parts(other.corner, s);
}

// Joins the loops on one face to what surrounds them there, if the winding number between them is not 0.
void RegionFinder::join_loops(std::size_t side, std::span<const std::int32_t> on_face) {
    const auto leaves_face = [&](std::int32_t s) {
        const Segment& segment = in_.segments[static_cast<std::size_t>(s)];
        return segment.start.side == side || segment.end.side == side;
    };
    if (std::all_of(on_face.begin(), on_face.end(), leaves_face)) return;
    if (on_face.size() <= most_compared_in_pairs) {
        const auto chain_leaves_face = [&](std::int32_t s) {
            const std::int32_t chain = chains_[side].find(s);
            return std::any_of(on_face.begin(), on_face.end(),
                               [&](std::int32_t t) { return leaves_face(t) && chains_[side].find(t) == chain; });
        };
        if (std::all_of(on_face.begin(), on_face.end(), chain_leaves_face)) return;
    }
    std::vector<std::int32_t> chains, at_edges;
    for (const std::int32_t s : on_face) {
        chains.push_back(chains_[side].find(s));
        if (leaves_face(s)) at_edges.push_back(chains.back());
    }
    std::vector<std::int32_t> loops = chains;
    for (std::vector<std::int32_t>* list : {&loops, &at_edges}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    std::erase_if(loops, [&](std::int32_t c) { return std::binary_search(at_edges.begin(), at_edges.end(), c); });
    if (loops.empty()) return;

    const std::int32_t f = face_of(side, on_face[0]);
    const FaceOfSurface face = in_.face(side, f);
    std::vector<SegmentOnFace> segments;
    for (std::size_t i = 0; i < on_face.size(); ++i) {
        const Segment& s = in_.segments[static_cast<std::size_t>(on_face[i])];
        segments.push_back(
            {on_face[i], chains[i], crossings_.crossed_edge(s, s.start), crossings_.crossed_edge(s, s.end)});
        if (side == 1) std::swap(segments.back().start, segments.back().end);
    }
    std::array<std::vector<const EdgeEnd*>, 3> ends;  // by edge of the face, in its direction
    std::array<std::vector<CrossedEdge>, 3> crossings;
    for (std::size_t edge = 0; edge < 3; ++edge) {
        ends[edge] = crossings_.on_edge(side, face.vertex[edge], face.vertex[next_corner(edge)]);
        for (const EdgeEnd* end : ends[edge]) crossings[edge].push_back(crossings_.crossed_edge(*end));
    }
    FaceLoops in_face(side, face.corner, std::move(segments), crossings, in_.in_range);
    for (const std::int32_t loop : loops) {
        cancellation_.check();
        const Surroundings around = in_face.around(loop);
        const std::int32_t from = face.vertex[around.edge];
        int w = winding(side, from) + around.change;
        std::int32_t at_exit = element(side, from);
        for (std::size_t i = 0; i < around.before; ++i) {
            const EdgeEnd& end = *ends[around.edge][i];
            w += from == end.low ? end.jump : -end.jump;
            at_exit = segment_element(side, end.segment);
        }
        const std::int32_t met = around.segment >= 0 ? segment_element(side, around.segment) : at_exit;
        if (w != 0 && met >= 0) sets_.join(segment_element(side, loop), met);
    }
}

std::vector<RegionParts> RegionFinder::parts() {
    std::vector<RegionParts> regions;
    const std::size_t elements = 2 * in_.segments.size() + in_.inside[0].size() + in_.inside[1].size();
    std::vector<std::int32_t> piece(elements), region(elements, -1);
    for (std::size_t e = 0; e < elements; ++e) piece[e] = sets_.find(static_cast<std::int32_t>(e));
    for (std::int32_t i = 0; i < std::ssize(in_.segments); ++i)
        sets_.join(segment_element(0, i), segment_element(1, i));
    std::vector<std::uint8_t> counted(elements);  // by the piece's representative
    const auto count_piece = [&](std::size_t side, std::int32_t element, RegionParts& of) {
        std::uint8_t& is_counted = counted[static_cast<std::size_t>(piece[static_cast<std::size_t>(element)])];
        of.pieces[side] += 1 - is_counted;
        is_counted = 1;
    };
    const auto region_of = [&](std::int32_t element) -> RegionParts& {
        std::int32_t& index = region[static_cast<std::size_t>(sets_.find(element))];
        if (index < 0) {
            index = static_cast<std::int32_t>(regions.size());
            regions.emplace_back();
        }
        return regions[static_cast<std::size_t>(index)];
    };
    for (std::size_t i = 0; i < in_.links; ++i) {
        RegionParts& of = region_of(static_cast<std::int32_t>(i));
        of.segments.push_back(static_cast<std::int32_t>(i));
        for (std::size_t side = 0; side < 2; ++side)
            count_piece(side, segment_element(side, static_cast<std::int32_t>(i)), of);
        of.merged |= merged_[i] != 0;
    }
    for (std::size_t side = 0; side < 2; ++side)
        for (const VertexWinding& vertex : in_.inside[side]) {
            RegionParts& of = region_of(element(side, vertex.vertex));
            of.inside[side].push_back(vertex);
            count_piece(side, element(side, vertex.vertex), of);
        }
    std::sort(regions.begin(), regions.end(), [](const auto& x, const auto& y) { return x.key() < y.key(); });
    return regions;
}

}  // namespace

std::tuple<std::int32_t, std::size_t, std::int32_t> RegionParts::key() const {
    constexpr std::int32_t last = std::numeric_limits<std::int32_t>::max();
    if (!segments.empty()) return {segments[0], 0, 0};
    const std::size_t side = inside[0].empty() ? 1 : 0;
    std::int32_t lowest = last;
    for (const VertexWinding& vertex : inside[side]) lowest = std::min(lowest, vertex.vertex);
    return {last, side, lowest};
}

std::vector<RegionParts> find_regions(const RegionInput& input, Cancellation& cancellation) {
    return RegionFinder(input, cancellation).find();
}

}  // namespace crumple
