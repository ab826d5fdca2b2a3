#pragma once

// Records that stage `sort` of the cuda backend makes for candidate queries: boxes along the coordinate axes. `sweep`
// keeps all pairs of triangles whose boxes overlap. Here a lane is the number of a feature in its triangle: 0 to 2 for
// vertices, 3 to 5 for edges, 6 for the face (filters/candidates/candidate_record.h).

#include "backends/cuda/features/exact_points.h"
#include "backends/cuda/stages/layout.h"
#include "filters/candidates/box_test.h"
#include "filters/candidates/candidate_record.h"

namespace crumple::cuda {

/// Parameters of the query for kernels. Pointers refer to device memory.
struct CandidateConditions {
    unsigned wanted = 0;  ///< a bit for each CandidateKind
    double inflation = 0;
    FeatureTable features;
    ExactPoints points;
    const Normaliser* normaliser = nullptr;

    friend bool operator==(const CandidateConditions&, const CandidateConditions&) = default;
    /// Removes addresses and values on which the choice of kernels does not depend, for GraphKey::shape().
    void forget_places() {
        features = {};
        points.scene = {};
        normaliser = nullptr;
        inflation = 0;
    }
    CRUMPLE_HD bool wants(CandidateKind kind) const { return wanted >> static_cast<unsigned>(kind) & 1; }
    __device__ unsigned owned_lanes(std::int32_t triangle) const {
        return crumple::owned_lanes(features.owned[triangle], triangle < features.faces);
    }
    /// Returns the exact box of a lane's feature over the whole step, not inflated. `corner`: the vertices of the
    /// triangle.
    __device__ FeatureBox box(const std::int32_t* corner, int lane) const {
        const unsigned corners = corners_of(lane);
        const int first = corners & 1 ? 0 : corners & 2 ? 1 : 2;
        FeatureBox box(points.start(corner[first]));
        for (int k = first; k < 3; ++k) {
            if (!(corners >> k & 1)) continue;
            const MovingPoint p = points.moving(corner[k]);
            box.add(p.start);
            box.add(p.end);
        }
        return box;
    }
};

/// Inflated box of a lane's feature, and the feature's id. Coordinates are keys: rounded in such a way that unequal
/// keys have the order of the exact coordinates (CandidateRecord).
struct alignas(16) CandidateBox {
    Vec3f low;
    std::int32_t id;
    Vec3f high;
    std::int32_t unused;
};

/// Triangle in a leaf: a CandidateRecord, stored box by box, because a thread reads one box at a time.
struct alignas(64) CandidateMember {
    CandidateBox box[candidate_lanes - 1];
    std::int32_t vertex[3];
    std::uint32_t owned;
    std::int32_t name[3];
    std::int32_t unused;
};

struct CandidateMembers {
    CandidateMember* row;
    CandidateConditions asked;

    __device__ void put(std::uint32_t place, std::int32_t triangle, const Vec3d*, const std::int32_t id[3],
                        const InFrame<6>&, const Frame& frame) const {
        CandidateMember made;
        const unsigned owned = asked.owned_lanes(triangle);
        const CandidateKey key{*asked.normaliser, {frame.origin.x, frame.origin.y, frame.origin.z}};
        const Vec3d r{asked.inflation, asked.inflation, asked.inflation};
        const TriangleEdges edges = asked.features.edges_of[triangle];
        Vec3f low[3], high[3];
        for (int k = 0; k < 3; ++k) {
            made.vertex[k] = id[k];
            made.name[k] = asked.features.name(id[k]);
            made.box[k].id = asked.features.point_of(triangle, k);
            made.box[3 + k].id = edges[static_cast<std::size_t>(k)];
            const FeatureBox box = asked.box(id, k);
            low[k] = key(box.low - r);
            high[k] = key(box.high + r);
        }
        made.box[6].id = triangle;
        made.owned = owned;
        made.unused = 0;
        for (int lane = 0; lane < candidate_lanes - 1; ++lane) {
            CandidateBox& box = made.box[lane];
            box.low = {beyond, beyond, beyond}, box.high = {-beyond, -beyond, -beyond};
            box.unused = 0;
            for (int k = 0; k < 3; ++k) {
                if (!(corners_of(lane) >> k & 1)) continue;
                box.low = min(box.low, low[k]);
                box.high = max(box.high, high[k]);
            }
        }
        row[place] = made;
    }
};

/// Filter of the sweep that drops none of the pairs that the sweep finds by boxes, ownership and the pair filter.
struct OverlapAlone {
    struct Buffer {};
    __device__ bool keeps(bool has, const Candidate&, Buffer&) const { return has; }
};

}  // namespace crumple::cuda
