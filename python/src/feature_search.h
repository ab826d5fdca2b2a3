#pragma once

// What is asked about the features of a mesh or a world, on their way or near each other, and the calls that answer it.

#include <optional>
#include <vector>

#include <nanobind/nanobind.h>

#include "arrays.h"
#include "detector.h"
#include "feature_answer.h"
#include "world.h"

namespace crumple::python {

/// The mesh of one call, with the edges and points that are listed. Refuses those of other devices than the
/// detector's.
struct AskedOfMesh {
    /// `stream`: the CUDA stream that arrays in CUDA memory must be ready on, as in BorrowedMesh.
    AskedOfMesh(const SharedDetector& detector, const nanobind::tuple& mesh, const nanobind::tuple& listed,
                void* stream = nullptr);
    BorrowedMesh mesh;
    BorrowedLists lists;
    MeshView view;
};

/// What is asked, with the radii and the shape at rest of the vertices, each of which may be None.
struct AskedOfVertices {
    AskedOfVertices(const ProximityQuery& asked, const BorrowedMesh& mesh, nanobind::handle radii,
                    nanobind::handle rest);
    ProximityQuery question;
    std::optional<BorrowedRadii> of_vertices;
    std::optional<BorrowedEnd> at_rest;
};

/// The bodies and exclusions of one call on a world, which may get other poses while the call runs without the GIL.
template <class Question>
struct AskedOfWorld {
    AskedOfWorld(nanobind::handle world, const Question& given, nanobind::handle excluded)
        : bodies(given_world(world).bodies), question(given) {
        question.filter.excluded_bodies = excluded_bodies(*bodies, excluded);
    }
    std::shared_ptr<const Bodies> bodies;
    Question question;
};

/// The same as posed_world(), and where they go if that is given.
World moving_world(const Bodies& bodies, const BorrowedPoses& start, const BorrowedPoses& end,
                   SharedDetector& detector);

ImpactsAnswer find_impacts(nanobind::handle self, const nanobind::tuple& mesh, nanobind::handle end,
                           const ImpactQuery& question, nanobind::handle copy, const nanobind::tuple& lists);
ImpactsAnswer find_impacts_in_world(nanobind::handle self, nanobind::handle world, nanobind::handle poses,
                                    nanobind::handle end_poses, const ImpactQuery& question, nanobind::handle excluded,
                                    nanobind::handle copy);
/// (share, positions)
nanobind::tuple find_free_step(nanobind::handle self, const nanobind::tuple& mesh, nanobind::handle end,
                               const ImpactQuery& question, const nanobind::tuple& lists);
/// `radii` and `rest` may be None.
NearbyAnswer find_near(nanobind::handle self, const nanobind::tuple& mesh, const ProximityQuery& question,
                       nanobind::handle radii, nanobind::handle rest, nanobind::handle copy,
                       const nanobind::tuple& lists);
NearbyAnswer find_near_in_world(nanobind::handle self, nanobind::handle world, nanobind::handle poses,
                                const ProximityQuery& question, nanobind::handle excluded, nanobind::handle copy);

/// What a part owns of an answer; and the parts of a mesh that is asked this.
ImpactsAnswer find_impacts_in_part(nanobind::handle self, nanobind::handle part, const ImpactQuery& question,
                                   nanobind::handle copy);
NearbyAnswer find_near_in_part(nanobind::handle self, nanobind::handle part, const ProximityQuery& question,
                               nanobind::handle copy);
std::vector<Part> partition_motion(nanobind::handle self, const nanobind::tuple& mesh, nanobind::handle end,
                                   const ImpactQuery& question, nanobind::handle count, const nanobind::tuple& lists);
std::vector<Part> partition_near(nanobind::handle self, const nanobind::tuple& mesh, const ProximityQuery& question,
                                 nanobind::handle radii, nanobind::handle rest, nanobind::handle count,
                                 const nanobind::tuple& lists);

void bind_feature_questions(nanobind::module_& module);

}  // namespace crumple::python
