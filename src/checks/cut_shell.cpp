#include "checks/cut_shell.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/disjoint_sets.h"
#include "io/coloured/picture_windings.h"
#include "io/lists/pairs.h"

namespace crumple::checks {
namespace {

constexpr std::size_t most_segments = 1000;  // in one triangle

double length_of(const Vec3d& v) { return std::sqrt(dot(v, v)); }

/// Line segment with its length, and places along it: 0 at its start, 1 at its end.
struct Side {
    Vec3d begin, along;
    double length;

    Side(const Vec3d& a, const Vec3d& b) : begin(a), along(b - a), length(length_of(b - a)) {}
    Vec3d at(double share) const { return begin + share * along; }
    double place_of(const Vec3d& p) const { return length > 0 ? dot(p - begin, along) / (length * length) : 0; }
    double distance_of(const Vec3d& p) const { return length_of(p - at(std::clamp(place_of(p), 0.0, 1.0))); }
};

/// Common area of a triangle and another one in its plane: a convex polygon.
struct CommonArea {
    std::int32_t other;
    std::vector<Vec3d> corners;

    bool contains(const Vec3d& p) const {
        const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
        for (std::size_t k = 0; k < corners.size(); ++k)
            if (dot(normal, cross(corners[(k + 1) % corners.size()] - corners[k], p - corners[k])) < 0) return false;
        return true;
    }
};

/// Part of a side of a triangle at which a piece lies.
struct Border {
    double low, high;
    std::int32_t piece;
};

class ShellCut {
   public:
    ShellCut(const io::TriangleMesh& mesh, const Intersections& found, std::span<const CrossingPlace* const> places)
        : found_(found), places_(places) {
        for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
            const Point p = point_of(mesh, v);
            shell_.points.push_back({p[0], p[1], p[2]});
        }
        for (std::size_t i = 0; i < mesh.triangles.size(); i += 3)
            shell_.triangles.push_back({mesh.triangles[i], mesh.triangles[i + 1], mesh.triangles[i + 2]});
        Vec3d low = shell_.points[0], high = low;
        for (const Vec3d& p : shell_.points) low = min(low, p), high = max(high, p);
        shell_.tolerance = 1e-10 * length_of(high - low);
    }

    std::optional<CutShell> cut() {
        add_segments();
        for (const auto& [triangle, segments] : segments_)
            if (segments.size() > most_segments) return std::nullopt;
        make_pieces();
        DisjointSets sets(shell_.pieces.size());
        for (const auto& [triangle, segments] : segments_) join_within(triangle, sets);
        join_across_edges(sets);
        number_patches(sets);
        find_windings();
        find_places();
        return std::move(shell_);
    }

   private:
    /// Calls take(a, b) for each segment in which the triangles of a pair meet.
    template <class Take>
    void for_each_segment(std::int32_t row, Take take) const {
        const auto points = io::points_of_pair(found_.contacts, static_cast<std::size_t>(row));
        const auto at = [&](std::size_t k) { return Vec3d{points[k][0], points[k][1], points[k][2]}; };
        const std::size_t sides = points.size() < 3 ? points.size() - 1 : points.size();
        for (std::size_t k = 0; k < sides; ++k) take(at(k), at((k + 1) % points.size()));
    }
    std::array<std::int32_t, 2> triangles_of(std::int32_t row) const {
        const Pair pair = found_.pairs[static_cast<std::size_t>(row)];
        return {pair.a, pair.b};
    }
    void add_segments();
    void make_pieces();
    void join_within(std::int32_t triangle, DisjointSets& sets) const;
    void join_across_edges(DisjointSets& sets) const;
    void join_at(const Side& edge, std::int32_t t, std::int32_t u, DisjointSets& sets) const;
    std::vector<Border> borders_at(const Side& edge, std::int32_t triangle) const;
    void number_patches(DisjointSets& sets);
    std::int32_t winding_outside(const CutShell::Piece& piece, const Vec3d& middle, const Vec3d& normal,
                                 const io::PictureWindings& windings) const;
    void find_windings();
    void find_places();

    const Vec3d& point(std::int32_t i) const { return shell_.points[static_cast<std::size_t>(i)]; }
    /// Calls take(side) for each side of a piece.
    template <class Take>
    void for_each_side(std::int32_t piece, Take take) const {
        const io::CutPiece& corners = shell_.pieces[static_cast<std::size_t>(piece)].corners;
        for (std::size_t k = 0; k < corners.size(); ++k)
            take(Side(point(corners[k]), point(corners[(k + 1) % corners.size()])));
    }
    bool is_at(const Side& side, const Vec3d& p) const { return side.distance_of(p) <= shell_.tolerance; }
    bool is_on_segment(std::int32_t triangle, const Vec3d& p) const {
        const auto found = segments_.find(triangle);
        return found != segments_.end() &&
               std::any_of(found->second.begin(), found->second.end(),
                           [&](const io::CutSegment& s) { return is_at(Side(s[0], s[1]), p); });
    }
    std::int32_t first_piece(std::int32_t triangle) const { return first_piece_[static_cast<std::size_t>(triangle)]; }

    const Intersections& found_;
    std::span<const CrossingPlace* const> places_;
    CutShell shell_;
    std::map<std::int32_t, std::vector<io::CutSegment>> segments_;  ///< segments in each triangle that others cross
    std::map<std::int32_t, std::vector<CommonArea>> areas_;         ///< of each triangle that lies on others
    std::vector<std::int32_t> first_piece_;                         ///< by triangle, and the end
};

void ShellCut::add_segments() {
    for (const CrossingPlace* place : places_)
        for (const std::int32_t row : place->rows) {
            const std::int32_t first = triangles_of(row)[0], second = triangles_of(row)[1];
            std::vector<Vec3d> corners;
            for_each_segment(row, [&](const Vec3d& a, const Vec3d& b) {
                corners.push_back(a);
                if (a == b) return;
                segments_[first].push_back({a, b});
                segments_[second].push_back({a, b});
            });
            if (corners.size() < 3) continue;
            areas_[first].push_back({second, corners});
            areas_[second].push_back({first, corners});
        }
}

void ShellCut::make_pieces() {
    for (std::int32_t t = 0; t < std::ssize(shell_.triangles); ++t) {
        first_piece_.push_back(static_cast<std::int32_t>(shell_.pieces.size()));
        const auto& corners = shell_.triangles[static_cast<std::size_t>(t)];
        const auto found = segments_.find(t);
        if (found == segments_.end()) {
            shell_.pieces.push_back({t, -1, {corners.begin(), corners.end()}});
            continue;
        }
        for (io::CutPiece& piece : io::cut_triangle(shell_.points, corners, found->second))
            shell_.pieces.push_back({t, -1, std::move(piece)});
    }
    first_piece_.push_back(static_cast<std::int32_t>(shell_.pieces.size()));
}

/// Joins pieces of one triangle that have a part of a side in common, outside of all segments. Sides are divided at the
/// corners of other pieces and at the ends of segments, so that each part lies at one other piece.
void ShellCut::join_within(std::int32_t triangle, DisjointSets& sets) const {
    const std::int32_t begin = first_piece(triangle), end = first_piece(triangle + 1);
    if (end - begin < 2) return;
    struct SideOfPiece {
        Side side;
        std::int32_t piece;
    };
    std::vector<SideOfPiece> sides;
    std::vector<Vec3d> ends;
    for (std::int32_t i = begin; i < end; ++i)
        for_each_side(i, [&](const Side& side) {
            sides.push_back({side, i});
            ends.push_back(side.begin);
        });
    for (const io::CutSegment& segment : segments_.at(triangle))
        ends.insert(ends.end(), segment.begin(), segment.end());
    for (const auto& [side, i] : sides) {
        if (side.length <= shell_.tolerance) continue;
        std::vector<double> cuts{0, 1};
        for (const Vec3d& p : ends)
            if (is_at(side, p)) cuts.push_back(std::clamp(side.place_of(p), 0.0, 1.0));
        std::sort(cuts.begin(), cuts.end());
        for (std::size_t k = 1; k < cuts.size(); ++k) {
            if ((cuts[k] - cuts[k - 1]) * side.length <= 4 * shell_.tolerance) continue;
            const Vec3d middle = side.at(0.5 * (cuts[k - 1] + cuts[k]));
            if (is_on_segment(triangle, middle)) continue;
            for (const auto& [other, j] : sides)
                if (j != i && dot(other.along, side.along) < 0 && is_at(other, middle)) sets.join(i, j);
        }
    }
}

/// Joins pieces of two triangles at the edge that they share. Edges of more than two triangles divide patches.
void ShellCut::join_across_edges(DisjointSets& sets) const {
    std::vector<std::size_t> end(shell_.points.size() + 1);  // of each vertex's list
    for (const auto& triangle : shell_.triangles)
        for (const std::int32_t v : triangle) ++end[static_cast<std::size_t>(v) + 1];
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<std::int32_t> around(end.back());  // triangles around each vertex, ascending
    const std::vector<std::size_t> begin = end;
    for (std::int32_t t = 0; t < std::ssize(shell_.triangles); ++t)
        for (const std::int32_t v : shell_.triangles[static_cast<std::size_t>(t)])
            around[end[static_cast<std::size_t>(v)]++] = t;
    for (std::int32_t t = 0; t < std::ssize(shell_.triangles); ++t) {
        const auto& c = shell_.triangles[static_cast<std::size_t>(t)];
        for (std::size_t k = 0; k < 3; ++k) {
            const auto a = static_cast<std::size_t>(c[k]);
            const std::int32_t b = c[(k + 1) % 3];
            std::int32_t count = 0, other = -1;
            for (std::size_t i = begin[a]; i < end[a]; ++i) {
                const auto& corners = shell_.triangles[static_cast<std::size_t>(around[i])];
                if (around[i] == t || std::find(corners.begin(), corners.end(), b) == corners.end()) continue;
                ++count, other = around[i];
            }
            if (count == 1 && other > t) join_at(Side(point(c[k]), point(b)), t, other, sets);
        }
    }
}

/// Joins pieces of two triangles that have a part of an edge in common, except where a curve runs along the edge.
void ShellCut::join_at(const Side& edge, std::int32_t t, std::int32_t u, DisjointSets& sets) const {
    if (!segments_.contains(t) && !segments_.contains(u)) return sets.join(first_piece(t), first_piece(u));
    for (const Border& x : borders_at(edge, t))
        for (const Border& y : borders_at(edge, u)) {
            const double low = std::max(x.low, y.low), high = std::min(x.high, y.high);
            if (!((high - low) * edge.length > 4 * shell_.tolerance)) continue;
            const Vec3d middle = edge.at(0.5 * (low + high));
            if (!is_on_segment(t, middle) && !is_on_segment(u, middle)) sets.join(x.piece, y.piece);
        }
}

std::vector<Border> ShellCut::borders_at(const Side& edge, std::int32_t triangle) const {
    std::vector<Border> borders;
    const std::int32_t begin = first_piece(triangle), end = first_piece(triangle + 1);
    if (end - begin == 1) return {{0, 1, begin}};
    for (std::int32_t piece = begin; piece < end; ++piece)
        for_each_side(piece, [&](const Side& side) {
            if (!is_at(edge, side.begin) || !is_at(edge, side.at(1))) return;
            const auto [low, high] = std::minmax({edge.place_of(side.begin), edge.place_of(side.at(1))});
            borders.push_back({low, high, piece});
        });
    return borders;
}

void ShellCut::number_patches(DisjointSets& sets) {
    std::vector<std::int32_t> number(shell_.pieces.size(), -1);
    for (std::int32_t i = 0; i < std::ssize(shell_.pieces); ++i) {
        std::int32_t& patch = number[static_cast<std::size_t>(sets.find(i))];
        if (patch < 0) {
            patch = static_cast<std::int32_t>(shell_.patches.size());
            shell_.patches.emplace_back();
        }
        shell_.pieces[static_cast<std::size_t>(i)].patch = patch;
        shell_.patches[static_cast<std::size_t>(patch)].pieces.push_back(i);
    }
}

/// Returns the winding number on the outer side of a piece. Where triangles lie on each other, they count as if they
/// were ordered by their numbers, along the direction in which the normal's first coordinate that is not 0 is positive.
std::int32_t ShellCut::winding_outside(const CutShell::Piece& piece, const Vec3d& middle, const Vec3d& normal,
                                       const io::PictureWindings& windings) const {
    std::int32_t winding = windings.at(middle + (100 * shell_.tolerance / length_of(normal)) * normal);
    const auto found = areas_.find(piece.triangle);
    if (found == areas_.end()) return winding;
    const double first = normal.x != 0 ? normal.x : normal.y != 0 ? normal.y : normal.z;
    for (const CommonArea& area : found->second) {
        if ((area.other > piece.triangle) != (first > 0) || !area.contains(middle)) continue;
        const auto& c = shell_.triangles[static_cast<std::size_t>(area.other)];
        const bool same = dot(normal, cross(point(c[1]) - point(c[0]), point(c[2]) - point(c[0]))) > 0;
        winding += same ? 1 : -1;
    }
    return winding;
}

/// Finds the winding numbers of patches, at the middle of the largest piece of each.
void ShellCut::find_windings() {
    std::vector<std::int32_t> corners;
    for (const auto& triangle : shell_.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const std::span<const Vec3d> vertices(shell_.points);
    const io::PictureWindings windings(vertices, corners);
    for (CutShell::Patch& patch : shell_.patches) {
        std::int32_t largest = -1;
        Vec3d centre, normal;
        double most = 0;
        for (const std::int32_t i : patch.pieces) {
            const CutShell::Piece& piece = shell_.pieces[static_cast<std::size_t>(i)];
            Vec3d area{}, middle{};
            for (std::size_t k = 0; k < piece.corners.size(); ++k) {
                const Vec3d &first = point(piece.corners[0]), &at = point(piece.corners[k]);
                middle = middle + (1 / static_cast<double>(piece.corners.size())) * at;
                area = area + cross(at - first, point(piece.corners[(k + 1) % piece.corners.size()]) - first);
            }
            if (dot(area, area) <= most) continue;
            most = dot(area, area);
            largest = i, centre = middle, normal = area;
        }
        if (largest >= 0)
            patch.winding_outside =
                winding_outside(shell_.pieces[static_cast<std::size_t>(largest)], centre, normal, windings);
    }
}

void ShellCut::find_places() {
    for (std::int32_t i = 0; i < std::ssize(places_); ++i)
        for (const std::int32_t row : places_[static_cast<std::size_t>(i)]->rows)
            for_each_segment(row, [&](const Vec3d& a, const Vec3d& b) {
                const Vec3d middle = 0.5 * a + 0.5 * b;
                for (const std::int32_t t : triangles_of(row))
                    for (std::int32_t piece = first_piece(t); piece < first_piece(t + 1); ++piece)
                        for_each_side(piece, [&](const Side& side) {
                            if (!is_at(side, middle)) return;
                            const std::int32_t patch = shell_.pieces[static_cast<std::size_t>(piece)].patch;
                            auto& places = shell_.patches[static_cast<std::size_t>(patch)].places;
                            if (places.empty() || places.back() != i) places.push_back(i);
                        });
            });
}

}  // namespace

std::optional<CutShell> cut_shell(const io::TriangleMesh& shell, const Intersections& found,
                                  std::span<const CrossingPlace* const> places) {
    return ShellCut(shell, found, places).cut();
}

}  // namespace crumple::checks
