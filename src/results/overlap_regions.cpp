#include "results/overlap_regions.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/disjoint_sets.h"
#include "exact/overlap/enclosed_parameter.h"
#include "exact/overlap/rounded_parameter.h"
#include "results/overlap_face_loops.h"
#include "results/overlap_sheets.h"
#include "scene/placement.h"

namespace crumple {
namespace {

/// End of a segment, where the edge between vertices `low` and `high` of surface `side` crosses face `crossed`.
struct EdgeEnd {
    std::size_t side;
    std::int32_t low, high, crossed, segment;
    int jump;           ///< change of the winding number from `low` to `high`
    std::int32_t face;  ///< a face with that edge, and which of its edges it is
    std::uint8_t edge;
    bool upward;  ///< true if that face traverses the edge from `low` to `high`
    /// Where on the edge, from `low` to `high`; its error is infinite if that is not known in float64.
    RoundedParameter parameter = {};

    auto edge_key() const { return std::tie(side, low, high); }
    /// Keys in the order of (side, low, high) and of (crossed, segment).
    std::array<std::uint64_t, 2> keys() const {
        const auto bits = [](std::int32_t x) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)); };
        return {std::uint64_t{side} << 62 | bits(low) << 31 | bits(high), bits(crossed) << 32 | bits(segment)};
    }
};

/// Number of segments on a face up to which all pairs may be compared.
constexpr std::size_t most_compared_in_pairs = 16;
/// Error of parameters in float64 up to which boxes of crossings use them, instead of double words.
constexpr double largest_error_of_boxes = 0x1p-40;

class RegionFinder {
   public:
    RegionFinder(const RegionInput& input, Cancellation& cancellation)
        : in_(input),
          cancellation_(cancellation),
          sets_(2 * input.segments.size() + input.inside[0].size() + input.inside[1].size()),
          chains_{DisjointSets(input.segments.size()), DisjointSets(input.segments.size())},
          merged_(input.segments.size()),
          box_(input.segments.size(), no_bounds) {
        auto first = static_cast<std::int32_t>(2 * in_.segments.size());
        for (std::size_t side = 0; side < 2; ++side) {
            element_[side].assign(in_.vertex_count[side], -1);
            for (const VertexWinding& vertex : in_.inside[side])
                element_[side][static_cast<std::size_t>(vertex.vertex)] = first++;
        }
    }

    std::vector<RegionParts> find() {
        list_ends();
        join_along_edges();
        for (std::size_t side = 0; side < 2; ++side) {
            join_uncrossed_edges(side);
            join_within_faces(side);
        }
        return parts();
    }

   private:
    EdgeEnd edge_end(std::size_t segment, bool start) const;
    void list_ends();
    void locate_crossings(std::size_t begin, std::size_t end);
    Bounds box_at(const CrossedEdge& edge, const RoundedParameter& parameter) const;
    void sort_along_edge(std::size_t begin, std::size_t end);
    CrossedEdge crossed_edge(const EdgeEnd& end) const;
    void join_along_edges();
    void join_edge(std::size_t begin, std::size_t end);
    void join_uncrossed_edges(std::size_t side);
    void join_within_faces(std::size_t side);
    void join_crossing_sheets(std::size_t side, std::span<const std::int32_t> on_face);
    int common_vertices(std::size_t side, std::int32_t face, std::int32_t other) const;
    bool sheets_cross(std::size_t side, const Segment& s, const Segment& t) const;
    void join_loops(std::size_t side, std::span<const std::int32_t> on_face);
    std::vector<const EdgeEnd*> crossings_of(std::size_t side, std::int32_t from, std::int32_t to) const;
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
    CrossedEdge crossed_edge(const Segment& segment, const SegmentEnd& end) const;

    const RegionInput& in_;
    Cancellation& cancellation_;
    /// Segments on the first surface, segments on the second one, inside vertices of the first and of the second one.
    DisjointSets sets_;
    std::array<DisjointSets, 2> chains_;  ///< by surface: segments that are connected within one of its faces
    std::vector<std::uint8_t> merged_;    ///< by segment: 1 if it crosses another one on a face
    std::vector<Bounds> box_;             ///< by segment: boxes that contain its two ends
    std::array<std::vector<std::int32_t>, 2> element_;  ///< by surface and vertex: index in sets_, or −1 if not inside
    std::vector<EdgeEnd> ends_;                         ///< sorted by edge, and along each edge
    std::array<std::vector<std::uint8_t>, 2> crossed_;  ///< by surface and face: bit k is set if its edge k is crossed
};

EdgeEnd RegionFinder::edge_end(std::size_t i, bool start) const {
    const Segment& segment = in_.segments[i];
    const SegmentEnd& end = start ? segment.start : segment.end;
    const std::int32_t own = end.side == 0 ? segment.a : segment.b, other = end.side == 0 ? segment.b : segment.a;
    const std::int32_t* vertex = in_.corners[end.side] + 3 * std::ptrdiff_t{own};
    const std::int32_t from = vertex[end.edge], to = vertex[next_corner(end.edge)];
    return {end.side,
            std::min(from, to),
            std::max(from, to),
            other,
            static_cast<std::int32_t>(i),
            from < to ? end.jump : -end.jump,
            own,
            end.edge,
            from < to};
}

// Sorts short keys instead of the ends.
void RegionFinder::list_ends() {
    for (std::size_t side = 0; side < 2; ++side) crossed_[side].assign(in_.face_count[side], 0);
    using Key = std::pair<std::array<std::uint64_t, 2>, bool>;  // of an end, and true if it is a start
    std::vector<Key> order;
    order.reserve(2 * in_.segments.size());
    for (std::size_t i = 0; i < in_.segments.size(); ++i)
        for (const bool start : {true, false}) {
            const EdgeEnd end = edge_end(i, start);
            order.emplace_back(end.keys(), start);
            crossed_[end.side][static_cast<std::size_t>(end.face)] |= static_cast<std::uint8_t>(1 << end.edge);
        }
    std::sort(order.begin(), order.end());
    ends_.reserve(order.size());
    for (const auto& [keys, start] : order) ends_.push_back(edge_end(keys[1] & 0xffffffff, start));
}

CrossedEdge RegionFinder::crossed_edge(const EdgeEnd& end) const {
    const FaceCorners corner = in_.face(end.side, end.face).corner;
    CrossedEdge edge{end.side, corner[end.edge], corner[next_corner(end.edge)],
                     in_.face(1 - end.side, end.crossed).corner};
    if (!end.upward) std::swap(edge.from, edge.to);
    return edge;
}
CrossedEdge RegionFinder::crossed_edge(const Segment& segment, const SegmentEnd& end) const {
    const std::int32_t own = end.side == 0 ? segment.a : segment.b, other = end.side == 0 ? segment.b : segment.a;
    const FaceOfSurface face = in_.face(end.side, own);
    const std::size_t next = next_corner(end.edge);
    CrossedEdge edge{end.side, face.corner[end.edge], face.corner[next], in_.face(1 - end.side, other).corner};
    if (face.vertex[end.edge] > face.vertex[next]) std::swap(edge.from, edge.to);
    return edge;
}

// Computes where the ends on one edge, which are sorted by crossed face, lie on it and in space.
void RegionFinder::locate_crossings(std::size_t begin, std::size_t end) {
    CrossedEdge edge = crossed_edge(ends_[begin]);
    Bounds box;
    for (std::size_t i = begin; i < end; ++i) {
        EdgeEnd& at = ends_[i];
        if (i > begin && at.crossed == ends_[i - 1].crossed) {
            at.parameter = ends_[i - 1].parameter;
        } else {
            edge.face = in_.face(1 - edge.side, at.crossed).corner;
            if (in_.in_range) at.parameter = rounded_parameter(edge.from, edge.to, edge.face);
            box = box_at(edge, at.parameter);
        }
        box_[static_cast<std::size_t>(at.segment)].widen(box);
    }
}

// Returns a box that contains the point of a crossing: the intersection of the boxes of the edge and of the face, or a
// smaller one if coordinates are in range.
Bounds RegionFinder::box_at(const CrossedEdge& edge, const RoundedParameter& parameter) const {
    const auto& [p, q, r] = edge.face;
    if (!in_.in_range)
        return {max(min(edge.from, edge.to), min(p, min(q, r))), min(max(edge.from, edge.to), max(p, max(q, r)))};
    std::optional<Enclosed> enclosed;
    if (parameter.error > largest_error_of_boxes) enclosed = enclosed_parameter(edge.from, edge.to, edge.face);
    Bounds box;
    for (int axis = 0; axis < 3; ++axis) {
        RoundedNumber x = RoundedNumber::between(edge.from[axis], edge.to[axis], parameter);
        if (enclosed) {
            const Enclosed y =
                Enclosed(edge.from[axis]) + *enclosed * Enclosed::difference(edge.to[axis], edge.from[axis]);
            x = {y.value.high, y.error + 0x1p-52 * y.magnitude()};
        }
        box.low[axis] = x.value - x.error;
        box.high[axis] = x.value + x.error;
    }
    return box;
}

// Sorts the ends on one edge, which are sorted by crossed face, along the edge from its lower to its higher vertex.
void RegionFinder::sort_along_edge(std::size_t begin, std::size_t end) {
    if (ends_[end - 1].crossed == ends_[begin].crossed) return;
    struct PreciseParameter {
        CrossedEdge edge;
        std::optional<Enclosed> enclosed = {};
        std::optional<ShiftedNumber> shifted = {};
    };
    std::map<std::int32_t, PreciseParameter> precise;  // by crossed face, once they are needed
    const auto precise_at = [&](const EdgeEnd& at) -> PreciseParameter& {
        return precise.try_emplace(at.crossed, PreciseParameter{crossed_edge(at)}).first->second;
    };
    const auto enclosed_at = [&](const EdgeEnd& at) -> const Enclosed& {
        auto& [edge, enclosed, shifted] = precise_at(at);
        if (!enclosed) enclosed = enclosed_parameter(edge.from, edge.to, edge.face);
        return *enclosed;
    };
    const auto shifted_at = [&](const EdgeEnd& at) -> const ShiftedNumber& {
        auto& [edge, enclosed, shifted] = precise_at(at);
        if (!shifted) shifted = shifted_parameter(edge);
        return *shifted;
    };
    const auto range = std::span(ends_).subspan(begin, end - begin);
    std::stable_sort(range.begin(), range.end(), [&](const EdgeEnd& x, const EdgeEnd& y) {
        if (x.crossed == y.crossed) return false;
        const double rounded = x.parameter.value - y.parameter.value;
        if (std::abs(rounded) > (1 + 0x1p-40) * (x.parameter.error + y.parameter.error)) return rounded < 0;
        cancellation_.check();
        if (in_.in_range) {
            const Enclosed difference = enclosed_at(x) - enclosed_at(y);
            if (difference.magnitude() > (1 + 0x1p-40) * difference.error) return difference.value.high < 0;
        }
        const int sign = (shifted_at(x) - shifted_at(y)).sign();
        return sign != 0 ? sign < 0 : x.crossed < y.crossed;
    });
}

void RegionFinder::join_along_edges() {
    for (std::size_t begin = 0, end = 0; begin < ends_.size(); begin = end) {
        cancellation_.check();
        while (end < ends_.size() && ends_[end].edge_key() == ends_[begin].edge_key()) ++end;
        locate_crossings(begin, end);
        sort_along_edge(begin, end);
        join_edge(begin, end);
    }
}

void RegionFinder::join_edge(std::size_t begin, std::size_t end) {
    const EdgeEnd& edge = ends_[begin];
    int w = winding(edge.side, edge.low);
    std::int32_t last = element(edge.side, edge.low), segment = -1;  // the last element, and the last segment
    for (std::size_t i = begin; i < end; ++i) {
        const EdgeEnd& at = ends_[i];
        const std::int32_t current = segment_element(edge.side, at.segment);
        if (i > begin && at.crossed == ends_[i - 1].crossed) {
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
        const std::uint8_t crossed = crossed_[side][static_cast<std::size_t>(face)];
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t from = element(side, vertex[k]), to = element(side, vertex[next_corner(k)]);
            if ((crossed >> k & 1) == 0 && from >= 0 && to >= 0) sets_.join(from, to);
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
    const auto box = [&](std::int32_t s) -> const Bounds& { return box_[static_cast<std::size_t>(s)]; };
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
            return dot(normal, shifted_point(crossed_edge(segment, end)) - q[0]).sign();
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
        segments.push_back({on_face[i], chains[i], crossed_edge(s, s.start), crossed_edge(s, s.end)});
        if (side == 1) std::swap(segments.back().start, segments.back().end);
    }
    std::array<std::vector<const EdgeEnd*>, 3> ends;  // by edge of the face, in its direction
    std::array<std::vector<CrossedEdge>, 3> crossings;
    for (std::size_t edge = 0; edge < 3; ++edge) {
        ends[edge] = crossings_of(side, face.vertex[edge], face.vertex[next_corner(edge)]);
        for (const EdgeEnd* end : ends[edge]) crossings[edge].push_back(crossed_edge(*end));
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

// Returns one end for each crossing of an edge, from `from` to `to`.
std::vector<const EdgeEnd*> RegionFinder::crossings_of(std::size_t side, std::int32_t from, std::int32_t to) const {
    const auto key = [](const EdgeEnd& end) { return std::tuple(end.side, end.low, end.high); };
    const std::tuple edge(side, std::min(from, to), std::max(from, to));
    auto end = std::lower_bound(ends_.begin(), ends_.end(), edge,
                                [&](const EdgeEnd& x, const auto& wanted) { return key(x) < wanted; });
    std::vector<const EdgeEnd*> crossings;
    for (; end != ends_.end() && key(*end) == edge; ++end)
        if (crossings.empty() || crossings.back()->crossed != end->crossed) crossings.push_back(&*end);
    if (from > to) std::reverse(crossings.begin(), crossings.end());
    return crossings;
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
