#include "results/stencil_scene.h"

#include <string>
#include <variant>

#include "crumple/error.h"
#include "scene/outline.h"

namespace crumple {
namespace {

[[noreturn]] void refuse(const std::string& message) {
    throw Error(ErrorCode::invalid_argument, message, Element::option);
}

void require_host(const MeshView& mesh) {
    if (mesh.memory != MemorySpace::host) refuse("stencils need meshes in host memory");
}

std::optional<VertexReader> reader_of_option(const VertexView& view, const char* name, std::int64_t vertices) {
    if (!view.data && view.rows == 0) return {};
    if (!view.data || view.rows != vertices)
        refuse(std::string(name) + " has " + std::to_string(view.data ? view.rows : 0) + " rows for " +
               std::to_string(vertices) + " vertices");
    if (const char* fault = fault_of(view)) refuse(std::string("rows of ") + name + fault);
    return VertexReader{static_cast<const std::byte*>(view.data), view.row_stride, view.column_stride,
                        view.type == ScalarType::float32};
}

}  // namespace

StencilScene::StencilScene(const Scene& scene, const StencilOptions& options, bool needs_end) {
    World world;
    if (const auto* mesh = std::get_if<MeshView>(&scene.source())) {
        require_host(*mesh);
        shapes_ = {Shape(*mesh)};
    } else if (const auto* two = std::get_if<TwoMeshes>(&scene.source())) {
        require_host(two->a);
        require_host(two->b);
        shapes_ = {Shape(two->a), Shape(two->b)};
    } else if (const auto* given_world = std::get_if<World>(&scene.source())) {
        world = *given_world;
        if (world.device_poses.data || world.device_end_poses.data) refuse("stencils need poses in host memory");
    } else {
        refuse("stencils are for whole scenes, not for parts");
    }
    if (!shapes_.empty()) {
        for (std::size_t s = 0; s < shapes_.size(); ++s) bodies_.push_back({.shape = static_cast<std::int32_t>(s)});
        world = {shapes_, bodies_, {}};
    }
    outline_.read(world, {});
    if (needs_end && !outline_.moving())
        refuse(
            "stencils of impacts need the positions at the end of the step: pass the scene of the query, such as "
            "Mesh(start, faces).moving_to(end)");
    first_vertex_.push_back(0);
    for (std::int32_t b = 0; b < bodies(); ++b) first_vertex_.push_back(first_vertex_.back() + vertices(b));
    if (first_vertex_.back() > std::int64_t{1} << 31)
        refuse("the bodies have " + std::to_string(first_vertex_.back()) + " vertices, too many for int32");
    before_ = reader_of_option(options.before, "before", first_vertex_.back());
    rest_ = reader_of_option(options.rest, "rest", first_vertex_.back());
}

std::array<std::int64_t, 3> StencilScene::corners(std::int32_t body, std::int32_t triangle) const {
    std::array<std::int64_t, 3> corners{};
    with_corner_reader(outline_.shape(body), [&](auto read) {
        corners = {read(triangle, 0), read(triangle, 1), read(triangle, 2)};
    });
    return corners;
}

}  // namespace crumple
