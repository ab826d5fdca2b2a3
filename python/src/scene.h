#pragma once

// Conversion of the scene and the query of a call. The scene is one of four kinds of Python objects, which
// crumple/_scene.py makes from the arguments of the call.

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "crumple/scene.h"
#include "queries.h"
#include "world.h"

namespace crumple::python {

class SharedDetector;

/// View of the arrays of a scene during a call. Construct and destroy it with the GIL.
class BorrowedScene {
   public:
    /// `scene` is a crumple.Mesh, a tuple of two of these, a crumple.World or a crumple.Part. Throws Error for arrays
    /// on a device other than the detector's. `stream`: the CUDA stream on which arrays in CUDA memory must be ready.
    BorrowedScene(const SharedDetector& detector, nanobind::handle scene, void* stream = nullptr);
    /// View for functions without a detector.
    explicit BorrowedScene(nanobind::handle scene) : source_(source_of(scene, nullptr)) {}

    /// Returns the scene for the library. Call it while a Turn exists, because poses may be copied to the detector's
    /// buffers.
    Scene view(SharedDetector& detector) const;
    /// Returns the same, with buffers for poses.
    Scene view(std::vector<Pose>& poses, std::vector<Pose>& end_poses) const;

    /// Returns the mesh; null for other scenes.
    const BorrowedMesh* mesh() const;
    /// Returns the bodies of a world; null for other scenes.
    const Bodies* bodies() const;

   private:
    /// View of a crumple.Mesh: its three arrays (vertices, faces, groups), and its attributes end, edges and points.
    struct Mesh {
        Mesh(const nanobind::tuple& given, const char* which, void* stream);
        BorrowedMesh mesh;
        BorrowedLists lists;
        std::optional<BorrowedEnd> end;
        MeshView view;
    };
    struct TwoMeshes {
        Mesh a, b;
    };
    struct Posed {
        std::shared_ptr<const Bodies> bodies;
        BorrowedPoses start, end;
    };
    using Source = std::variant<Mesh, TwoMeshes, Posed, const Part*>;
    static Source source_of(nanobind::handle scene, void* stream);

    Source source_;
};

/// View of the arrays of a query, which have one row per vertex of the scene's mesh. Only a ProximityQuery has arrays.
struct QueryArrays {
    std::optional<BorrowedRadii> radii;
    std::optional<BorrowedEnd> rest;

    template <class Query>
    void read(nanobind::handle, const BorrowedScene&, Query&) {}
    void read(nanobind::handle given, const BorrowedScene& scene, ProximityQuery& query);
};

/// Returns the pairs of bodies that a filter excludes, repeated for each configuration of the scene. `excluded`: body
/// indices within one configuration, (n, 2) int32, or None.
std::vector<BodyPair> excluded_in(const BorrowedScene& scene, nanobind::handle excluded);

/// View of a query during a call.
template <class Query>
struct BorrowedQuery {
    /// `excluded`: as for excluded_in().
    BorrowedQuery(nanobind::handle given, const BorrowedScene& scene, nanobind::handle excluded)
        : query(read<Query>(given)) {
        arrays.read(given, scene, query);
        query.filter.excluded_bodies = excluded_in(scene, excluded);
    }
    Query query;
    QueryArrays arrays;
};

}  // namespace crumple::python
