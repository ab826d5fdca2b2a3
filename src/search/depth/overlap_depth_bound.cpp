#include "search/depth/overlap_depth_bound.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/memory_claim.h"
#include "search/depth/depth_piece.h"

// The depth and its bounds on pieces of faces are those of depth_piece.h. Pieces whose bound is large are halved at the
// middle of their longest edge. All coordinates are scaled by the scale of the other surface's tree. The middle of an
// edge is rounded, so the halves of a piece do not quite cover it; the bound of the result includes that
// (Refinement::cover_error).

namespace crumple {
namespace {

constexpr std::size_t most_splits = std::size_t{1} << 19;

/// Refines the pieces of one surface.
class Refinement {
   public:
    Refinement(const DepthSide& of, const DepthSide& other, ParallelFor& workers, MemoryMeter& meter,
               Cancellation& cancellation)
        : of_(of),
          other_(*other.tree),
          box_(of.tree->surface().box),
          workers_(workers),
          cancellation_(cancellation),
          memory_(meter) {}

    /// Makes a piece of each face that may have points inside. `faces`: those in pairs. Removes duplicates.
    void add_faces(std::vector<std::int32_t> faces);
    /// Returns bounds on the depth of this surface, where depths up to `known`, in scaled units, are of no interest.
    DepthBounds refine(double known, double tolerance);

   private:
    struct Halves {
        FacePoint middle;
        std::array<Piece, 2> pieces;
    };

    FacePoint corner(std::int32_t vertex) const;
    FacePoint evaluate(PointWalk& walk, const Vec3d& p, const Piece& piece) const;
    bool is_inside(const Vec3d& p, double radius, const Piece& piece) const;
    double bound_of(const Piece& piece, double needless) const;
    void bound_faces(double known, double tolerance);
    void claim(std::size_t pieces, std::size_t large, std::size_t split);
    void finish(const Piece& piece) { finished_ = max(finished_, piece.bound); }
    std::vector<Piece> remove_largest(double limit);
    void split(const std::vector<Piece>& large, double tolerance);
    Halves halves(PointWalk& walk, const Piece& piece, double needless) const;
    double cover_error() const;
    double box_bound() const;

    const DepthSide& of_;
    const SurfaceTree& other_;
    const Bounds& box_;  ///< box of the faces of this surface
    ParallelFor& workers_;
    Cancellation& cancellation_;
    std::vector<std::int32_t> depth_at_;  ///< by place: index of the vertex's depth, or -1
    std::vector<Piece> pieces_;
    double greatest_ = 0;  ///< greatest depth that is known
    double finished_ = 0;  ///< greatest bound of the pieces that need not be refined
    int level_ = 0;
    MemoryClaim memory_;  ///< the most bytes that all lists have had at a time
};

/// Returns the bytes of a vector after an increase of its size, which at most doubles its capacity.
template <class T>
std::size_t bytes_for(const std::vector<T>& vector, std::size_t size) {
    return (size <= vector.capacity() ? vector.capacity() : std::max(size, 2 * vector.capacity())) * sizeof(T);
}

// Claims memory for lists of these sizes, before they are made.
void Refinement::claim(std::size_t pieces, std::size_t large, std::size_t split) {
    const std::size_t bytes = bytes_of(depth_at_) + bytes_for(pieces_, pieces) + 2 * large * sizeof(Piece) +
                              split * sizeof(std::optional<Halves>);
    if (bytes > memory_.bytes()) memory_.add(bytes - memory_.bytes());
}

// Vertices without a depth are outside, or on the other surface; their signed depth is at most 0. Vertices without an
// edge have no place.
FacePoint Refinement::corner(std::int32_t vertex) const {
    FacePoint point;
    point.at = other_.scale() * of_.surface->points[vertex];
    const std::int32_t place = of_.surface->surface->place(vertex);
    const std::int32_t i = place < 0 ? -1 : depth_at_[static_cast<std::size_t>(place)];
    if (i < 0) return point;
    const VertexDepth& depth = of_.depths[static_cast<std::size_t>(i)];
    const double scaled = other_.scale() * depth.depth;
    point.is_inside = true;
    point.radius = max(0.0, narrower * scaled - 0x1p-1000);
    point.upper = wider * scaled + 0x1p-1000;
    point.nearest = depth.triangle;
    return point;
}

void Refinement::add_faces(std::vector<std::int32_t> faces) {
    const ClosedSurface& surface = *of_.surface->surface;
    depth_at_.assign(static_cast<std::size_t>(surface.places()), -1);
    for (std::size_t i = 0; i < of_.depths.size(); ++i)
        depth_at_[static_cast<std::size_t>(surface.place(of_.depths[i].vertex))] = static_cast<std::int32_t>(i);
    for (const WindingInterval& interval : of_.windings->intervals()) {
        const auto inner = surface.faces(interval.begin, interval.end);
        faces.insert(faces.end(), inner.begin(), inner.end());
    }
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    claim(faces.size(), 0, 0);
    pieces_.resize(faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
        pieces_[i].bound = box_bound();
        const std::int32_t* c = surface.corners(faces[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            pieces_[i].corner[k] = corner(c[k]);
            greatest_ = max(greatest_, pieces_[i].corner[k].least_depth());
        }
    }
}

// Bounds that are at most `needless` are not improved.
double Refinement::bound_of(const Piece& piece, double needless) const {
    const double bound = min(piece.bound, lipschitz_bound(piece));
    return bound <= needless ? bound : convex_bound(piece, other_.scaled(), bound);
}

void Refinement::bound_faces(double known, double tolerance) {
    constexpr std::size_t chunk = 256;
    greatest_ = max(greatest_, known);
    const double needless = greatest_ + tolerance;
    workers_.parallel_for((pieces_.size() + chunk - 1) / chunk, [&](std::size_t part) {
        cancellation_.check();
        const std::size_t end = std::min(pieces_.size(), (part + 1) * chunk);
        for (std::size_t i = part * chunk; i < end; ++i) pieces_[i].bound = bound_of(pieces_[i], needless);
    });
}

// Removes the pieces whose bound exceeds the limit from pieces_ and returns them.
std::vector<Piece> Refinement::remove_largest(double limit) {
    std::vector<Piece> large;
    std::size_t kept = 0;
    for (const Piece& piece : pieces_) {
        if (piece.bound > limit)
            large.push_back(piece);
        else
            pieces_[kept++] = piece;
    }
    pieces_.resize(kept);
    return large;
}

// In each round splits the pieces in the upper half of the interval between the greatest depth and the greatest bound.
DepthBounds Refinement::refine(double known, double tolerance) {
    bound_faces(known, tolerance);
    for (std::size_t splits = 0;;) {
        double upper = 0;
        std::size_t kept = 0;
        for (const Piece& piece : pieces_) {
            if (piece.bound <= greatest_ + tolerance) {
                finish(piece);
                continue;
            }
            upper = max(upper, piece.bound);
            pieces_[kept++] = piece;
        }
        pieces_.resize(kept);
        claim(kept, kept, 0);
        std::vector<Piece> large = remove_largest(greatest_ + max(tolerance, 0.5 * (upper - greatest_)));
        const std::size_t left = most_splits - splits;
        if (large.size() > left) {  // splits those with the largest bounds
            std::stable_sort(large.begin(), large.end(),
                             [](const auto& x, const auto& y) { return x.bound > y.bound; });
            for (std::size_t i = left; i < large.size(); ++i) finish(large[i]);
            large.resize(left);
        }
        if (large.empty()) break;
        splits += large.size();
        split(large, tolerance);
    }
    for (const Piece& piece : pieces_) finish(piece);
    const double bound = finished_ == 0 ? 0 : min(wider * (finished_ + cover_error()), box_bound());
    return {greatest_, max(bound, greatest_)};
}

void Refinement::split(const std::vector<Piece>& large, double tolerance) {
    constexpr std::size_t chunk = 32;
    claim(pieces_.size() + 2 * large.size(), large.size(), large.size());
    std::vector<std::optional<Halves>> split(large.size());
    const double needless = greatest_ + tolerance;
    workers_.parallel_for((large.size() + chunk - 1) / chunk, [&](std::size_t part) {
        cancellation_.check();
        PointWalk walk(other_);
        const std::size_t end = std::min(large.size(), (part + 1) * chunk);
        for (std::size_t i = part * chunk; i < end; ++i)
            if (longest_edge(large[i])) split[i] = halves(walk, large[i], needless);
    });
    for (std::size_t i = 0; i < large.size(); ++i) {
        if (!split[i]) {
            finish(large[i]);
            continue;
        }
        greatest_ = max(greatest_, split[i]->middle.least_depth());
        level_ = std::max(level_, large[i].level + 1);
        for (const Piece& piece : split[i]->pieces) pieces_.push_back(piece);
    }
}

Refinement::Halves Refinement::halves(PointWalk& walk, const Piece& piece, double needless) const {
    const std::size_t i = *longest_edge(piece), j = (i + 1) % 3;
    const Vec3d middle = 0.5 * piece.corner[i].at + 0.5 * piece.corner[j].at;
    Halves made{evaluate(walk, middle, piece), {piece, piece}};
    made.pieces[0].corner[j] = made.middle;
    made.pieces[1].corner[i] = made.middle;
    for (Piece& half : made.pieces) {
        ++half.level;
        half.bound = bound_of(half, needless);
    }
    return made;
}

FacePoint Refinement::evaluate(PointWalk& walk, const Vec3d& p, const Piece& piece) const {
    FacePoint point;
    point.at = p;
    const Bounds& box = other_.scaled().box;
    if (!is_in(p, box)) {
        const Vec3d in_box = max(box.low, min(box.high, p));
        point.radius = narrower * distance_between(p, in_box);
    } else {
        std::int32_t start = -1;
        for (const FacePoint& corner : piece.corner) start = std::max(start, corner.nearest);
        walk.find(p, start);
        point.radius = narrower * walk.lower();
        point.nearest = walk.near()[walk.closest()].triangle;
        point.is_inside = is_inside(p, point.radius, piece);
    }
    point.upper = point.is_inside ? walk.upper() : -point.radius;
    return point;
}

// A ball that the other surface does not meet has one winding number: the ball around p, or around a corner.
bool Refinement::is_inside(const Vec3d& p, double radius, const Piece& piece) const {
    for (const FacePoint& corner : piece.corner) {
        const double away = wider * distance_between(p, corner.at);
        if (away < max(radius, corner.radius)) return corner.is_inside;
    }
    return other_.winding_at(p) != 0;
}

// Bounds how far a point of a face may be from the halves of halves of the face, as each middle is rounded.
double Refinement::cover_error() const {
    double most = 0;
    for (int axis = 0; axis < 3; ++axis) most = max(most, max(std::abs(box_.low[axis]), std::abs(box_.high[axis])));
    return level_ * (0x1p-51 * most * other_.scale()) + 0x1p-900;
}

// From an inner point, each direction along an axis leads out of the box, so it meets the surface.
double Refinement::box_bound() const {
    const Bounds& box = other_.scaled().box;
    const Vec3d half = 0.5 * box.high - 0.5 * box.low;
    return wider * min(half.x, min(half.y, half.z)) + 0x1p-1000;
}

/// Returns the least tolerance that makes sense for two surfaces.
double least_tolerance(const Bounds& a, const Bounds& b) {
    double most = 0;
    Vec3d extent;
    for (int axis = 0; axis < 3; ++axis) {
        const double low = max(a.low[axis], b.low[axis]), high = min(a.high[axis], b.high[axis]);
        extent[axis] = max(0.0, 0.5 * high - 0.5 * low);
        most = max(most, max(std::abs(low), std::abs(high)));
    }
    return max(0x1p-19 * std::hypot(extent.x, extent.y, extent.z), 0x1p-40 * most);
}

/// Returns the bounds of one surface, in units of length; depths up to `known` are of no interest.
DepthBounds side_bounds(const std::array<DepthSide, 2>& sides, std::size_t side, std::vector<std::int32_t> faces,
                        double known, double tolerance, ParallelFor& workers, MemoryMeter& meter,
                        Cancellation& cancellation) {
    const double scale = sides[1 - side].tree->scale();
    Refinement refinement(sides[side], sides[1 - side], workers, meter, cancellation);
    refinement.add_faces(std::move(faces));
    const DepthBounds scaled = refinement.refine(narrower * (scale * known), scale * tolerance);
    if (scale == 1) return scaled;
    return {narrower * (scaled.lower / scale), wider * (scaled.upper / scale) + 0x1p-1074};
}

}  // namespace

DepthBounds find_depth_bounds(const std::array<DepthSide, 2>& sides, std::span<const Pair> pairs, double tolerance,
                              ParallelFor& workers, MemoryMeter& meter, Cancellation& cancellation) {
    const double least = least_tolerance(sides[0].tree->surface().box, sides[1].tree->surface().box);
    if (!(tolerance > least)) tolerance = least;
    double known = 0, upper = 0;
    for (const DepthSide& side : sides)
        for (const VertexDepth& depth : side.depths) known = max(known, (1 - 0x1p-52) * depth.depth);
    for (std::size_t side = 0; side < 2; ++side) {
        std::vector<std::int32_t> faces;
        for (const Pair& pair : pairs) faces.push_back(side == 0 ? pair.a : pair.b);
        const DepthBounds bounds =
            side_bounds(sides, side, std::move(faces), known, tolerance, workers, meter, cancellation);
        known = max(known, bounds.lower);
        upper = max(upper, bounds.upper);
    }
    return {known, upper};
}

}  // namespace crumple
