#include "io/coloured/cut_triangle.h"

#include <algorithm>
#include <cmath>

namespace crumple::io {
namespace {

constexpr double tolerance = 1e-12;  // lengths below this share of the triangle's size count as 0

/// Line of a segment in the plane of a triangle.
class CutLine {
   public:
    CutLine(const CutSegment& segment, const Vec3d& normal)
        : begin_(segment[0]),
          along_(segment[1] - segment[0]),
          across_(cross(normal, along_)),
          tolerance_(tolerance * std::sqrt(dot(across_, across_) * std::sqrt(dot(normal, normal)))) {}

    /// Returns the signed distance from the line, times a positive number: positive on the left, 0 within the
    /// tolerance.
    double side_of(const Vec3d& p) const {
        const double side = dot(across_, p - begin_);
        return std::abs(side) <= tolerance_ ? 0 : side;
    }
    /// Returns the coordinate along the line of the point's projection: 0 at the segment's start, 1 at its end.
    double place_of(const Vec3d& p) const { return dot(along_, p - begin_) / dot(along_, along_); }

   private:
    Vec3d begin_, along_, across_;
    double tolerance_;
};

/// Splits a piece along the line of a segment, if a part of the segment lies inside the piece. Leaves the right part in
/// `piece` and returns the left part. Otherwise returns an empty piece and changes nothing.
CutPiece split(std::vector<Vec3d>& points, const CutLine& line, CutPiece& piece) {
    const auto point = [&](std::int32_t corner) { return points[static_cast<std::size_t>(corner)]; };
    std::vector<double> sides;
    for (const std::int32_t corner : piece) sides.push_back(line.side_of(point(corner)));
    const auto [least, most] = std::minmax_element(sides.begin(), sides.end());
    if (!(*least < 0 && *most > 0)) return {};
    CutPiece left, right;
    double first = 1, last = 0;  // ends of the cut, as results of place_of(); first > last: none yet
    const std::size_t old_points = points.size();
    for (std::size_t i = 0; i < piece.size(); ++i) {
        const std::size_t j = (i + 1) % piece.size();
        std::int32_t on_line = piece[i];
        if (sides[i] > 0) left.push_back(piece[i]);
        if (sides[i] < 0) right.push_back(piece[i]);
        if (sides[i] != 0) {
            if (!(sides[i] * sides[j] < 0)) continue;
            const double share = sides[i] / (sides[i] - sides[j]);
            on_line = static_cast<std::int32_t>(points.size());
            points.push_back((1 - share) * point(piece[i]) + share * point(piece[j]));
        }
        left.push_back(on_line), right.push_back(on_line);
        const double place = line.place_of(point(on_line));
        if (first > last) first = last = place;
        first = std::min(first, place), last = std::max(last, place);
    }
    if (!(std::max(first, 0.0) < std::min(last, 1.0) - tolerance)) {
        points.resize(old_points);
        return {};
    }
    piece = std::move(right);
    return left;
}

}  // namespace

std::vector<CutPiece> cut_triangle(std::vector<Vec3d>& points, const std::array<std::int32_t, 3>& corners,
                                   std::span<const CutSegment> segments) {
    const auto point = [&](std::size_t k) { return points[static_cast<std::size_t>(corners[k])]; };
    const Vec3d normal = cross(point(1) - point(0), point(2) - point(0));
    std::vector<CutPiece> pieces{{corners.begin(), corners.end()}};
    for (const CutSegment& segment : segments) {
        const CutLine line(segment, normal);
        for (std::size_t i = 0, count = pieces.size(); i < count; ++i)
            if (CutPiece left = split(points, line, pieces[i]); !left.empty()) pieces.push_back(std::move(left));
    }
    return pieces;
}

}  // namespace crumple::io
