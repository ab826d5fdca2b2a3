#pragma once

// Pairs of coplanar faces of two surfaces, by planes. Faces that pairs connect lie in one plane, which has one
// projection and one apex for all common areas (exact/overlap/common_area.h). So an edge between two faces of one
// surface in the plane need not count; usually only edges at the boundary of flat regions do.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/cancellation.h"
#include "base/memory_claim.h"
#include "crumple/intersections.h"
#include "exact/overlap/common_area.h"
#include "search/overlap/overlap_surface_pair.h"

namespace crumple {

class CoplanarFaces {
   public:
    struct Plane {
        EnclosedProjection projection{};
        Vec3d apex{};
        Enclosed stretch{1};    ///< area of a face, divided by that of its projection
        bool has_area = false;  ///< true if a pair of faces has a common area
        double largest = -1;    ///< twice the area of the largest projection of a face, rounded
    };
    struct Face {
        std::int32_t id, plane;
        PlanarFace<Vec3d> planar;

        bool counts() const { return planar.counts[0] || planar.counts[1] || planar.counts[2]; }
    };

    /// Requires coordinates in the range of double words, and faces that are not degenerate.
    CoplanarFaces(const SurfacePair& surfaces, std::span<const Pair> pairs, Cancellation& cancellation,
                  MemoryMeter& meter);

    /// False if the projection of a face is degenerate: then nothing else is valid.
    bool valid() const { return valid_; }
    /// Pairs of indices into the faces of each surface, sorted by plane, without those that certainly add nothing.
    std::span<const Pair> pairs() const { return pairs_; }
    const Face& face(std::size_t side, std::int32_t index) const {
        return faces_[side][static_cast<std::size_t>(index)];
    }
    const Plane& plane(std::int32_t index) const { return planes_[static_cast<std::size_t>(index)]; }

   private:
    struct DirectedEdge {
        std::int32_t plane, low, high;
        bool forward;
        std::int32_t face, edge;
    };

    void list_faces(const SurfacePair& surfaces, std::span<const Pair> pairs);
    void join_planes();
    void choose_projections();
    void find_areas(Cancellation& cancellation);
    void drop_inner_edges(const SurfacePair& surfaces, std::size_t side);
    void select_pairs();

    MemoryClaim memory_;
    bool valid_ = true;
    std::array<std::vector<Face>, 2> faces_;  ///< sorted by id
    std::vector<Plane> planes_;
    std::vector<Pair> pairs_;
};

}  // namespace crumple
