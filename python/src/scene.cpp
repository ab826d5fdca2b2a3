#include "scene.h"

#include <cstdint>
#include <stdexcept>
#include <utility>

#include <nanobind/ndarray.h>

#include "arguments.h"
#include "detector.h"
#include "part.h"

namespace nb = nanobind;

namespace crumple::python {

BorrowedScene::Mesh::Mesh(const nb::tuple& given, const char* which, void* stream)
    : mesh(given, which, stream),
      lists(nb::make_tuple(given.attr("edges"), given.attr("points")), mesh.device(), which, stream),
      view(mesh.view()) {
    lists.put_into(view);
    const nb::object at_end = given.attr("end");
    if (!at_end.is_none()) view = view.moving_to(end.emplace(at_end, mesh, which).view());
}

BorrowedScene::Source BorrowedScene::source_of(nb::handle scene, void* stream) {
    if (nb::isinstance<BorrowedWorld>(scene)) {
        const BorrowedWorld& world = given_world(scene);
        const std::shared_ptr<const Bodies> bodies = world.bodies;
        const nb::object start = world.poses.object(), end = world.end_poses.object();
        return Posed{bodies, BorrowedPoses(start, *bodies, BorrowedPoses::When::start, stream),
                     BorrowedPoses(end, *bodies, BorrowedPoses::When::end, stream)};
    }
    if (nb::isinstance<Part>(scene)) return &given_part(scene);
    const nb::tuple meshes = nb::cast<nb::tuple>(scene);
    if (nb::hasattr(scene, "end")) return Source(std::in_place_type<Mesh>, meshes, "", stream);
    return Source(std::in_place_type<TwoMeshes>, Mesh(nb::cast<nb::tuple>(meshes[0]), "first mesh: ", stream),
                  Mesh(nb::cast<nb::tuple>(meshes[1]), "second mesh: ", stream));
}

BorrowedScene::BorrowedScene(const SharedDetector& detector, nb::handle scene, void* stream)
    : source_(source_of(scene, stream)) {
    if (const auto* mesh = std::get_if<Mesh>(&source_)) check_device(detector, mesh->mesh.device());
    if (const auto* meshes = std::get_if<TwoMeshes>(&source_)) {
        check_device(detector, meshes->a.mesh.device());
        check_device(detector, meshes->b.mesh.device());
    }
    if (const auto* world = std::get_if<Posed>(&source_)) {
        check_device(detector, world->start.device());
        check_device(detector, world->end.device());
    }
}

Scene BorrowedScene::view(SharedDetector& detector) const { return view(detector.poses(), detector.end_poses()); }

Scene BorrowedScene::view(std::vector<Pose>& poses, std::vector<Pose>& end_poses) const {
    if (const auto* mesh = std::get_if<Mesh>(&source_)) return mesh->view;
    if (const auto* meshes = std::get_if<TwoMeshes>(&source_)) return {meshes->a.view, meshes->b.view};
    if (const auto* part = std::get_if<const Part*>(&source_)) return **part;
    const auto& [bodies, start, end] = std::get<Posed>(source_);
    World world{bodies->shapes, bodies->bodies, {}};
    if (start.device() == BorrowedArray::on_host)
        world.poses = start.read(*bodies, poses);
    else
        world.device_poses = start.on_device(*bodies);
    if (!end.given()) return world;
    if (end.device() == BorrowedArray::on_host)
        world.end_poses = end.read(*bodies, end_poses);
    else
        world.device_end_poses = end.on_device(*bodies);
    return world;
}

const BorrowedMesh* BorrowedScene::mesh() const {
    const auto* mesh = std::get_if<Mesh>(&source_);
    return mesh ? &mesh->mesh : nullptr;
}

const Bodies* BorrowedScene::bodies() const {
    const auto* world = std::get_if<Posed>(&source_);
    return world ? world->bodies.get() : nullptr;
}

void QueryArrays::read(nb::handle given, const BorrowedScene& scene, ProximityQuery& query) {
    const nb::object of_vertices = given.attr("radii"), at_rest = given.attr("rest");
    if (of_vertices.is_none() && at_rest.is_none()) return;
    const BorrowedMesh* const mesh = scene.mesh();
    if (!mesh) refuse("radii and rest are for the vertices of one mesh: shapes of a world, and parts, have their own");
    if (!of_vertices.is_none()) query.radii = radii.emplace(of_vertices, *mesh).view();
    if (!at_rest.is_none()) query.rest = rest.emplace(at_rest, *mesh, "", BorrowedEnd::When::rest).view();
}

std::vector<BodyPair> excluded_in(const BorrowedScene& scene, nb::handle excluded) {
    if (excluded.is_none()) return {};
    if (const Bodies* bodies = scene.bodies()) return excluded_bodies(*bodies, excluded);
    nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(excluded, given)) throw std::logic_error("crumple/_scene.py gave no pairs of bodies");
    std::vector<BodyPair> pairs;
    for (std::size_t i = 0; i < given.shape(0); ++i) pairs.push_back({given(i, 0), given(i, 1)});
    return pairs;
}

}  // namespace crumple::python
