#include "search/overlap/overlap_coplanar_faces.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"

namespace crumple {
namespace {

/// Returns the area of a face, divided by that of its projection: the length of its normal over one component.
Enclosed stretch_of(const FaceCorners& face, int axis) {
    const auto& [a, b, c] = face;
    const bool across = orient2d(a, b, c, first_axis(axis)) == 0 && orient2d(a, b, c, second_axis(axis)) == 0;
    if (across) return Enclosed(1);
    const Vec3<Enclosed> normal = cross(enclosed_difference(b, a), enclosed_difference(c, a));
    const Enclosed along = normal[axis].value.high < 0 ? -normal[axis] : normal[axis];
    return sqrt(dot(normal, normal)) / along;
}

}  // namespace

CoplanarFaces::CoplanarFaces(const SurfacePair& surfaces, std::span<const Pair> pairs, Cancellation& cancellation,
                             MemoryMeter& meter)
    : memory_(meter) {
    memory_.add(pairs.size() * (sizeof(Pair) + sizeof(std::int32_t)));
    list_faces(surfaces, pairs);
    cancellation.check();
    join_planes();
    memory_.add(planes_.size() * sizeof(Plane));
    choose_projections();
    if (!valid_) return;
    find_areas(cancellation);
    // A body with itself has each pair of faces once, so the faces on both sides of an edge meet different faces.
    if (surfaces.surface[0] != surfaces.surface[1])
        for (std::size_t side = 0; side < 2; ++side) drop_inner_edges(surfaces, side);
    cancellation.check();
    select_pairs();
}

void CoplanarFaces::list_faces(const SurfacePair& surfaces, std::span<const Pair> pairs) {
    pairs_.assign(pairs.begin(), pairs.end());
    for (std::size_t side = 0; side < 2; ++side) {
        const auto member = side == 0 ? &Pair::a : &Pair::b;
        std::vector<std::int32_t> ids;
        ids.reserve(pairs.size());
        for (const Pair& pair : pairs) ids.push_back(pair.*member);
        std::sort(ids.begin(), ids.end());
        ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
        memory_.add(ids.size() * (sizeof(Face) + 3 * sizeof(DirectedEdge)));
        faces_[side].reserve(ids.size());
        for (const std::int32_t id : ids) faces_[side].push_back({id, 0, {surfaces.corners(side, id)}});
        for (Pair& pair : pairs_)
            pair.*member =
                static_cast<std::int32_t>(std::lower_bound(ids.begin(), ids.end(), pair.*member) - ids.begin());
    }
}

// Sets the plane of each face.
void CoplanarFaces::join_planes() {
    const auto first_of_b = static_cast<std::int32_t>(faces_[0].size());
    DisjointSets sets(faces_[0].size() + faces_[1].size());
    for (const Pair& pair : pairs_) sets.join(pair.a, first_of_b + pair.b);
    // The least number of a set is that of a face of a, as each face occurs in a pair.
    std::int32_t planes = 0;
    for (std::int32_t i = 0; i < first_of_b; ++i) {
        Face& face = faces_[0][static_cast<std::size_t>(i)];
        const std::int32_t least = sets.find(i);
        face.plane = least == i ? planes++ : faces_[0][static_cast<std::size_t>(least)].plane;
    }
    for (std::size_t i = 0; i < faces_[1].size(); ++i) {
        const std::int32_t least = sets.find(first_of_b + static_cast<std::int32_t>(i));
        faces_[1][i].plane = faces_[0][static_cast<std::size_t>(least)].plane;
    }
    planes_.resize(static_cast<std::size_t>(planes));
}

// Projects each plane along the axis of its largest face, and turns faces that are clockwise there.
void CoplanarFaces::choose_projections() {
    std::vector<const FaceCorners*> largest(planes_.size());
    for (const auto& faces : faces_)
        for (const Face& face : faces) {
            Plane& plane = planes_[static_cast<std::size_t>(face.plane)];
            const FilteredPlane filtered(face.planar.corner);
            if (!(filtered.largest_component() > plane.largest)) continue;
            plane.largest = filtered.largest_component();
            plane.projection.axis = filtered.dominant_axis();
            largest[static_cast<std::size_t>(face.plane)] = &face.planar.corner;
        }
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        planes_[i].apex = (*largest[i])[0];
        planes_[i].stretch = stretch_of(*largest[i], planes_[i].projection.axis);
    }
    for (auto& faces : faces_)
        for (Face& face : faces) {
            auto& corner = face.planar.corner;
            const int turn = plane(face.plane).projection.sign(corner[0], corner[1], corner[2]);
            if (turn == 0) valid_ = false;
            if (turn < 0) std::swap(corner[1], corner[2]);
        }
}

// Sets Plane::has_area. Without it, areas that are 0 would be sums that cancel, which only exact arithmetic decides.
void CoplanarFaces::find_areas(Cancellation& cancellation) {
    for (const Pair& pair : pairs_) {
        const Face &a = face(0, pair.a), &b = face(1, pair.b);
        Plane& plane = planes_[static_cast<std::size_t>(a.plane)];
        if (plane.has_area) continue;
        cancellation.check();
        plane.has_area = !PlanarSigns(plane.projection, a.planar, b.planar).apart();
    }
}

// Drops edges that two faces in one plane traverse in opposite directions: the closed edge lies in both faces, so both
// have pairs with all faces of the other surface that meet it.
void CoplanarFaces::drop_inner_edges(const SurfacePair& surfaces, std::size_t side) {
    const auto key = [](const DirectedEdge& edge) { return std::tie(edge.plane, edge.low, edge.high); };
    std::vector<DirectedEdge> edges;
    edges.reserve(3 * faces_[side].size());
    for (std::size_t i = 0; i < faces_[side].size(); ++i) {
        const Face& face = faces_[side][i];
        const std::int32_t* const ids = surfaces.surface[side]->surface->corners(face.id);
        const bool turned = face.planar.corner[1] != surfaces.corners(side, face.id)[1];
        const std::array<std::int32_t, 3> corners{ids[0], ids[turned ? 2 : 1], ids[turned ? 1 : 2]};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int32_t p = corners[k], q = corners[next_corner(k)];
            edges.push_back({face.plane, std::min(p, q), std::max(p, q), p < q, static_cast<std::int32_t>(i),
                             static_cast<std::int32_t>(k)});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const auto& x, const auto& y) {
        return std::tie(x.plane, x.low, x.high, x.forward) < std::tie(y.plane, y.low, y.high, y.forward);
    });
    const auto drop = [&](const DirectedEdge& edge) {
        faces_[side][static_cast<std::size_t>(edge.face)].planar.counts[static_cast<std::size_t>(edge.edge)] = false;
    };
    for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && key(edges[end]) == key(edges[begin])) ++end;
        // Backward edges come first; those at both ends of the range run in opposite directions.
        for (std::size_t i = begin, j = end; i + 1 < j && !edges[i].forward && edges[j - 1].forward; ++i, --j) {
            drop(edges[i]);
            drop(edges[j - 1]);
        }
    }
}

void CoplanarFaces::select_pairs() {
    std::erase_if(pairs_, [&](const Pair& pair) {
        const Face &a = face(0, pair.a), &b = face(1, pair.b);
        return !plane(a.plane).has_area || (!a.counts() && !b.counts());
    });
    std::stable_sort(pairs_.begin(), pairs_.end(),
                     [&](const Pair& x, const Pair& y) { return face(0, x.a).plane < face(0, y.a).plane; });
}

}  // namespace crumple
