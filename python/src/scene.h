#pragma once

// Scene and query of a call on their way in. crumple/_scene.py makes a scene of one of four kinds of the caller's
// arguments.

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

/// Arrays of a scene, in place, while a call reads them. Needs the GIL to come and go.
class BorrowedScene {
   public:
    /// `scene` is a crumple.Mesh, a tuple of two of these, a crumple.World or a crumple.Part. Refuses arrays of other
    /// devices than the detector's. `stream`: the CUDA stream that arrays in CUDA memory must be ready on.
    BorrowedScene(const SharedDetector& detector, nanobind::handle scene, void* stream = nullptr);

    /// The scene as the library takes it. In a turn of one's own: poses may be copied to the detector's arrays.
    Scene view(SharedDetector& detector) const;

    /// The only mesh; null for other scenes.
    const BorrowedMesh* mesh() const;
    /// The bodies of a world; null for other scenes.
    const Bodies* bodies() const;

   private:
    /// A crumple.Mesh: three arrays, with the attributes end, edges and points.
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

/// Arrays of a query, which count in the vertices of the scene's mesh, in place. Only those of proximities have some.
struct QueryArrays {
    std::optional<BorrowedRadii> radii;
    std::optional<BorrowedEnd> rest;

    template <class Query>
    void read(nanobind::handle, const BorrowedScene&, Query&) {}
    void read(nanobind::handle given, const BorrowedScene& scene, ProximityQuery& query);
};

/// Pairs of bodies that a filter excludes, (n, 2) of int32 or None, repeated for each configuration of a world.
std::vector<BodyPair> excluded_in(const BorrowedScene& scene, nanobind::handle excluded);

/// A query while a call reads it.
template <class Query>
struct BorrowedQuery {
    /// `excluded`: as excluded_in() takes them, by index.
    BorrowedQuery(nanobind::handle given, const BorrowedScene& scene, nanobind::handle excluded)
        : query(read<Query>(given)) {
        arrays.read(given, scene, query);
        query.filter.excluded_bodies = excluded_in(scene, excluded);
    }
    Query query;
    QueryArrays arrays;
};

}  // namespace crumple::python
