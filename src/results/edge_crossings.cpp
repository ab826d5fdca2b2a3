#include "results/edge_crossings.h"

#include <algorithm>
#include <map>
#include <optional>

#include "exact/overlap/enclosed_parameter.h"

namespace crumple {
namespace {

/// Error of parameters in float64 up to which boxes of crossings use them, instead of double words.
constexpr double largest_error_of_boxes = 0x1p-40;

}  // namespace

EdgeCrossings::EdgeCrossings(const RegionInput& input, Cancellation& cancellation)
    : in_(input), cancellation_(cancellation), box_(input.segments.size(), no_bounds) {
    list_ends();
    for (std::size_t begin = 0, end = 0; begin < ends_.size(); begin = end) {
        cancellation_.check();
        end = end_of_edge(begin);
        locate(begin, end);
        sort_along_edge(begin, end);
    }
}

std::size_t EdgeCrossings::end_of_edge(std::size_t begin) const {
    std::size_t end = begin + 1;
    while (end < ends_.size() && ends_[end].edge_key() == ends_[begin].edge_key()) ++end;
    return end;
}

EdgeEnd EdgeCrossings::edge_end(std::size_t i, bool start) const {
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
void EdgeCrossings::list_ends() {
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

CrossedEdge EdgeCrossings::crossed_edge(const EdgeEnd& end) const {
    const FaceCorners corner = in_.face(end.side, end.face).corner;
    CrossedEdge edge{end.side, corner[end.edge], corner[next_corner(end.edge)],
                     in_.face(1 - end.side, end.crossed).corner};
    if (!end.upward) std::swap(edge.from, edge.to);
    return edge;
}
CrossedEdge EdgeCrossings::crossed_edge(const Segment& segment, const SegmentEnd& end) const {
    const std::int32_t own = end.side == 0 ? segment.a : segment.b, other = end.side == 0 ? segment.b : segment.a;
    const FaceOfSurface face = in_.face(end.side, own);
    const std::size_t next = next_corner(end.edge);
    CrossedEdge edge{end.side, face.corner[end.edge], face.corner[next], in_.face(1 - end.side, other).corner};
    if (face.vertex[end.edge] > face.vertex[next]) std::swap(edge.from, edge.to);
    return edge;
}

// Computes where the ends on one edge, which are sorted by crossed face, lie on it and in space.
void EdgeCrossings::locate(std::size_t begin, std::size_t end) {
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
Bounds EdgeCrossings::box_at(const CrossedEdge& edge, const RoundedParameter& parameter) const {
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
void EdgeCrossings::sort_along_edge(std::size_t begin, std::size_t end) {
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

std::vector<const EdgeEnd*> EdgeCrossings::on_edge(std::size_t side, std::int32_t from, std::int32_t to) const {
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

}  // namespace crumple
